/// One `tchat grazing`: what the command line says, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

struct GrazingRequest {
  std::string name;  ///< q-file, by path or by the name of its run; with `state` the problem
  std::optional<std::string> label;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::vector<std::string> overrides;    ///< KEY=VALUE, of a state given by hand

  std::optional<std::string> state;  ///< "0,0.1" or "x1=0.1,x2=3": a grazing point given by hand
  std::optional<std::string> mode;   ///< "1,1,1": its field, event function and jump
  bool correct = false;              ///< move it onto h_D = h_P = 0

  std::optional<int> jump;               ///< that contact brings
  std::optional<std::string> parameter;  ///< by which the orbit is moved to the contact, and impacting orbits are born
  std::optional<std::string> section;    ///< P': an event function by number or name, or a state by name

  int returns = 20;           ///< how many xi_n
  int born = 5;               ///< impacting orbits up to so many returns
  double penetration = 1e-2;  ///< the largest of those compared
};

}  // namespace tchat
