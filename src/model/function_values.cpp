#include "model/function_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace tchat {

std::string named_state(const HybridSystem& system, const double* x) {
  constexpr int most_shown = 8;
  std::string text;
  for (int k = 1; k <= std::min(system.dimension(), most_shown); ++k)
    text += fmt::format("{}{} = {:.6g}", k > 1 ? ", " : "", system.state_name(k), system.unit_of(k) * x[k - 1]);
  if (system.dimension() > most_shown) text += fmt::format(" and {} more", system.dimension() - most_shown);
  return text;
}

std::string undefined_value(const HybridSystem& system, FunctionKind kind, int index, const double* x) {
  return fmt::format("{} has no finite value at {}; {}", system.function_name(kind, index), named_state(system, x),
                     undefined_value_advice);
}

std::string no_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const Eigen::VectorXd& x) {
  Eigen::VectorXd shown = x;
  for (int k = 1; k <= static_cast<int>(x.size()); ++k) shown(k - 1) *= system.unit_of(k);
  return fmt::format(
      "{} has no finite derivatives at x = ({:.6g}); sqrt, cbrt, hypot and atan2 have none at zero, asin and acos none "
      "at 1 and -1: start elsewhere, or round the function off there, as sqrt(x^2 + 1e-12)",
      system.function_name(kind, index), fmt::join(shown.begin(), shown.end(), ", "));
}

bool has_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                            const double* par) {
  const int rows = system.rows(kind);
  Eigen::VectorXd value(rows);
  Eigen::MatrixXd derivative(rows, system.dimension());
  double no_parameters = 0.0;
  system.value(kind, index, x, par, value.data());
  if (!value.allFinite()) return true;
  system.first(kind, index, x, par, {}, value.data(), derivative.data(), &no_parameters);
  return derivative.allFinite();
}

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
