#include "app/simulate_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <memory>

#include "app/interruption.hpp"
#include "app/problem_argument.hpp"
#include "app/simulation_options.hpp"
#include "base/user_error.hpp"
#include "maps/simulated_torus.hpp"
#include "simulate/simulate_problem.hpp"

namespace tchat {

namespace {

int do_simulate(const SimulationRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    return simulate_problem(request, std::cout, std::cerr, interrupted, progress);
  });
}

int do_simulate_torus(const SimulationRequest& request, const std::string& torus_name) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    return simulate_torus(request, torus_name, std::cout, std::cerr, interrupted, progress);
  });
}

constexpr const char* length_group =
    "Length [until a periodic orbit is recognised, at most 10000 events; O.trajectory has the last 10 MB]";

void add_exponent_options(CLI::App& command, SimulationRequest& request, std::string& exponents) {
  const char* const group = "Lyapunov exponents";
  add_exponent_count(command, exponents, "the K largest Lyapunov exponents and their error bars [all]", group);
  command
      .add_option("--section", request.section,
                  "exponents of the return map: per fall of event function J through zero")
      ->type_name("J")
      ->check(whole_number(1, 1000))
      ->needs("--lyapunov")
      ->group(group);
  command
      .add_option("--accuracy", request.accuracy,
                  "without --time and --events: continue until error bars are below E, at most 100000 events")
      ->type_name("E")
      ->check(number_within(1e-12, 1e300, "a number from 1e-12"))
      ->capture_default_str()
      ->needs("--lyapunov")
      ->group(group);
}

void add_noted_options(CLI::App& command, SimulationRequest& request) {
  const char* const group = "Details";
  command
      .add_option("--contact", request.contact,
                  "a minimum of h below this share of its largest value is a near-grazing contact")
      ->type_name("E")
      ->check(number_within(0.0, 1.0, "a number from 0 to 1"))
      ->capture_default_str()
      ->group(group);
  command.add_option("--rows", request.rows, "largest number of rows of a segment in O.trajectory")
      ->type_name("N")
      ->check(whole_number(0, 1000000))
      ->capture_default_str()
      ->group(group);
}

}  // namespace

void add_simulate_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("simulate", "integrate forward to an attractor, with events");
  const auto request = std::make_shared<SimulationRequest>();
  add_problem_options(*command, *request);
  command->add_option("-o,--output", request->output, "write O.trajectory and O.events [NAME]")->type_name("O");
  command->add_flag("-q,--quiet", request->quiet, "print no summary");
  command
      ->add_option("--state", request->state, "initial state: all states, as 0,0.1,-2, or some by name, as x1=0.1,x2=3")
      ->group("Start");
  add_start_options(*command, *request);
  add_length_options(*command, *request, length_group);
  const auto exponents = std::make_shared<std::string>();
  add_exponent_options(*command, *request, *exponents);
  add_detail_options(*command, *request);
  add_noted_options(*command, *request);
  command
      ->add_option("--dat", request->orbit_name, "write the periodic orbit as NAME2.dat and gc.NAME2 for tchat run [O]")
      ->expected(0, 1)
      ->type_name("[NAME2]")
      ->group("Periodic orbit");
  command
      ->add_flag("--refine", request->refine,
                 "Newton's method from a guess of an orbit, stable or not: from --events N events, else up to the "
                 "nearest return within --max-period")
      ->excludes("--lyapunov")
      ->group("Periodic orbit");
  command
      ->add_flag("--without-sections", request->without_sections,
                 "sections (identity jump, same field after it) end no segments of the orbit, if something else does")
      ->group("Periodic orbit");
  const auto torus_name = std::make_shared<std::string>();
  command
      ->add_option(
          "--torus", *torus_name,
          "fit a closed curve to the returns of the signature, and write the torus as q.NAME2 and gc.NAME2 [O]")
      ->expected(0, 1)
      ->type_name("[NAME2]")
      ->excludes("--refine")
      ->group("Torus");
  command->add_option("--free", request->parameter, "continuation parameter in gc.NAME2 [ICP(1) of gc.C, else PAR(1)]")
      ->group("Periodic orbit");
  command->add_option("KEY=VALUE", request->overrides,
                      "parameters and constants, as 'PAR(omega)=0.8' NTST=100 IRS=PD1");
  command->footer(
      "After each event, the problem's index jump function (successors) returns the index vectors to watch\n"
      "next. Without it, simulations follow --signature or that of gc.C. O.events lists events and contacts.\n"
      "Example: tchat simulate linosc 'PAR(alpha)=3' --dat found && tchat run linosc -c found -d found\n"
      "Exit status: 0 simulated, even if events accumulate; 1 a function cannot be evaluated, or --dat\n"
      "without a periodic orbit; 2 bad usage or input; 130 or 143 interrupted (complete files).");
  command->callback([&chosen, request, exponents, torus_name, command] {
    request->lyapunov = exponent_count(*command, *exponents, request->overrides);
    request->hand_over = command->count("--dat") > 0;
    if (request->orbit_name.find('=') != std::string::npos) {  // `--dat PAR(1)=2`: no name, an override
      request->overrides.push_back(request->orbit_name);
      request->orbit_name.clear();
    }
    if (torus_name->find('=') != std::string::npos) {
      request->overrides.push_back(*torus_name);
      torus_name->clear();
    }
    const bool torus = command->count("--torus") > 0;
    chosen = [request, torus_name, torus] {
      if (torus && request->hand_over)
        throw UserError(
            "--dat writes a periodic orbit and --torus a torus; a motion is one of them, so give one option");
      take_source_as_problem(request->name, request->problem);
      return torus ? do_simulate_torus(*request, *torus_name) : do_simulate(*request);
    };
  });
}

}  // namespace tchat
