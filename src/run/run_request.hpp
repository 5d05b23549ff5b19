/// One `tchat run`: what the command line says, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

struct RunRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> data;       ///< -d
  std::optional<std::string> start;      ///< -s
  std::optional<std::string> output;     ///< -o
  bool quiet = false;
  bool both_directions = false;
  bool append = false;
  bool clip = false;                   ///< end on the bounds RL0, RL1, A0, A1
  bool strict = false;                 ///< a branch that ends by MX is a failure
  std::vector<std::string> overrides;  ///< KEY=VALUE
};

/// gc.C in the folder of C, or C itself when only that exists. Throws UserError when neither does.
std::string constants_path(const std::string& c);
/// D.dat, or D itself when only that exists. Throws UserError when neither does.
std::string data_path(const std::string& d);
/// q.S in the folder of S, or S itself when only that exists. Throws UserError when neither does.
std::string solution_path(const std::string& s);
/// q.S in the folder of S, whether it exists or not.
std::string default_solution_path(const std::string& s);

}  // namespace tchat
