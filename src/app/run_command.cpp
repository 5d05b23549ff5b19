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

void add_run_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("run", "compute a branch of orbits");
  const auto request = std::make_shared<RunRequest>();
  command
      ->add_option("NAME", request->name, "reads gc.NAME, NAME.cpp or NAME.tch, NAME.dat; writes p.NAME q.NAME d.NAME")
      ->required();
  command->add_option("-c,--constants", request->constants, "read gc.C instead (a path is also accepted)")
      ->type_name("C");
  command->add_option("-p,--problem", request->problem, "plugin P.so, or P.cpp, P.tch to compile if newer")
      ->type_name("P");
  command->add_option("-d,--data", request->data, "start from D.dat (a path is also accepted)")->type_name("D");
  command->add_option("-s,--start", request->start, "restart from q.S, at the label that IRS names")->type_name("S");
  command->add_option("-o,--output", request->output, "write p.O q.O d.O and r.O")->type_name("O");
  command->add_flag("-q,--quiet", request->quiet, "no table and no summary on the screen");
  command->add_flag("--both", request->both_directions, "both directions of DS, one after the other");
  command->add_flag("--append", request->append, "add to p.O q.O d.O instead of replacing them");
  command->add_flag("--clip", request->clip, "end on RL0, RL1, A0, A1, not at the first point beyond them");
  command->add_flag("--strict", request->strict, "exit status 3 when a branch ends by MX");
  command
      ->add_option("-j,--jobs", request->threads,
                   "so many threads share the linear algebra of large problems; the files are the same for any number")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option(
      "KEY=VALUE", request->overrides,
      "constants and parameters for this run, e.g. DS=-0.01 NMX=50 IRS=PD1 'PAR(2)=0.8' 'PAR(omega)=0.8' "
      "'UZR={1: [2.5, 3.0]}'");
  command->footer(
      "The table shows the first point, special points, and where orbits become inadmissible; labels that NPR asks\n"
      "for are in the files alone, and p.O has every point.\n"
      "Exit status: 0 the branch was computed (also when it ended by MX), 1 no convergence at the first point or of "
      "the\n"
      "first step, 2 bad usage or bad input, 3 ended by MX with --strict, 130 or 143 interrupted (files are "
      "complete).");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_run(*request);
    };
  });
}

}  // namespace tchat
