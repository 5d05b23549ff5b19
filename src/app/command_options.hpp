/// What commands have in common: options, the problem's name, and interruption by signals.
#pragma once

#include <CLI/App.hpp>
#include <CLI/CLI.hpp>
#include <CLI/Validators.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/table_writer.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

// Ctrl-C and SIGTERM for commands that finish what they are at: their files are complete, the exit status is 128 + the
// signal. Where that takes too long (a plugin that never returns), the program is ended at once, with the same status:
// by a second signal, or some seconds after the first: 5, or three times the longest time that it has taken so far
// from one question to the next.

/// Calls `work` with a question it asks now and then: has a signal come? Returns its exit status, or 128 + the signal.
int run_interruptibly(const std::function<int(const std::function<bool()>& interrupted)>& work);

// NAME on the command line of commands that look for more than a plugin under that name.

/// NAME.tch or NAME.cpp means the problem NAME with that plugin, unless -p names another one.
void take_source_as_problem(std::string& name, std::optional<std::string>& plugin);

// Options that the commands which simulate have in common.

/// Refuses what is no finite number with these bounds, and says what is `allowed`.
CLI::Validator number_within(double least, double most, const std::string& allowed);
CLI::Validator whole_number(long least, long most);
CLI::Validator positive_time();

/// NAME, -c, -p
void add_problem_options(CLI::App& command, SimulationRequest& request);
/// Where a simulation starts, but for --state
void add_start_options(CLI::App& command, SimulationRequest& request);
void add_length_options(CLI::App& command, SimulationRequest& request, const char* group);
/// --lyapunov [K], kept as its text.
void add_exponent_count(CLI::App& command, std::string& text, const std::string& help, const char* group);
/// How many exponents are asked for, 0 all; nothing without the option. What has followed the option may be the next
/// KEY=VALUE.
std::optional<int> exponent_count(const CLI::App& command, const std::string& text,
                                  std::vector<std::string>& overrides);
/// The integrator and the recognition of periodic orbits
void add_detail_options(CLI::App& command, SimulationRequest& request);

// The options of a command that prints a table for other programs: one for each format.

/// The format that the user asks for, as a place in table_formats(); nothing without one.
using ChosenFormat = std::shared_ptr<std::optional<std::size_t>>;

/// Adds --csv, --json, ..., of which one may be given.
inline ChosenFormat add_table_formats(CLI::App& command) {
  auto chosen = std::make_shared<std::optional<std::size_t>>();
  std::vector<CLI::Option*> before;
  for (std::size_t k = 0; k < table_formats().size(); ++k) {
    const TableFormatName& format = table_formats()[k];
    CLI::Option* option = command.add_flag_callback(
        std::string("--") + format.option, [chosen, k] { *chosen = k; }, format.what);
    for (CLI::Option* other : before) option->excludes(other);
    before.push_back(option);
  }
  return chosen;
}

}  // namespace tchat
