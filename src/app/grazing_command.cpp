#include "app/grazing_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "app/problem_argument.hpp"
#include "grazing/analyse_grazing.hpp"

namespace tchat {

namespace {

void add_options(CLI::App& command, GrazingRequest& request) {
  command
      .add_option("NAME", request.name,
                  "q-file, `mems` is taken for q.mems when there is no file mems; with --state the problem")
      ->required();
  command.add_option("LABEL", request.label,
                     "label in grazing contact: GR1, a number, or any label of a grazing curve (IPS 150)");
  command.add_option("-p,--problem", request.problem, "plugin P.so, P.cpp or P.tch (default: the name of the q-file)")
      ->type_name("P");
  command
      .add_option("-c,--constants", request.constants,
                  "constants of the run that wrote the label (default: its r-file)")
      ->type_name("C");
  command.add_option("--jump", request.jump,
                     "jump that contact brings (default: what the problem says of that event, or GRJUMP)");
  command.add_option("--parameter", request.parameter,
                     "moves the orbit to its contact, and impacting orbits are born in it (default: first of ICP)");
  command
      .add_option("--section", request.section,
                  "P' besides P: an event function by number or name, or a state that is constant on it (default: the "
                  "orbit's own section, where the contact lies on it)")
      ->type_name("J");
  command.add_option("--xi", request.returns, "so many xi_n")->check(CLI::Range(1, 10000))->capture_default_str();
  command.add_option("--born", request.born, "impacting orbits with one impact in up to so many returns")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--penetration", request.penetration, "largest penetration compared; eight more decades follow")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  const char* const group = "A grazing point given by hand (a torus): the local part only";
  command.add_option("--state", request.state, "x*, as 0,0.1,-2 or x1=0.1,x2=3")->group(group);
  command.add_option("--mode", request.mode, "field, event function in contact, its jump: 1,1,1")->group(group);
  command.add_flag("--correct", request.correct, "take the nearest state with h_D = h_P = 0")->group(group);
  command.add_option("KEY=VALUE", request.overrides, "parameters, e.g. 'PAR(mu)=0.8'")->group(group);
}

}  // namespace

void add_grazing_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand(
      "grazing", "what follows from grazing contact: discontinuity map, xi_n, verdict, what is born");
  const auto request = std::make_shared<GrazingRequest>();
  add_options(*command, *request);
  command->footer(
      "With h_D the event function in contact and h_P = h_D,x f, on P (h_P = 0):\n"
      "  x*, a* = h_P,x f > 0, beta, B = -sqrt(2/a*) beta, A (derivative of the smooth return map), xi_n\n"
      "  discontinuity map: what contact makes of an intersection with P; coefficients of y = sqrt(-h_D), y^2, y^3,\n"
      "  of deviations d from x* and of y d, beside the exact map\n"
      "  verdict: does an attractor persist near grazing (continuous) or not (discontinuous), and why\n"
      "  impacting orbits that are born, one impact in k returns\n"
      "Examples:\n"
      "  tchat grazing q.to_grazing GR1 -p linosc\n"
      "  tchat grazing rand4d --state -0.7297,0.3634,0.7780,0.1323,-0.9912 --mode 1,1,1 --correct 'PAR(A)=1.1'\n"
      "Exit status: 0, 1 the orbit cannot be integrated or the map not be computed, 2 bad usage or bad input.");
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
