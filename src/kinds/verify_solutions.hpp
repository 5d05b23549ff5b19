/// The command `tchat verify`: labelled orbits and tori against forward integration, with the multipliers that a label
/// must have.
#pragma once

#include <complex>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "files/solution_file.hpp"
#include "kinds/orbit_check.hpp"

namespace tchat {

/// +1 of a fold and of a branch point, also along a curve of folds; -1 of a period doubling and along a curve of them;
/// exp(i theta) of a torus bifurcation and along a curve of them, with the angle theta of the stored multiplier nearest
/// to the unit circle (off the real axis; without one, of the nearest in `computed`). On grazing curves +1 of a
/// grazing-fold and -1 of a grazing-flip. Empty for every other label. `is_in_parameter`: the label's branch has a
/// parameter as ICP(1) and nothing is held; else its folds and branch points are none of the orbits in a parameter.
std::vector<std::complex<double>> critical_multipliers(const LabelledSolution& solution,
                                                       const std::vector<std::complex<double>>& stored,
                                                       const std::vector<std::complex<double>>& computed,
                                                       bool is_in_parameter = true);

// An invariant torus against forward integration: every return from the N stored orbits, and from the N phases half
// way between them, is integrated segment by segment (segment_check.hpp) and must land on the curve a rotation
// further, g(x(1)) = u(phi + rho). Half way between, that is what the trigonometric polynomial of Q harmonics leaves
// out.

/// `one_return`: the constants of the run; `x`: the N orbits one after the other. A segment of the result is one of the
/// return: the worst of it over all phases, its mean duration. `stored`: the moduli of the multipliers in the d-file;
/// they are compared with moduli_along_rotation() (stability/floquet_multipliers.hpp) of the integrated return maps. A
/// return map that ends in contact has no derivative, and no multipliers are compared then.
OrbitCheck check_torus(const HybridSystem& system, const RunSettings& one_return, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance);

// `tchat verify` without the command line: q-file, constants of its run and plugin -> a table of defects.

struct VerifyRequest {
  std::string solutions;                 ///< q-file, by path or by the name of its run
  std::vector<std::string> labels;       ///< numbers, or types with a count; empty: all
  std::optional<std::string> constants;  ///< -c; default the r-file beside the q-file
  std::optional<std::string> problem;    ///< -p; default the name of the q-file
  double tolerance = level::located;
};

/// True when every label is, to the tolerance, what forward integration makes of it (or is inadmissible and the d-file
/// says so). Throws UserError for what is wrong with the input.
bool verify_solutions(const VerifyRequest& request, std::ostream& screen, std::ostream& warnings);

}  // namespace tchat
