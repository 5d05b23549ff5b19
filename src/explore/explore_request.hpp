/// One `tchat explore`: what the command line says, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

struct ExploreRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> output;     ///< -o: the folder O of all files
  std::string over;                      ///< "P=a:b" or "P=a:b:COUNT"
  std::optional<std::string> second;     ///< --and "Q=c:d": the curves of special points in two parameters
  std::vector<std::string> states;       ///< --state of the sweep
  std::vector<std::string> overrides;    ///< KEY=VALUE: parameters for all commands, constants for runs
  std::string quantity;                  ///< -y of the picture; empty: chosen
  int workers = 1;
  int starts = 2;     ///< further initial states at every value
  int doublings = 4;  ///< of the period, from an attractor on
  int segments = 32;  ///< most of them in a signature that is followed
  int branches = 50;  ///< at most so many are kept
  /// At grazing, orbits with one impact in up to so many returns are followed: 1, and 4 from points with xi_n = 0 of
  /// grazing curves, where nothing else is asked for.
  std::optional<int> returns;
  double seconds = 0.0;  ///< wall time after which no command is begun; 0: any
  bool tori = false;     ///< are followed where they are born
  bool quiet = false;
};

}  // namespace tchat
