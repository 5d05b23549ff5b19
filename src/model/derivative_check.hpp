/// Comparison of the functions that a problem supplies with finite differences, boundary conditions included.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

// Compares the derivatives of a problem's boundary conditions with differences, at random ends of segments.

struct BoundaryCheck {
  int segments = 1;
  int conditions = 0;
  double error = 0.0;  ///< worst |supplied - difference| / scale
  std::vector<std::string>
      faults;  ///< the first few entries that differ by more than 1e-6 of the scale, or are not finite
};

/// `par`: PAR without durations, which are random.
BoundaryCheck check_boundary(const HybridSystem& system, int segments, const Eigen::VectorXd& par, unsigned seed);

/// A line of the report of `tchat check`.
std::string to_text(const BoundaryCheck& check);

// Compares everything a problem supplies with finite differences, entry by entry, and looks for the usual mistakes.
//
// For every field, event function, jump and integrand, at given states and at random ones near them:
//   - outputs left unset (NaN at every state), outputs written beyond the end, results that change from call to call,
//     parameters read beyond the declared ones;
//   - F_x, F_p against extrapolated differences of F;
//   - D = F_x v + F_p w against the first derivatives, and D_x, D_p against extrapolated differences of D, along every
//     state and parameter (of many: both along a few random directions, and differences by each where these disagree).
//   - derivatives that are not finite where the value is: a fault at a given state, a note at special ones (the
//     problem's start, zero, and those with one state 0, 1 or -1).
// An entry is at fault when it differs by more than the differences' own error estimate (times 20) and 1e-8 of the
// function's scale.

struct DerivativeCheckOptions {
  std::vector<Eigen::VectorXd> states;  ///< n each; none: the random ones are near zero
  Eigen::VectorXd parameters;           ///< PAR(1..), missing ones by the problem, else 1
  int random_states = 5;                ///< near each given state
  double spread = 0.3;                  ///< x + spread (1 + |x|) times a number in (-1, 1), 1 being a unit of the
                                        ///< size of x; parameters a tenth of that
  unsigned seed = 1;
  int segments = 1;  ///< of the orbits on whose ends boundary conditions are checked
};

/// What was found for one function.
struct FunctionCheck {
  FunctionKind kind = FunctionKind::field;
  int index = 1;
  double first_error = 0.0;         ///< worst |supplied - difference| / scale of the first derivatives
  double second_error = 0.0;        ///< of the second derivatives
  std::string worst_first;          ///< its entry, as "d f_1[x2] / d alpha"
  std::string worst_second;         ///< as "d2 f_1[x2] / d x1 d alpha"
  std::vector<std::string> faults;  ///< messages, empty when nothing is wrong
  std::vector<std::string> notes;   ///< what is no fault but worth knowing
};

struct DerivativeCheck {
  std::vector<FunctionCheck> functions;
  std::optional<BoundaryCheck> boundary;
  std::vector<std::string> faults;  ///< of the problem as a whole (names)
  bool fine() const;
};

/// Where functions are looked at: the given states and random ones near them. Throws UserError as below.
std::vector<Eigen::VectorXd> checked_states(const HybridSystem& system, const DerivativeCheckOptions& options);

/// The parameters with which they are looked at, as long as a ParameterVector. Throws UserError as below.
Eigen::VectorXd checked_parameters(const HybridSystem& system, const DerivativeCheckOptions& options);

/// States are taken in units of their sizes. Throws UserError when a state or parameter given has the wrong length or
/// is not finite.
DerivativeCheck check_derivatives(const HybridSystem& base, const DerivativeCheckOptions& options = {});

/// The report that `tchat check` prints: dimension, names, a line for each function, the faults.
/// `further`: lines of other checks, which found a fault unless they are `further_fine`.
std::string to_text(const HybridSystem& system, const DerivativeCheck& check, const std::string& further = "",
                    bool further_fine = true);

}  // namespace tchat
