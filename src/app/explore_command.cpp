#include "app/explore_command.hpp"

#include <unistd.h>

#include <CLI/Validators.hpp>
#include <iostream>
#include <memory>

#include "app/interruption.hpp"
#include "app/problem_argument.hpp"
#include "app/simulation_options.hpp"
#include "explore/explorer.hpp"

namespace tchat {

namespace {

int do_explore(const ExploreRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly(
      [&](const std::function<bool()>& interrupted) { return explore(request, interrupted, std::cout, progress); });
}

}  // namespace

void add_explore_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("explore", "the whole diagram over a parameter: attractors, branches, switches");
  const auto request = std::make_shared<ExploreRequest>();
  command->add_option("NAME", request->name, "problem NAME.cpp or NAME.tch")->required();
  command->add_option("-c,--constants", request->constants, "constants of the simulations from gc.C")->type_name("C");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command
      ->add_option("-o,--output", request->output,
                   "folder of the files; O.txt, O.json, O.png, O.svg, O.html, Makefile.O [NAME.diagram]")
      ->type_name("O");
  command->add_option("--over", request->over, "range of the parameter, and the number of values of the sweep [201]")
      ->required()
      ->type_name("P=FROM:TO[:COUNT]");
  command->add_option("--and", request->second, "range of a second parameter: curves of the special points in both")
      ->type_name("Q=FROM:TO");
  command->add_option("--state", request->states, "initial state of the sweep, as 0,0.1,-2; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("-y", request->quantity, "y-axis of the picture [the max(X) that varies most]")
      ->type_name("QUANTITY");
  command->add_option("-j,--jobs", request->workers, "commands at a time; they do not change the result")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--starts", request->starts, "further initial states, from each of which every value is simulated")
      ->type_name("N")
      ->check(whole_number(0, 1000))
      ->capture_default_str();
  command->add_option("--segments", request->segments, "most segments of a signature that is followed")
      ->type_name("N")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command->add_option("--doublings", request->doublings, "period doublings to follow, one after the other")
      ->type_name("N")
      ->check(whole_number(0, 16))
      ->capture_default_str();
  command->add_option("--branches", request->branches, "most branches; with --and, most curves too")
      ->type_name("N")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--returns", request->returns,
                   "at grazing, orbits with one impact in up to K returns [1; 4 where xi_n = 0 on a grazing curve]")
      ->type_name("K")
      ->check(whole_number(1, 64));
  command->add_option("--time", request->seconds, "seconds after which no command is begun; the same command goes on")
      ->type_name("T")
      ->check(CLI::PositiveNumber);
  command->add_flag("--tori", request->tori, "follow the tori that are born at TR");
  command->add_flag("-q,--quiet", request->quiet, "print nothing");
  command->add_option("KEY=VALUE", request->overrides,
                      "parameters of all commands, constants of the runs, as 'PAR(omega)=0.8' NMX=100");
  command->footer(
      "A sweep finds attractors. Each is followed in both directions, and at special points the command\n"
      "that `tchat run` proposes follows what begins there, until nothing new is found.\n"
      "With --and, each special point is then followed as a curve in both parameters.\n"
      "All commands are in Makefile.O, which makes the same files without tchat explore.\n"
      "Example: tchat explore linosc --over alpha=1.5:4 'PAR(omega)=2.0072' -j 2\n"
      "Exit status: 0 branches were found, 1 none, 2 bad usage or input, 130 or 143 interrupted.");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_explore(*request);
    };
  });
}

}  // namespace tchat
