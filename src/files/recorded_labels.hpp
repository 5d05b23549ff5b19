/// What the files of an earlier run record: their kind, the names of states and parameters, and notes on labels.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/point_file.hpp"
#include "files/solution_file_reader.hpp"
#include "model/hybrid_system.hpp"
#include "settings/point_type.hpp"

namespace tchat {

// Which of a run's files a file is.

enum class RunFileKind { points, solutions, diagnostics, other };

/// By the first line: of a q-file it holds 12 or 16 integers, of a p-file it is a header line or a point; otherwise by
/// the name (d.NAME, q.NAME, p.NAME, fort.9 and the like). `other` when neither tells, and for a file that is missing.
RunFileKind run_file_kind(const std::string& path);

// Names of states and parameters as the run that wrote a q-file had them.

struct RecordedNames {
  ProblemNames names;   ///< empty without a p-file
  std::string warning;  ///< when there is one that cannot be read
};

/// From the header of the p-file beside the q-file: q-files have no names.
RecordedNames recorded_names(const std::string& solution_path);

/// A q-file and its constants have parameters by their numbers. Throws UserError where a parameter of this number had
/// another name when the file was written: it is another parameter now.
void require_recorded_parameters(const std::string& solution_path, const HybridSystem& system);

// What the run that wrote a q-file has said of its labels, from the p-file and the d-file beside it.

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
