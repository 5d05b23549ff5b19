/// What the run that wrote a q-file has said of its labels, from the p-file and the d-file beside it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/solution_file_reader.hpp"
#include "settings/normal_form_note.hpp"

namespace tchat {

struct RecordedLabel {
  std::optional<bool> stable;  ///< nothing where stability was not computed, or says nothing (curves of bifurcations)
  bool admissible = true;
  std::string words;  ///< what the point is; "" when the d-file does not tell
  std::optional<NormalFormNote> normal_form;
  std::string violation;  ///< of the model, at an inadmissible point
};

/// What the first of a point's notes in the d-file that reports a violation of the model says; "" without one.
std::string violation_in(const std::vector<std::string>& notes);

/// By label; without those that the files do not have, or have for another point. Files that cannot be read count as
/// missing.
std::map<int, RecordedLabel> recorded_labels(const std::string& solution_path, const SolutionFile& solutions);

}  // namespace tchat
