/// Names of the user's as names of C++.
#pragma once

#include <map>
#include <set>
#include <string>

namespace tchat::formulas {

/// Gives every name one of C++: itself where that is possible, else with underscores behind it (keywords, macros of the
/// standard headers, names that the translation uses itself).
class CppNames {
 public:
  /// A name that nothing else has.
  std::string unique(const std::string& name);

 private:
  std::set<std::string> used_;
};

}  // namespace tchat::formulas
