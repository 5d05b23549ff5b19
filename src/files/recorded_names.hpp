/// Names of states and parameters as the run that wrote a q-file had them.
#pragma once

#include <string>

#include "files/point_columns.hpp"

namespace tchat {

struct RecordedNames {
  ProblemNames names;   ///< empty without a p-file
  std::string warning;  ///< when there is one that cannot be read
};

/// From the header of the p-file beside the q-file: q-files have no names.
RecordedNames recorded_names(const std::string& solution_path);

}  // namespace tchat
