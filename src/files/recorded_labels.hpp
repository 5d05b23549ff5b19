/// What the run that wrote a q-file has said of its labels, from the p-file and the d-file beside it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "files/solution_file_reader.hpp"

namespace tchat {

struct RecordedLabel {
  std::optional<bool> stable;  ///< nothing where stability was not computed, or says nothing (curves of bifurcations)
  bool admissible = true;
  std::string words;      ///< what the point is; "" when the d-file does not tell
  std::string violation;  ///< of the model, at an inadmissible point
};

/// By label; without those that the files do not have, or have for another point. Files that cannot be read count as
/// missing.
std::map<int, RecordedLabel> recorded_labels(const std::string& solution_path, const SolutionFile& solutions);

}  // namespace tchat
