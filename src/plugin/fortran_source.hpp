/// Which files a Fortran source includes: what its library depends on, and whether its own header NAME.h is missing.
///
/// gfortran cannot list INCLUDE lines as it can #include (unless it preprocesses the source, which alters old sources),
/// so they are read here.
#pragma once

#include <string>
#include <vector>

namespace tchat {

struct FortranFiles {
  std::vector<std::string> found;  ///< absolute: the source, then what it includes, directly or not
  std::string own_header;          ///< "NAME.h" for NAME.f
  bool lacks_own_header = false;   ///< it is included, but nowhere: TC-HAT's sources include an empty one
};

/// Follows INCLUDE 'file' lines; a file is looked for in the folder of the file that includes it, then in `folders`.
FortranFiles fortran_files(const std::string& source, const std::vector<std::string>& folders);

}  // namespace tchat
