#include "continuation/orbit_trend.hpp"

#include <cmath>

namespace tchat {

namespace {

/// The parameter stands still while it moves no more than this (relatively), the period grows by more than that factor.
constexpr double standstill = 1e-6;
constexpr double growth = 1.5;
/// A state whose range is a smaller share of it does not move.
constexpr double rounding = 1e-10;

Eigen::MatrixXd deviation(const Eigen::MatrixXd& states, int orbits) {
  if (orbits == 1) return states.colwise() - states.rowwise().mean();
  const Eigen::Map<const Eigen::MatrixXd> returns(states.data(), states.size() / orbits, orbits);
  Eigen::MatrixXd result(states.rows(), states.cols());
  Eigen::Map<Eigen::MatrixXd>(result.data(), returns.rows(), orbits) = returns.colwise() - returns.rowwise().mean();
  return result;
}

}  // namespace

Eigen::VectorXd state_ranges(const Orbit& x) { return x.states.rowwise().maxCoeff() - x.states.rowwise().minCoeff(); }

Eigen::VectorXd deviation_ranges(const Orbit& x, int orbits) {
  const Eigen::MatrixXd d = deviation(x.states, orbits);
  return d.rowwise().maxCoeff() - d.rowwise().minCoeff();
}

double deviation_cosine(const Orbit& x, const Orbit& y, int orbits) {
  const Eigen::MatrixXd a = deviation(x.states, orbits);
  const Eigen::MatrixXd b = deviation(y.states, orbits);
  const double sizes = a.norm() * b.norm();
  return sizes > 0.0 ? a.cwiseProduct(b).sum() / sizes : 0.0;
}

double deviation_growth(const Orbit& x, const Eigen::MatrixXd& direction, int orbits) {
  const Eigen::MatrixXd a = deviation(x.states, orbits);
  return a.cwiseProduct(deviation(direction, orbits)).sum() / a.squaredNorm();
}

void OrbitTrend::add(const Orbit& x, double parameter) {
  const bool first = largest_.size() == 0;
  const Eigen::VectorXd ranges = deviation_ranges(x, orbits_);
  const Eigen::VectorXd sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  largest_ = first ? ranges : Eigen::VectorXd(largest_.cwiseMax(ranges));
  sizes_ = first ? sizes : Eigen::VectorXd(sizes_.cwiseMax(sizes));
  if (first || !(std::abs(parameter - still_.parameter) <= standstill * (1.0 + std::abs(parameter))))
    still_ = {parameter, x.period()};
  last_ = {parameter, x.period()};
}

bool OrbitTrend::has_shrunk(const Orbit& x, double share) const {
  const Eigen::VectorXd ranges = deviation_ranges(x, orbits_);
  bool moves = false;
  for (Eigen::Index i = 0; i < largest_.size(); ++i) {
    if (largest_(i) <= rounding * (1.0 + sizes_(i))) continue;
    moves = true;
    if (ranges(i) > share * largest_(i)) return false;
  }
  return moves;
}

std::optional<PeriodGrowth> OrbitTrend::period_growth() const {
  if (!(still_.period > 0.0 && last_.period > growth * still_.period)) return std::nullopt;
  return PeriodGrowth{still_.period, last_.period, last_.parameter};
}

}  // namespace tchat
