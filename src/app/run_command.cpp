#include "app/run_command.hpp"

#include <fmt/format.h>

#include <CLI/Validators.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <memory>

#include "constants/user_error.hpp"
#include "run/run_problem.hpp"

namespace tchat {

namespace {

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t caught_signal = 0;

void remember_signal(int signal) {
  // A second signal ends the program the ordinary way.
  caught_signal = signal;
  std::signal(signal, SIG_DFL);
}

int do_run(const RunRequest& request) {
  std::signal(SIGINT, &remember_signal);
  std::signal(SIGTERM, &remember_signal);
  int status = 0;
  try {
    status = run_problem(request, std::cout, std::cerr, [] { return caught_signal != 0; });
  } catch (const std::exception& error) {
    if (caught_signal == 0) throw;
    // The failure may be the signal's doing, such as that of a compiler that it ended too.
    std::cerr << "tchat: interrupted: " << error.what() << '\n';
  }
  if (caught_signal == 0) return status;
  return 128 + static_cast<int>(caught_signal);
}

}  // namespace

void add_run_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("run", "compute a branch of orbits");
  const auto request = std::make_shared<RunRequest>();
  command
      ->add_option("NAME", request->name, "reads gc.NAME, NAME.so or NAME.cpp, NAME.dat; writes p.NAME q.NAME d.NAME")
      ->required();
  command->add_option("-c,--constants", request->constants, "read gc.C instead (a path is also accepted)");
  command->add_option("-p,--problem", request->problem, "plugin P.so, or P.cpp to compile if newer");
  command->add_option("-d,--data", request->data, "start from D.dat (a path is also accepted)");
  command->add_option("-s,--start", request->start, "restart from q.S, at the label that IRS names");
  command->add_option("-o,--output", request->output, "write p.O q.O d.O and r.O");
  command->add_flag("-q,--quiet", request->quiet, "no table and no summary on the screen");
  command->add_flag("--both", request->both_directions, "both directions of DS, one after the other");
  command->add_flag("--append", request->append, "add to p.O q.O d.O instead of replacing them");
  command->add_option("KEY=VALUE", request->overrides,
                      "constants and parameters for this run, e.g. DS=-0.01 NMX=50 IRS=PD1 'PAR(2)=0.8' PAR(omega)=0.8 "
                      "'UZR={1: [2.5, 3.0]}'");
  command->footer(
      "The table shows the first point, labelled points and inadmissible ones; p.O has every point.\n"
      "Exit status: 0 the branch was computed (also when it ended by MX), 1 no convergence at the first point or of "
      "the\n"
      "first step, 2 bad usage or bad input, 130 or 143 interrupted (files are complete).");
  command->callback([&chosen, request] { chosen = [request] { return do_run(*request); }; });
}

}  // namespace tchat
