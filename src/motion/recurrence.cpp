#include "motion/recurrence.hpp"

#include <cmath>
#include <limits>

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

bool is_ignored(const std::vector<bool>& ignorable, Eigen::Index i) {
  const auto k = static_cast<std::size_t>(i);
  return k < ignorable.size() && ignorable[k];
}

/// Clears the flags of the states that a function depends on; a jump may only pass a state on.
void keep_independent(const HybridSystem& system, FunctionKind kind, const VectorXd& x, const VectorXd& par,
                      std::vector<bool>& flags) {
  const int n = system.dimension();
  const int rows = kind == FunctionKind::event ? 1 : n;
  for (int index = 1; index <= system.count(kind); ++index) {
    VectorXd value(rows);
    MatrixXd dx(rows, n);
    double no_parameters = 0.0;
    system.first(kind, index, x.data(), par.data(), {}, value.data(), dx.data(), &no_parameters);
    if (kind == FunctionKind::jump) dx -= MatrixXd::Identity(n, n);
    for (int c = 0; c < n; ++c)
      if (!(dx.col(c).lpNorm<Eigen::Infinity>() <= 1e-12)) flags[static_cast<std::size_t>(c)] = false;
  }
}

}  // namespace

void Recurrence::add(const SimulatedSegment& segment) {
  ends_.push_back({segment.index, segment.after, segment.low, segment.high});
  if (ends_.size() > 2 * static_cast<std::size_t>(max_period_)) ends_.pop_front();
}

std::optional<int> Recurrence::period() const {
  for (std::size_t p = 1; 2 * p <= ends_.size(); ++p)
    if (repeats(p)) return static_cast<int>(p);
  return std::nullopt;
}

VectorXd Recurrence::scale(std::size_t segments) const {
  VectorXd low = back(0).low;
  VectorXd high = back(0).high;
  for (std::size_t i = 1; i < segments; ++i) {
    low = low.cwiseMin(back(i).low);
    high = high.cwiseMax(back(i).high);
  }
  VectorXd range = high - low;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < range.size(); ++i)
    if (!is_ignored(ignorable_, i)) largest = std::max(largest, range(i));
  // States that hardly move are compared on the scale of the others.
  range.array() += 1e-3 * largest;
  for (Eigen::Index i = 0; i < range.size(); ++i)
    if (is_ignored(ignorable_, i)) range(i) = std::numeric_limits<double>::infinity();
  return range;
}

Signature Recurrence::last(std::size_t segments) const {
  Signature signature;
  for (std::size_t i = segments; i > 0; --i) signature.push_back(back(i - 1).index);
  return signature;
}

bool Recurrence::repeats_events(std::size_t period) const {
  if (period == 0 || 2 * period > ends_.size()) return false;
  for (std::size_t i = 0; i < period; ++i)
    if (back(i).index != back(i + period).index) return false;
  return true;
}

double Recurrence::difference(std::size_t period) const {
  const VectorXd scale = this->scale(2 * period);
  double largest = 0.0;
  for (std::size_t i = 0; i < period; ++i) {
    const VectorXd d = (back(i).after - back(i + period).after).cwiseAbs();
    for (Eigen::Index k = 0; k < d.size(); ++k)
      if (d(k) != 0.0) largest = std::max(largest, d(k) / scale(k));
  }
  return largest;
}

bool Recurrence::repeats(std::size_t period) const {
  // Where nothing moves the motion rests.
  return repeats_events(period) && difference(period) <= tolerance_ && scale(2 * period).maxCoeff() > 0.0;
}

std::vector<bool> ignorable_states(const HybridSystem& system, const std::vector<VectorXd>& points,
                                   const VectorXd& par) {
  std::vector<bool> flags(static_cast<std::size_t>(system.dimension()), !points.empty());
  for (const VectorXd& x : points)
    for (const FunctionKind kind : {FunctionKind::field, FunctionKind::event, FunctionKind::jump})
      keep_independent(system, kind, x, par, flags);
  return flags;
}

}  // namespace tchat
