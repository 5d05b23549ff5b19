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
  int threads = 1;                     ///< -j
  std::vector<std::string> overrides;  ///< KEY=VALUE
};

/// gc.C in the folder of C, or C itself when only that exists. Throws UserError when neither does.
/// Where C is a folder, gc.C in it counts too: `tchat new` makes NAME/gc.NAME.
std::string constants_path(const std::string& c);
/// gc.NAME, or NAME/gc.NAME where NAME is a folder; empty when there is neither.
std::string own_constants_path(const std::string& name);
/// The constants of the run that wrote the q-file `solutions`: `given` like constants_path(), else the r-file beside
/// it, or gc.NAME of `tchat resegment`. Throws UserError when there is none.
std::string constants_of_run(const std::optional<std::string>& given, const std::string& solutions);
/// D.dat, D/D.dat, or D itself when only that exists. Throws UserError when neither does.
std::string data_path(const std::string& d);
/// q.S in the folder of S, or S itself when only that exists. Throws UserError when neither does.
std::string solution_path(const std::string& s);

/// Both exist and are one file, whatever their paths.
bool same_file(const std::string& a, const std::string& b);

}  // namespace tchat
