/// Names of the points of a branch: AUTO's two-letter types, and our own GR and XI which files carry as UZ.
///
/// On two-parameter curves the type number has a tens digit (the curve being followed): it is dropped, the sign kept,
/// but for AUTO's codimension-two codes 23, 83, 28, 78, 77, 87, 88.
#pragma once

#include <string>

#include "start/labelled_solution.hpp"

namespace tchat {

/// -59 -> -9, 54 -> 4.
int basic_type(int type);

/// "EP", "LP", "BP", "PD", "TR", "RG", "MX", "R1", "CP", ...; of type UZ by kind: "UZ" (user value or not known),
/// "GR" (contact, impact velocity), "XI", "GC" (grazing-fold or -flip). "" for an ordinary point and unknown numbers.
std::string type_name(int type, const UserPointKind& kind = {});
std::string type_name(const LabelledSolution& solution);

/// What a UZ label is, in words: "contact inside segment 1, event function 2, tau = 0.5"; "" for kind none. `parameter`
/// is the name of the one whose value the user asked for, PAR(index) when empty.
std::string description(const UserPointKind& kind, const std::string& parameter = "");

}  // namespace tchat
