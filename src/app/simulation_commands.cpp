#include "app/commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "app/command_options.hpp"
#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "maps/map_sweep_problem.hpp"
#include "maps/simulated_torus.hpp"
#include "simulate/simulate_problem.hpp"
#include "simulate/sweep_setup.hpp"

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
      ->check(number_within(level::negligible, 1e300, "a number from 1e-12"))
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

namespace {

constexpr const char* sweep_length_group =
    "Length [until a periodic orbit is recognised, else 100 events after a transient of 1000]";

/// This process's command line without what says which part it does.
std::string command_without_part() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::string command = "tchat";
  std::size_t begin = bytes.find('\0');
  bool skips = false;
  while (begin != std::string::npos && begin + 1 < bytes.size()) {
    const std::size_t end = bytes.find('\0', begin + 1);
    const std::string word = bytes.substr(begin + 1, end - begin - 1);
    begin = end;
    const bool is_value_of_part = skips;
    skips = word == "--part";
    if (is_value_of_part || word == "--part" || word.starts_with("--part=") || word == "--gather") continue;
    command += " " + quoted_for_shell(word);
  }
  return command;
}

int do_sweep(const SweepRequest& request, const MapRequest& map) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.simulation.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    const SweepConsole console{std::cout, std::cerr, interrupted, progress};
    return map.source.empty() ? sweep_problem(request, console) : map_sweep_problem(request, map, console);
  });
}

void add_recording_options(CLI::App& command, SweepRequest& request, std::string& exponents) {
  const char* const group = "What is recorded";
  command
      .add_option("--section", request.section,
                  "states where event function J (number or name) falls through zero, even if it ends no segment; all: "
                  "where any event ends a segment; none [all over one parameter, else none]")
      ->type_name("J")
      ->group(group);
  command
      .add_option("--penetration", request.penetration,
                  "minus the minima of event function J, measured without the impact")
      ->type_name("J")
      ->group(group);
  command.add_flag("--max", request.largest, "largest value of each state over a period, as columns max(X)")
      ->group(group);
  add_exponent_count(command, exponents, "the K largest Lyapunov exponents and their errors [all]", group);
}

void add_map_options(CLI::App& command, MapRequest& map) {
  const char* const group = "Composite map, instead of simulations";
  command
      .add_option("--map", map.source,
                  "iterate the map of the grazing orbit or torus LABEL in q.NAME, or of the torus with section points "
                  "in FILE (O.events or O.sweep of a simulation without contact)")
      ->type_name("q.NAME:LABEL|FILE")
      ->group(group);
  command.add_option("--order", map.order, "order of the discontinuity map: 1/2, 1, 3/2 or exact")
      ->capture_default_str()
      ->group(group);
  command.add_option("--smooth-order", map.smooth_order, "order of the smooth return map: 1 or 2")
      ->type_name("N")
      ->check(whole_number(1, 2))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--reduced", map.reduced,
                  "tori: phase only; project to the curve (map), or lowest-order effect of contact (ellipse) [map]")
      ->expected(0, 1)
      ->type_name("[KIND]")
      ->default_str("map")
      ->group(group);
  command
      .add_option("--phase", map.phase,
                  "tori: angle, or two states y1,y2, by which states are projected [an angle, else the nearest point]")
      ->type_name("STATE")
      ->group(group);
  command
      .add_option("--wall", map.wall, "tori: event function in contact, number or name [the only one with an impact]")
      ->type_name("J")
      ->group(group);
  command
      .add_option("--neighbourhood", map.neighbourhood,
                  "largest distance of contact from x*, in sizes of the motion [orbits: any, tori: 0.25]")
      ->type_name("R")
      ->check(CLI::PositiveNumber)
      ->group(group);
}

void add_work_options(CLI::App& command, SweepRequest& request) {
  const char* const group = "Workers and parts";
  command.add_option("-j,--jobs", request.workers, "threads; they do not change the file")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str()
      ->group(group);
  command.add_option("--part", request.part, "compute part I of N only, as O.sweep.I")->type_name("I/N")->group(group);
  command.add_flag("--gather", request.gather, "join O.sweep.1 to O.sweep.N to O.sweep")->group(group);
  command.add_flag("--fresh", request.fresh, "discard the journal of an interrupted sweep")->group(group);
  command
      .add_flag("--to-the-end", request.to_the_end,
                "basins: simulate until the motion repeats itself, without capture regions")
      ->group(group);
}

}  // namespace

void add_sweep_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("sweep", "attractors over parameters or initial states: diagrams, maps, basins");
  const auto request = std::make_shared<SweepRequest>();
  const auto map = std::make_shared<MapRequest>();
  SimulationRequest& simulation = request->simulation;
  simulation.plan.transient_events = 1000;
  simulation.plan.events = 100;
  simulation.tolerance = level::differences;  // of a method whose steps are better than their estimate
  add_problem_options(*command, simulation);
  command->add_option("-o,--output", simulation.output, "write O.sweep [NAME]")->type_name("O");
  command->add_flag("-q,--quiet", simulation.quiet, "print no summary");
  command->add_option("--over", request->over, "COUNT values of a parameter or initial state, FROM to TO; up to twice")
      ->type_name("NAME=FROM:TO:COUNT")
      ->allow_extra_args(false)
      ->take_all()
      ->group("Start");
  command
      ->add_option("--follow", request->follow,
                   "start from the attractor of the neighbouring value of the first --over: up, down or both")
      ->type_name("DIRECTION")
      ->group("Start");
  command->add_option("--state", request->states, "initial state, as 0,0.1,-2 or x1=0.1,x2=3; may be repeated")
      ->allow_extra_args(false)
      ->take_all()
      ->group("Start");
  add_start_options(*command, simulation);
  add_length_options(*command, simulation, sweep_length_group);
  const auto exponents = std::make_shared<std::string>();
  add_recording_options(*command, *request, *exponents);
  add_map_options(*command, *map);
  add_work_options(*command, *request);
  add_detail_options(*command, simulation);
  command->add_option("KEY=VALUE", simulation.overrides, "parameters and constants, as 'PAR(omega)=0.8'");
  command->footer(
      "O.sweep is a table of values, attractors, kinds, periods and recorded states, one a row.\n"
      "After an interruption, the same command continues (O.sweep.journal).\n"
      "Example: tchat sweep linosc --over alpha=2.9:3.1:201 'PAR(omega)=2.0072' -j 4\n"
      "Exit status: 0 done, 1 files cannot be written, 2 bad usage or input, 130 or 143 interrupted.");
  command->callback([&chosen, request, exponents, map, command] {
    request->exponents = exponent_count(*command, *exponents, request->simulation.overrides);
    if (command->count("--time") > 0 && command->count("--events") == 0) request->simulation.plan.events.reset();
    if (command->count("--reduced") > 0 && map->reduced.value_or("").empty()) map->reduced = "map";
    chosen = [request, map] {
      take_source_as_problem(request->simulation.name, request->simulation.problem);
      request->command = command_without_part();
      return do_sweep(*request, *map);
    };
  });
}

}  // namespace tchat
