#include "app/sweep_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "app/interruption.hpp"
#include "app/problem_argument.hpp"
#include "app/simulation_options.hpp"
#include "base/words.hpp"
#include "maps/map_sweep_problem.hpp"
#include "simulate/sweep_setup.hpp"

namespace tchat {

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
  simulation.tolerance = 1e-8;  // of a method whose steps are better than their estimate
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
