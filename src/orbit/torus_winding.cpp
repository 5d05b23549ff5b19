#include "orbit/torus_winding.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "orbit/rotation.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double whole_angle = 2.0 * std::numbers::pi;
/// Of the values of a function: what rounding of 2 pi may do to them.
constexpr double rounding_of_angles = 1e-9;
constexpr int most_turns = 3;

VectorXd function_value(const HybridSystem& system, FunctionKind kind, int index, const VectorXd& x,
                        const VectorXd& par) {
  VectorXd out(system.rows(kind));
  system.value(kind, index, x.data(), par.data(), out.data());
  return out;
}

/// Do the functions of a segment not see that a state is a turn further?
bool is_blind(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& further,
              const VectorXd& par) {
  const auto differs = [&](FunctionKind kind, int which, const VectorXd& shift) {
    const VectorXd here = function_value(system, kind, which, x, par);
    const VectorXd there = function_value(system, kind, which, further, par) - shift;
    return !((here - there).cwiseAbs().maxCoeff() <= rounding_of_angles * (1.0 + here.cwiseAbs().maxCoeff()));
  };
  const VectorXd none = VectorXd::Zero(x.size());
  return !differs(FunctionKind::field, index.field, none) &&
         !differs(FunctionKind::event, index.event, VectorXd::Zero(1)) &&
         !differs(FunctionKind::jump, index.jump, further - x);
}

bool is_angle(const HybridSystem& system, const Signature& one_return, const MatrixXd& samples, Index state,
              const VectorXd& par) {
  for (Index k = 0; k < samples.cols(); ++k) {
    const VectorXd x = samples.col(k);
    VectorXd further = x;
    further(state) += whole_angle;
    for (const IndexVector& index : one_return)
      if (!is_blind(system, index, x, further, par)) return false;
  }
  return true;
}

double last_harmonics_of(const VectorXd& values, double w) {
  Eigen::RowVectorXd row = values.transpose();
  for (Index l = 0; l < row.size(); ++l) row(l) -= w * static_cast<double>(l) / static_cast<double>(row.size());
  const VectorXd sizes = harmonic_sizes(row, VectorXd::Ones(1));
  return sizes.tail(std::min<Index>(2, sizes.size() - 1)).maxCoeff();
}

}  // namespace

TorusWinding no_winding(int dimension) { return {VectorXd::Zero(dimension), VectorXd::Zero(dimension)}; }

double likely_winding(const VectorXd& values) {
  double best = 0.0;
  double least = last_harmonics_of(values, 0.0);
  for (int turns = -most_turns; turns <= most_turns; ++turns) {
    const double last = last_harmonics_of(values, whole_angle * turns);
    if (!(last < least)) continue;
    least = last;
    best = whole_angle * turns;
  }
  return best;
}

std::vector<Index> angle_states(const HybridSystem& system, const Signature& one_return, const MatrixXd& samples,
                                const VectorXd& par) {
  std::vector<Index> angles;
  for (Index state = 0; state < samples.rows(); ++state)
    if (is_angle(system, one_return, samples, state, par)) angles.push_back(state);
  return angles;
}

TorusWinding torus_winding(const HybridSystem& system, const Signature& one_return, const Orbit& x) {
  const auto m = static_cast<Index>(one_return.size());
  const Index n = x.shape.dimension;
  const Index orbits = x.shape.segments / m;
  MatrixXd curve(n, orbits);
  for (Index l = 0; l < orbits; ++l) curve.col(l) = Eigen::Map<const VectorXd>(x.start(static_cast<int>(l * m)), n);
  TorusWinding winding = no_winding(static_cast<int>(n));
  const VectorXd& par = x.par;
  const double rho = x.par.rotation();
  const Eigen::RowVectorXd weights = interpolation_weights(static_cast<int>(orbits), rho);
  VectorXd end = function_value(system, FunctionKind::jump, one_return.back().jump,
                                Eigen::Map<const VectorXd>(x.end(static_cast<int>(m) - 1), n), par);
  for (const Index state : angle_states(system, one_return, curve, par)) {
    const double w = likely_winding(curve.row(state));
    double target = w * rho;
    for (Index l = 0; l < orbits; ++l)
      target += weights(l) * (curve(state, l) - w * static_cast<double>(l) / static_cast<double>(orbits));
    winding.curve(state) = w;
    winding.returns(state) = whole_angle * std::round((end(state) - target) / whole_angle);
  }
  return winding;
}

}  // namespace tchat
