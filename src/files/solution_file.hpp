/// One labelled solution as an entry of a q-file, in AUTO-07p's layout:
///
///     16 integers:  BR PT TY LAB NFPR ISW NTPL NAR NROWPR NTST NCOL NPAR NPARI NDIM IPS P
///     t, U(1..n m)                    NTPL records, each on lines of at most 7 numbers of 19 columns after 4 blanks,
///                                     or of 26, exact, where segments have their own meshes
///     ICP; d PAR(ICP)/ds; dU/ds       only with direction
///     PAR(1..NPAR)                    at most 7 numbers of 26 columns on a line, exact; the last NPARI = 4 are kind,
///                                     segment, index and tau of a UZ point; more of them are further kinds, and
///                                     meshes of segments (solution_identifier.hpp)
///
/// NPAR = max(100, 60 + m) + 4: the parameters are padded with zeros. P is the number of the problem's parameters where
/// it moves the durations, or the rotation number of a torus, to other places (ParameterLayout); else 0, as AUTO
/// writes. NaN and inf are written as 1e99 (capped_value).
#pragma once

#include <string>

#include "files/labelled_solution.hpp"

namespace tchat {

/// The entry, every line with its newline. Throws std::invalid_argument when the parts of `solution` do not fit
/// together: NTPL and mesh, states and dimension, direction and free parameters, more parameters than NPAR has room
/// for.
std::string format_solution(const LabelledSolution& solution);

}  // namespace tchat
