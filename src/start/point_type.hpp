/// Names of the points of a branch: AUTO's two-letter types, and our own GR and XI which files carry as UZ.
///
/// On two-parameter curves the type number has a tens digit (the curve being followed): it is dropped, the sign kept,
/// but for AUTO's codimension-two codes 23, 83, 28, 78, 77, 87, 88.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "start/labelled_solution.hpp"

namespace tchat {

/// -59 -> -9, 54 -> 4.
int basic_type(int type);

/// "EP", "LP", "BP", "PD", "TR", "RG", "MX", "R1", "CP", ...; of type UZ by kind: "UZ" (user value or not known),
/// "GR" (contact, impact velocity), "XI", "GC" (grazing-fold or -flip). "" for an ordinary point and unknown numbers.
std::string type_name(int type, const UserPointKind& kind = {});
std::string type_name(const LabelledSolution& solution);

/// All names of a point that is several things at once, each once, its own first: {"GR", "UZ"}.
std::vector<std::string> type_names(int type, const UserPointKind& kind, const std::vector<UserPointKind>& further);
std::vector<std::string> type_names(const LabelledSolution& solution);

/// The basic type numbers of a solution (PointType): that of the name it was asked for by first, then its own.
std::vector<int> basic_types(const LabelledSolution& solution, const std::string& asked_for = "");

/// The kinds of a UZ point, or of what vanishes together with a point of another type; its own first.
std::vector<UserPointKind> all_kinds(const LabelledSolution& solution);

/// What a UZ label is, in words: "contact inside segment 1, event function 2, tau = 0.5"; "" for kind none. `parameter`
/// is the name of the one whose value the user asked for, PAR(index) when empty.
std::string description(const UserPointKind& kind, const std::string& parameter = "");

/// The same for all kinds of a solution, joined by "; ". `parameter_name` names PAR(k).
std::string description(const LabelledSolution& solution, const std::function<std::string(int)>& parameter_name);

}  // namespace tchat
