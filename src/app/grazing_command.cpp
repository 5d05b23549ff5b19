#include "app/grazing_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/problem_argument.hpp"
#include "maps/analyse_grazing.hpp"

namespace tchat {

namespace {

void add_options(CLI::App& command, GrazingRequest& request) {
  command.add_option("NAME", request.name, "q-file (`mems` means q.mems); with --state, the problem")->required();
  command.add_option("LABEL", request.label, "label in contact, as GR1, or any label of a grazing curve");
  command.add_option("-p,--problem", request.problem, "problem P.cpp, P.tch, P.f or P.so [the name of the q-file]")
      ->type_name("P");
  command.add_option("-c,--constants", request.constants, "constants of the run that wrote the label [its r-file]")
      ->type_name("C");
  command.add_option("--jump", request.jump, "jump at the contact [the problem's, or GRJUMP]");
  command.add_option("--parameter", request.parameter, "parameter that brings the orbit into contact [first of ICP]");
  command
      .add_option("--section", request.section,
                  "section P' of a second map: an event function, or a state that is constant on it [the orbit's "
                  "section, if the contact is on it]")
      ->type_name("J");
  command.add_option("--xi", request.returns, "number of xi_n")->check(CLI::Range(1, 10000))->capture_default_str();
  command.add_option("--born", request.born, "list impacting orbits with one impact in up to so many returns")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--penetration", request.penetration, "largest penetration of the comparison with the exact map")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  const char* const group = "A contact given by hand, as on a torus";
  command.add_option("--state", request.state, "the state x*, as 0,0.1,-2 or x1=0.1,x2=3")->group(group);
  command.add_option("--mode", request.mode, "field, event function in contact, jump, as 1,1,1")->group(group);
  command.add_flag("--correct", request.correct, "move to the nearest state with h_D = h_P = 0")->group(group);
  command.add_option("KEY=VALUE", request.overrides, "parameters, as 'PAR(mu)=0.8'")->group(group);
}

}  // namespace

void add_grazing_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("grazing", "analyse a grazing contact: discontinuity map, xi_n, verdict, impacting orbits");
  const auto request = std::make_shared<GrazingRequest>();
  add_options(*command, *request);
  command->footer(
      "Prints the contact x* with a*, beta, B, A and xi_n; the discontinuity map beside the exact map; the\n"
      "verdict whether an attractor persists near grazing (continuous) or not (discontinuous); the impacting\n"
      "orbits that are born.\n"
      "Example: tchat grazing q.to_grazing GR1 -p linosc\n"
      "Exit status: 0 done, 1 the orbit cannot be integrated or the map not computed, 2 bad usage or input.");
  command->callback([&chosen, request] {
    if (request->label && request->label->find('=') != std::string::npos) {  // an override behind a problem's name
      request->overrides.insert(request->overrides.begin(), *request->label);
      request->label.reset();
    }
    chosen = [request] {
      if (request->state) take_source_as_problem(request->name, request->problem);
      analyse_grazing(*request, std::cout, std::cerr);
      return 0;
    };
  });
}

}  // namespace tchat
