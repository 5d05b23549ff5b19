/// Taylor coefficients of a smooth vector function of one variable, from its values: for functions that are known to
/// rounding but whose derivatives are not at hand.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace tchat {

struct TaylorCoefficients {
  Eigen::MatrixXd columns;  ///< column k: of t^k at t = 0
  Eigen::VectorXd errors;   ///< estimated, of each column: largest entry
};

/// The first `count` (at most 6) coefficients at 0, by the polynomial through Chebyshev points of [-size, size]: `size`
/// is halved, from `first_size`, and for each coefficient that one taken where two neighbours agree best, between the
/// truncation of long intervals and the rounding of short ones. Values that are not finite (too far away) leave a size
/// out; errors are infinite, columns NaN, where no two sizes remain.
TaylorCoefficients taylor_coefficients(const std::function<Eigen::VectorXd(double)>& function, double first_size,
                                       int count);

}  // namespace tchat
