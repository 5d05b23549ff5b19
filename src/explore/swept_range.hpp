/// A parameter and the values that it takes, as the command line has them.
#pragma once

#include <string>

namespace tchat {

/// "alpha=2.9:3.3:201" in its parts.
struct SweptRange {
  std::string parameter;
  double from = 0.0, to = 0.0;
  int count = 201;
};

/// `option` is named in messages. Throws UserError, for a number of values too where there is to be none.
SweptRange read_swept_range(const std::string& option, const std::string& text, bool may_have_count = true);

}  // namespace tchat
