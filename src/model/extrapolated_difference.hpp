/// Derivatives of a function of one variable by central differences with Richardson extrapolation, and how far to
/// trust them (Ridders' method). Slow and careful: for checking derivatives, not for using them.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace tchat {

struct ExtrapolatedDifference {
  Eigen::VectorXd value;  ///< phi'(0); NaN where phi could not be evaluated at any step size
  Eigen::VectorXd error;  ///< estimate of its error, entry by entry; infinite where value is NaN
};

/// phi'(0) from phi(+-h) with h = step, step / 2, ..., step / 2^9. Entries of phi that are not finite at some step
/// sizes use the others.
ExtrapolatedDifference extrapolated_difference(const std::function<Eigen::VectorXd(double)>& phi, double step);

}  // namespace tchat
