#include "bvp/discretisation_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// max |integral of Pi from 0 to sigma| / |Pi(0)|, sampled.
double error_of_residual(const CollocationRule& rule) {
  constexpr int samples = 400;
  const auto product = [&](double sigma) { return (sigma - rule.gauss.array()).prod(); };
  double integral = 0.0;
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    integral += product((k + 0.5) / samples) / samples;
    largest = std::max(largest, std::abs(integral));
  }
  return largest / std::abs(product(0.0));
}

/// The largest component of the residual at the ends of the intervals of segment s.
double largest_residual(const HybridSystem& system, int field, const Orbit& x, const MatrixXd& slopes, int s) {
  const int c = x.shape.collocation;
  VectorXd f(x.shape.dimension);
  double largest = 0.0;
  for (int j = 0; j <= x.shape.intervals; ++j) {
    system.value(FunctionKind::field, field, x.node(s, j * c), x.par.data(), f.data());
    if (!f.allFinite()) continue;
    // The end of one interval is the start of the next one.
    for (const int side : {0, 1}) {
      const int interval = j - side;
      if (interval < 0 || interval >= x.shape.intervals) continue;
      const auto at = static_cast<std::size_t>(interval);
      const double time = (x.mesh[at + 1] - x.mesh[at]) * x.duration(s);
      const auto nodes = x.states.middleCols(s * x.shape.nodes() + interval * c, c + 1);
      largest = std::max(largest, (nodes * slopes.col(side) - time * f).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

}  // namespace

double estimated_error(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const CollocationRule& rule) {
  if (x.shape.is_point()) return 0.0;
  if (!x.states.allFinite()) return std::numeric_limits<double>::infinity();
  MatrixXd slopes(rule.points() + 1, 2);  // of the polynomial at the start and at the end of an interval
  rule.basis(0.0, nullptr, slopes.col(0).data());
  rule.basis(1.0, nullptr, slopes.col(1).data());
  double residual = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    if (x.duration(s) != 0.0)
      residual =
          std::max(residual, largest_residual(system, signature[static_cast<std::size_t>(s)].field, x, slopes, s));
  return error_of_residual(rule) * residual / (1.0 + x.states.cwiseAbs().maxCoeff());
}

}  // namespace tchat
