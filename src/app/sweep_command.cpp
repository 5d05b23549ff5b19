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
#include "map_sweep/map_sweep_problem.hpp"
#include "sweep/sweep_problem.hpp"
#include "text/words.hpp"

namespace tchat {

namespace {

constexpr const char* sweep_length_group =
    "Length [until a periodic orbit is recognised; otherwise 1000 events are dropped and 100 recorded]";

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
                  "states where event function J (number or name) falls through zero, before the jump, also where it "
                  "ends no segment; all: where any event ends a segment; none [all over one parameter, else none]")
      ->type_name("J")
      ->group(group);
  command
      .add_option("--penetration", request.penetration,
                  "minus the least value of event function J on the smooth flow, an impact there taken account of only "
                  "afterwards; without --section the states there are recorded, each with its own")
      ->type_name("J")
      ->group(group);
  add_exponent_count(command, exponents, "the K largest Lyapunov exponents, with errors [all]", group);
}

void add_map_options(CLI::App& command, MapRequest& map) {
  const char* const group = "Composite map, instead of simulations";
  command
      .add_option(
          "--map", map.source,
          "iterate the smooth return map after the discontinuity map: of the grazing orbit or of the "
          "torus LABEL in q.NAME, or of the torus whose section points are in FILE (O.events of a simulation without "
          "contact, or O.sweep)")
      ->type_name("q.NAME:LABEL|FILE")
      ->group(group);
  command.add_option("--order", map.order, "of the discontinuity map: 1/2, 1, 3/2 or exact")
      ->capture_default_str()
      ->group(group);
  command.add_option("--smooth-order", map.smooth_order, "of the smooth return map, in state and parameter: 1 or 2")
      ->type_name("N")
      ->check(whole_number(1, 2))
      ->capture_default_str()
      ->group(group);
  command
      .add_option(
          "--reduced", map.reduced,
          "tori: the phase alone, as if all came back to the curve at once (map); with what contact does to it to "
          "lowest order (ellipse) [map]")
      ->expected(0, 1)
      ->type_name("[KIND]")
      ->default_str("map")
      ->group(group);
  command
      .add_option(
          "--phase", map.phase,
          "tori: a state that is an angle, or two that go round as y1,y2, by which points have theirs on the curve "
          "[an angle, if there is one, else the nearest point]")
      ->type_name("STATE")
      ->group(group);
  command
      .add_option("--wall", map.wall, "tori: event function in contact, number or name [the only one with an impact]")
      ->type_name("J")
      ->group(group);
  command
      .add_option("--neighbourhood", map.neighbourhood,
                  "contact is accounted for within so many extents of the motion from the grazing point [orbits: "
                  "everywhere, tori: 0.25]")
      ->type_name("R")
      ->check(CLI::PositiveNumber)
      ->group(group);
}

void add_work_options(CLI::App& command, SweepRequest& request) {
  const char* const group = "Workers and parts";
  command.add_option("-j,--jobs", request.workers, "so many threads; the file is the same for any number")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str()
      ->group(group);
  command.add_option("--part", request.part, "only part I of N, written as O.sweep.I")->type_name("I/N")->group(group);
  command.add_flag("--gather", request.gather, "join O.sweep.1 to O.sweep.N to O.sweep")->group(group);
  command.add_flag("--fresh", request.fresh, "throw away what an interrupted sweep of this name has left")
      ->group(group);
  command
      .add_flag("--to-the-end", request.to_the_end,
                "basins: simulate every start until its motion repeats itself, instead of until a known attractor has "
                "captured it")
      ->group(group);
}

}  // namespace

void add_sweep_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("sweep", "attractors over one or two parameters or initial states: diagrams, maps, basins");
  const auto request = std::make_shared<SweepRequest>();
  const auto map = std::make_shared<MapRequest>();
  SimulationRequest& simulation = request->simulation;
  simulation.plan.transient_events = 1000;
  simulation.plan.events = 100;
  simulation.tolerance = 1e-8;  // of a method whose steps are better than their estimate
  add_problem_options(*command, simulation);
  command->add_option("-o,--output", simulation.output, "write O.sweep [NAME]")->type_name("O");
  command->add_flag("-q,--quiet", simulation.quiet, "no summary on the screen");
  command
      ->add_option("--over", request->over,
                   "COUNT values of a parameter or an initial state, FROM and TO among them; once or twice")
      ->type_name("NAME=FROM:TO:COUNT")
      ->allow_extra_args(false)
      ->take_all()
      ->group("Start");
  command
      ->add_option("--follow", request->follow,
                   "each value starts from the attractor of its neighbour: up, down or both, along the first --over")
      ->type_name("DIRECTION")
      ->group("Start");
  command
      ->add_option("--state", request->states,
                   "all states, as 0,0.1,-2, or some by name, as x1=0.1,x2=3; several times: several starts")
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
  command->add_option("KEY=VALUE", simulation.overrides,
                      "parameters and constants, e.g. 'PAR(omega)=0.8' 'PAR(1)=0.5'");
  command->footer(
      "O.sweep is a table: index, values, start, attractor (its number), kind, period (events), time, impacts, what "
      "was\n"
      "asked for, and the recorded states, one a row. Its heading has a state of each attractor for tchat simulate.\n"
      "Killed or interrupted, the same command continues where it stopped (O.sweep.journal).\n"
      "Examples:\n"
      "  tchat sweep linosc --over alpha=2.9:3.1:201 'PAR(omega)=2.0072' -j 4          # a brute-force diagram\n"
      "  tchat sweep linosc --over alpha=1.9:2.7:401 'PAR(omega)=1.8901' --follow both --section 1   # hysteresis\n"
      "  tchat sweep rand3d --over mu=-0.81:-0.79:201 --penetration 1 --follow both    # penetrations\n"
      "  tchat sweep linosc --over alpha=2:3:60 --over omega=1.7:2:60                  # kinds over two parameters\n"
      "  tchat sweep linosc --over x1=-1:1:200 --over x2=-5:5:200 'PAR(alpha)=2.2' 'PAR(omega)=1.8901'   # a basin\n"
      "  for i in 1 2 3; do tchat sweep linosc --over alpha=2.9:3.1:201 --part $i/3; done     # or on three machines\n"
      "  tchat sweep linosc --over alpha=2.9:3.1:201 --gather\n"
      "Exit status: 0 done, 1 files cannot be written, 2 bad usage or bad input, 130 or 143 interrupted.");
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
