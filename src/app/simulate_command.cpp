#include "app/simulate_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/TypeTools.hpp>
#include <CLI/Validators.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "app/interruption.hpp"
#include "app/problem_argument.hpp"
#include "simulate/simulate_problem.hpp"

namespace tchat {

namespace {

/// Refuses what is no finite number with these bounds, and says what is `allowed`.
CLI::Validator number(double least, double most, const std::string& allowed) {
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        double value = 0.0;
        const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        if (is_number && value >= least && value <= most) return "";
        return fmt::format("found '{}'; allowed: {}", text, allowed);
      },
      "");
}

CLI::Validator count(long least, long most) {
  const std::string allowed = fmt::format("a whole number from {} to {}", least, most);
  const CLI::Validator is_whole(
      [=](const std::string& text) -> std::string {
        long value = 0;
        return CLI::detail::lexical_cast(text, value) ? "" : fmt::format("found '{}'; allowed: {}", text, allowed);
      },
      "");
  return is_whole & number(static_cast<double>(least), static_cast<double>(most), allowed);
}

CLI::Validator positive_time() { return number(1e-300, 1e300, "a finite number > 0"); }

int do_simulate(const SimulationRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    return simulate_problem(request, std::cout, std::cerr, interrupted, progress);
  });
}

void add_start_options(CLI::App& command, SimulationRequest& request) {
  const char* const group = "Start";
  command.add_option("--state", request.state, "all states, as 0,0.1,-2, or some by name, as x1=0.1,x2=3")
      ->group(group);
  command.add_option("-d,--data", request.data, "start in the first row of D.dat, with its parameters")
      ->type_name("D")
      ->group(group);
  command.add_option("-s,--start", request.start, "start in the orbit that IRS names in q.S, with its parameters")
      ->type_name("S")
      ->group(group);
  command
      .add_option("--mode", request.modes,
                  "index vectors to watch first, as 1,2,1 or '1,2,1;1,3,2' [what the problem says of a start, else the "
                  "first of gc.C]")
      ->group(group);
  command
      .add_option("--signature", request.signature,
                  "follow these index vectors one after the other, as '1,1,1;2,2,2', whatever else the problem says")
      ->group(group);
  command
      .add_flag("--follow-signature", request.follow_signature,
                "the index vectors of gc.C one after the other, even where the problem has an index jump function")
      ->group(group);
}

void add_length_options(CLI::App& command, SimulationRequest& request) {
  const char* const group =
      "Length [until a periodic orbit is recognised, at most 10000 events; "
      "of a longer motion O.trajectory then holds the last 10 MB]";
  SimulationPlan& plan = request.plan;
  command.add_option("--time", plan.time, "so long after the transient")
      ->type_name("T")
      ->check(positive_time())
      ->group(group);
  command.add_option("--events", plan.events, "so many events after the transient")
      ->type_name("N")
      ->check(count(1, 1000000000))
      ->group(group);
  command.add_option("--transient-time", plan.transient_time, "drop what begins before this time")
      ->type_name("T")
      ->check(number(0.0, 1e300, "a finite number >= 0"))
      ->group(group);
  command.add_option("--transient-events", plan.transient_events, "drop so many first segments")
      ->type_name("N")
      ->check(count(0, 1000000000))
      ->group(group);
  command.add_option("--wait", request.wait, "give up after so long without an event")
      ->type_name("T")
      ->check(positive_time())
      ->capture_default_str()
      ->group(group);
}

void add_exponent_options(CLI::App& command, SimulationRequest& request, int& exponents) {
  const char* const group = "Lyapunov exponents";
  command
      .add_option("--lyapunov", exponents,
                  "the K largest Lyapunov exponents with their error bars, per unit of time, natural logarithm [all]")
      ->expected(0, 1)
      ->type_name("[K]")
      ->check(count(1, 1000))
      ->group(group);
  command
      .add_option("--section", request.section,
                  "those of the return map instead, per fall of event function J through zero, which need not end "
                  "segments")
      ->type_name("J")
      ->check(count(1, 1000))
      ->needs("--lyapunov")
      ->group(group);
  command
      .add_option(
          "--accuracy", request.accuracy,
          "without --time and --events: go on from where the motion repeats itself, or does not, until the bars "
          "are below this, at most 100000 events")
      ->type_name("E")
      ->check(number(1e-12, 1e300, "a number from 1e-12"))
      ->capture_default_str()
      ->needs("--lyapunov")
      ->group(group);
}

void add_detail_options(CLI::App& command, SimulationRequest& request) {
  const char* const group = "Details";
  command.add_option("--tolerance", request.tolerance, "relative error of one integration step")
      ->type_name("E")
      ->check(number(1e-15, 1e-2, "a number from 1e-15 to 0.01"))
      ->capture_default_str()
      ->group(group);
  command.add_flag("--stiff", request.stiff, "backward differentiation instead of Adams' formulas")->group(group);
  command.add_option("--max-period", request.plan.max_period, "longest periodic orbit, in events")
      ->type_name("N")
      ->check(count(1, 1000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--recognition", request.plan.recognition,
                  "difference, relative to the orbit's range, below which states are the same")
      ->type_name("E")
      ->check(number(1e-12, 1e-1, "a number from 1e-12 to 0.1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--contact", request.contact,
                  "a least value of h below this share of its largest value is a near-grazing contact")
      ->type_name("E")
      ->check(number(0.0, 1.0, "a number from 0 to 1"))
      ->capture_default_str()
      ->group(group);
  command.add_option("--rows", request.rows, "at most so many rows of each segment in O.trajectory; 0 none")
      ->type_name("N")
      ->check(count(0, 1000000))
      ->capture_default_str()
      ->group(group);
}

}  // namespace

void add_simulate_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("simulate", "integrate forward with events, from a state to the attractor");
  const auto request = std::make_shared<SimulationRequest>();
  command->add_option("NAME", request->name, "reads NAME.cpp or NAME.tch, and gc.NAME if there is one")->required();
  command->add_option("-c,--constants", request->constants, "signature, monitored events and constants from gc.C")
      ->type_name("C");
  command->add_option("-p,--problem", request->problem, "plugin P.so, or P.cpp, P.tch to compile if newer")
      ->type_name("P");
  command->add_option("-o,--output", request->output, "write O.trajectory and O.events [NAME]")->type_name("O");
  command->add_flag("-q,--quiet", request->quiet, "no summary on the screen");
  add_start_options(*command, *request);
  add_length_options(*command, *request);
  const auto exponents = std::make_shared<int>(0);
  add_exponent_options(*command, *request, *exponents);
  add_detail_options(*command, *request);
  command
      ->add_option("--dat", request->orbit_name,
                   "write the periodic orbit found as NAME2.dat and gc.NAME2 for tchat run [O]; exit status 1 if none")
      ->expected(0, 1)
      ->type_name("[NAME2]")
      ->group("Periodic orbit");
  command
      ->add_flag(
          "--without-sections", request->without_sections,
          "Poincare sections (identity jump, the same field after it) end no segments of the orbit, unless nothing "
          "else does")
      ->group("Periodic orbit");
  command->add_option("--free", request->parameter, "continuation parameter in gc.NAME2 [ICP(1) of gc.C, else PAR(1)]")
      ->group("Periodic orbit");
  command->add_option("KEY=VALUE", request->overrides,
                      "parameters and constants, e.g. 'PAR(omega)=0.8' 'PAR(1)=0.5' NTST=100 IRS=PD1");
  command->footer(
      "After each event the problem's index jump function (successors) says which index vectors are watched next;\n"
      "the first event function that falls to zero decides. Without one a signature is followed: --signature, gc.C.\n"
      "O.events lists every event with the states before and after the jump and h_x f, and near-grazing contacts.\n"
      "Nothing depends on some states, as a position on an endless floor: those may advance in a periodic orbit.\n"
      "Examples:\n"
      "  tchat simulate linosc                                         # from the problem's own start\n"
      "  tchat simulate linosc 'PAR(alpha)=3' --dat found && tchat run linosc -c found -d found\n"
      "  tchat simulate linosc --state x1=0.5 --time 100 --transient-time 50 -o trial\n"
      "  tchat simulate linosc 'PAR(alpha)=3' --lyapunov               # Lyapunov exponents of where it settles\n"
      "  tchat simulate mine --signature '1,1,1;2,2,2' --state 0,0.3   # a problem without successors\n"
      "  tchat simulate linosc -c impacting -s impacting IRS=PD1 'PAR(alpha)=3.0361' --dat doubled\n"
      "Exit status: 0 simulated (also when events accumulate), 1 a function cannot be evaluated, or --dat without a\n"
      "periodic orbit, 2 bad usage or bad input, 130 or 143 interrupted (files are complete).");
  command->callback([&chosen, request, exponents, command] {
    if (command->count("--lyapunov") > 0) request->lyapunov = *exponents;
    request->hand_over = command->count("--dat") > 0;
    if (request->orbit_name.find('=') != std::string::npos) {  // `--dat PAR(1)=2`: no name, an override
      request->overrides.push_back(request->orbit_name);
      request->orbit_name.clear();
    }
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_simulate(*request);
    };
  });
}

}  // namespace tchat
