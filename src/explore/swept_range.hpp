/// A parameter and the values that it takes, as the command line has them.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"

namespace tchat {

/// "alpha=2.9:3.3:201" in its parts.
struct SweptRange {
  std::string parameter;
  double from = 0.0, to = 0.0;
  int count = 201;
};

/// `option` is named in messages. Throws UserError, for a number of values too where there is to be none.
SweptRange read_swept_range(const std::string& option, const std::string& text, bool may_have_count = true);

/// The number in PAR of the parameter, which the command line gives by its name or number, also as PAR(name); `range`
/// then has the name, where it is one. Throws UserError where there is none.
int find_parameter(const std::string& option, const HybridSystem& system, SweptRange& range);

}  // namespace tchat
