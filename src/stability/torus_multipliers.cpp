#include "stability/torus_multipliers.hpp"

#include <algorithm>
#include <cmath>

#include "orbit/torus_system.hpp"
#include "stability/segment_map.hpp"

namespace tchat {

namespace {

constexpr int returns = 1000;
/// Before the mean is taken, for the frame to turn into the directions it stays in.
constexpr int transient = 100;

/// Modified Gram-Schmidt, twice; the lengths of what is left of each column. Columns of no length are left zero.
Eigen::VectorXd orthonormalise(Eigen::MatrixXd& frame) {
  Eigen::VectorXd lengths = Eigen::VectorXd::Ones(frame.cols());
  for (Eigen::Index k = 0; k < frame.cols(); ++k)
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index j = 0; j < k; ++j) frame.col(k) -= frame.col(j).dot(frame.col(k)) * frame.col(j);
      const double length = frame.col(k).norm();
      lengths(k) *= length;
      if (length > 0.0) frame.col(k) /= length;
    }
  return lengths;
}

/// The derivatives of the return map at the N phases, each a column.
Eigen::MatrixXd return_matrices(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x) {
  const int n = x.shape.dimension;
  const int m = system.segments_per_return();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(n) * n, system.orbits());
  for (int i = 0; i < system.orbits(); ++i) {
    const Eigen::MatrixXd a = return_matrix(condensed, x, i * m, (i + 1) * m);
    columns.col(i) = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
  }
  return columns;
}

/// That along the curve u first.
Eigen::VectorXd exponents(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve, const Eigen::VectorXd& w,
                          double rho, int states) {
  const Eigen::Index n = curve.rows();
  const auto count = static_cast<int>(matrices.cols());
  const Eigen::Index kept = states - 1;  // the direction of the flow goes to zero at once
  Eigen::MatrixXd frame = Eigen::MatrixXd::Identity(n, kept);
  for (Eigen::Index k = 0; k < frame.size(); ++k) frame.data()[k] += 0.3 * std::sin(1.0 + 2.3 * static_cast<double>(k));
  orthonormalise(frame);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kept);
  double weights = 0.0;
  for (int j = 0; j < transient + returns; ++j) {
    const double phi = j * rho - std::floor(j * rho);
    const Eigen::VectorXd a = matrices * interpolation_weights(count, phi).transpose();
    frame.col(0) = curve * interpolation_weights(count, phi, 1).transpose() + w;
    orthonormalise(frame);
    frame = Eigen::Map<const Eigen::MatrixXd>(a.data(), n, n) * frame;
    const Eigen::VectorXd lengths = orthonormalise(frame);
    if (j < transient) continue;
    const double t = (j - transient + 0.5) / returns;
    const double weight = std::exp(-1.0 / (t * (1.0 - t)));
    sum += weight * lengths.cwiseMax(1e-300).array().log().matrix();
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

Eigen::VectorXd moduli_along_rotation(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve,
                                      const Eigen::VectorXd& w, double rho, int states) {
  return exponents(matrices, curve, w, rho, states).array().exp();
}

FloquetMultipliers torus_multipliers(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x) {
  FloquetMultipliers result;
  const Eigen::MatrixXd matrices = return_matrices(system, condensed, x);
  const int states = least_dimension(system.system(), system.signature());
  if (!matrices.allFinite() || states < 2) return result;
  Eigen::VectorXd moduli = moduli_along_rotation(matrices, periodic_section_curve(system, x), system.winding().curve,
                                                 TorusSystem::rotation(x), states);
  std::sort(moduli.begin() + 1, moduli.end(), [](double a, double b) { return std::abs(a - 1.0) < std::abs(b - 1.0); });
  result.values.assign(moduli.begin(), moduli.end());
  result.values.emplace_back(0.0);
  result.has_trivial = true;
  result.structural = std::abs(moduli(0) - 1.0);
  result.valid = moduli.allFinite();
  return result;
}

}  // namespace tchat
