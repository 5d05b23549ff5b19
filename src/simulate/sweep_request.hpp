/// One `tchat sweep`: what the command line says, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulate/simulation_request.hpp"

namespace tchat {

struct SweepRequest {
  SimulationRequest simulation;  ///< `state` is not used: `states`
  std::vector<std::string> over;
  std::vector<std::string> states;         ///< --state, several; empty: that of the problem, of -d or -s
  std::string follow;                      ///< "", "up", "down" or "both"
  std::optional<std::string> section;      ///< an event function's number or name, "all" or "none"
  std::optional<std::string> penetration;  ///< an event function's number or name
  std::optional<int> exponents;            ///< --lyapunov: how many, 0 all
  bool largest = false;                    ///< --max
  bool to_the_end = false;                 ///< nothing is captured

  int workers = 1;
  std::optional<std::string> part;  ///< "I/N"
  bool gather = false;
  bool fresh = false;
  std::string command;  ///< the command line as given, without --part I/N and --gather
};

}  // namespace tchat
