/// Options that the commands which simulate have in common.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <optional>
#include <string>
#include <vector>

#include "simulate/simulation_start.hpp"

namespace tchat {

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

}  // namespace tchat
