/// A place in a constants file or on the command line.
#pragma once

#include <string>

namespace tchat {

struct Place {
  std::string source;
  int line = 0;             ///< 0: the source has no lines (the command line)
  bool positional = false;  ///< in the positional form: examples show whole records
  std::string text() const;
};

}  // namespace tchat
