#include "app/run_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/Validators.hpp>
#include <iostream>
#include <memory>

#include "app/interruption.hpp"
#include "app/problem_argument.hpp"
#include "app/simulation_options.hpp"
#include "run/run_problem.hpp"

namespace tchat {

namespace {

int do_run(const RunRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    return run_problem(request, std::cout, std::cerr, interrupted, progress);
  });
}

}  // namespace

void add_run_options(CLI::App& command, RunRequest& request) {
  command.add_option("-c,--constants", request.constants, "constants gc.C, or a path [gc.NAME]")->type_name("C");
  command.add_option("-p,--problem", request.problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command.add_option("-d,--data", request.data, "start from D.dat, or a path [NAME.dat]")->type_name("D");
  command.add_option("-s,--start", request.start, "restart from the label IRS of q.S [q.NAME if IRS > 0]")
      ->type_name("S");
  command.add_option("-o,--output", request.output, "write p.O q.O d.O r.O [NAME]")->type_name("O");
  command.add_flag("-q,--quiet", request.quiet, "print no table and no summary");
  command.add_flag("--both", request.both_directions, "both directions of DS, each a branch of its own");
  command.add_flag("--append", request.append, "add to the files instead of replacing them");
  command.add_flag("--clip", request.clip, "end on RL0, RL1, A0, A1, not at the first point beyond them");
  command.add_flag("--strict", request.strict, "exit status 3 if a branch ends by MX");
  command
      .add_option("-j,--jobs", request.threads,
                  "threads for the linear algebra of large problems; they do not change the files")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command.add_option("KEY=VALUE", request.overrides,
                     "constants and parameters, as DS=-0.01 IRS=PD1 'PAR(omega)=0.8' 'UZR={1: [2.5, 3.0]}'");
}

void add_run_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("run", "compute a branch of orbits");
  const auto request = std::make_shared<RunRequest>();
  command
      ->add_option("NAME", request->name,
                   "problem NAME.cpp or NAME.tch; reads gc.NAME, NAME.dat; writes p.NAME q.NAME d.NAME r.NAME")
      ->required();
  add_run_options(*command, *request);
  command->footer(
      "The table shows the first point, special points, and where orbits become inadmissible; p.O has all.\n"
      "Example: tchat run linosc -c impacting -d impacting -o up NMX=50\n"
      "Exit status: 0 a branch was computed, even if it ended by MX; 1 no convergence at the first point\n"
      "or step; 2 bad usage or input; 3 ended by MX with --strict; 130 or 143 interrupted (complete files).");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_run(*request);
    };
  });
}

}  // namespace tchat
