/// How the orbits of labels are drawn: what the d-file, or else the p-file, says of them.
#pragma once

#include <map>
#include <string>

#include "files/diagnostics_file_reader.hpp"
#include "files/line_kind.hpp"

namespace tchat {

/// Is a multiplier outside the unit circle, by more than 1e-4? At a located bifurcation PT has the sign of the point
/// before, so the multipliers tell more; that of the bifurcation itself does not count.
bool has_multiplier_outside(const DiagnosticPoint& point);

/// Inadmissible as the file says; unstable with a multiplier outside.
LineKind line_kind(const DiagnosticPoint& point);

/// The labels of q.NAME that are unstable or inadmissible by d.NAME; without d-file unstable by the sign of PT in
/// p.NAME. Empty when neither is there and can be read.
std::map<int, LineKind> label_kinds(const std::string& solution_path);
/// Of tori, whose trivial multiplier is known to the accuracy of the torus alone: stability by the sign of PT in the
/// p-file, admissibility by the d-file.
std::map<int, LineKind> torus_label_kinds(const std::string& solution_path);

}  // namespace tchat
