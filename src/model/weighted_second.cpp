#include "model/weighted_second.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tchat {

WeightedSecond::WeightedSecond(const HybridSystem& system, FunctionKind kind, std::vector<int> active, int points,
                               int directions)
    : system_(system),
      kind_(kind),
      active_(std::move(active)),
      points_(points),
      directions_(directions),
      n_(system.dimension()),
      rows_(system.rows(kind)),
      x_(at(points, n_)),
      v_(at(points * directions, n_)),
      q_(at(directions, active_count())),
      weights_(at(points * (directions + 1), rows_)),
      out_(at(points * directions, rows_)),
      gradient_(at(points, n_ + active_count())),
      f_(at(1, rows_)),
      dx_(at(rows_, n_)),
      dp_(at(rows_, active_count())),
      direction_(at(1, n_ + active_count())) {}

void WeightedSecond::compute(int index, int points, const double* par) {
  const tchat_problem& table = system_.table();
  const bool whole = table.derivative_order >= 2 && table.second_at_points != nullptr &&
                     !(kind_ == FunctionKind::jump && index == no_function);
  if (whole)
    return table.second_at_points(table.self, static_cast<int>(kind_), index, points, directions_, x_.data(), par,
                                  active_.data(), active_count(), v_.data(), q_.data(), weights_.data(), out_.data(),
                                  gradient_.data());
  for (int i = 0; i < points; ++i) compute_one(index, i, par);
}

void WeightedSecond::compute_one(int index, int i, const double* par) {
  double* const gradient = &gradient_[at(i, n_ + active_count())];
  std::fill_n(gradient, n_ + active_count(), 0.0);
  const auto add = [&](const double* weights) {
    const auto weighted = [&](const double* column) {
      return std::inner_product(column, column + rows_, weights, 0.0);
    };
    for (int c = 0; c < n_; ++c) gradient[c] += weighted(dx_.data() + c * rows_);
    for (int c = 0; c < active_count(); ++c) gradient[n_ + c] += weighted(dp_.data() + c * rows_);
  };
  system_.first(kind_, index, point(i), par, active_, f_.data(), dx_.data(), dp_.data());
  add(value_weights(i));
  for (int k = 0; k < directions_; ++k) {
    std::copy_n(direction(i, k), n_, direction_.data());
    std::copy_n(parameter_direction(k), active_count(), direction_.data() + n_);
    system_.second(kind_, index, point(i), par, active_, direction_.data(), &out_[at(i * directions_ + k, rows_)],
                   dx_.data(), dp_.data());
    add(weights(i, k));
  }
}

}  // namespace tchat
