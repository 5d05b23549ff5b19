#include "bvp/critical_pair.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

CriticalPair::CriticalPair(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> multiplier)
    : map_(system, shape),
      multiplier_(multiplier),
      column_(map_.size()),
      row_(map_.size()),
      extended_(shape, system.free_count()),
      gradient_(shape, system.free_count()) {
  for (Eigen::Index i = 0; i < column_.size(); ++i) {
    const auto k = static_cast<double>(i);
    column_(i) = {std::sin(1.0 + 0.7 * k), std::cos(0.2 + 1.1 * k)};
    row_(i) = {std::cos(0.3 + 0.9 * k), std::sin(0.5 + 0.4 * k)};
  }
  column_.normalize();
  row_.normalize();
}

/// [S b; c^H 0] [v; g] = e_last and its adjoint at the present multiplier.
bool CriticalPair::solve_bordered(const std::vector<double>& values) {
  const int size = map_.size();
  std::vector<Eigen::Triplet<Complex>> entries;
  for (std::size_t k = 0; k < values.size(); ++k)
    entries.emplace_back(map_.rows()[k], map_.columns()[k], Complex(values[k]));
  for (const std::size_t k : map_.factor_positions())
    entries.emplace_back(map_.rows()[k], map_.columns()[k], multiplier_ - values[k]);
  for (int i = 0; i < size; ++i) {
    entries.emplace_back(i, size, column_(i));
    entries.emplace_back(size, i, std::conj(row_(i)));
  }
  matrix_.resize(size + 1, size + 1);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  lu_.compute(matrix_);
  if (lu_.info() != Eigen::Success) return false;
  const Vector unit = Vector::Unit(size + 1, size);
  v_ = lu_.solve(unit);
  w_ = lu_.adjoint().solve(unit);
  return v_.allFinite() && w_.allFinite();
}

std::vector<double> CriticalPair::memory() const {
  std::vector<double> memory{multiplier_.real(), multiplier_.imag()};
  for (const Vector* border : {&column_, &row_})
    for (const Complex& entry : *border) memory.push_back(entry.real()), memory.push_back(entry.imag());
  return memory;
}

void CriticalPair::recall(const std::vector<double>& memory) {
  auto part = memory.begin();
  const auto next = [&part] {
    part += 2;
    return Complex(part[-2], part[-1]);
  };
  multiplier_ = next();
  for (Vector* border : {&column_, &row_})
    for (Complex& entry : *border) entry = next();
}

/// The pair's multiplier near the last one, with its null vectors.
bool CriticalPair::find_multiplier(const std::vector<double>& values) {
  constexpr double farthest = 0.5;
  constexpr double least_angle = 1e-4;  // nearer to the double multiplier its two halves are told apart badly
  const Complex last = multiplier_;
  if (!iterate(values)) return false;
  if (multiplier_.imag() < 0.0) {  // its conjugate
    multiplier_ = std::conj(multiplier_);
    for (Vector* vector : {&column_, &row_, &v_, &w_}) *vector = vector->conjugate().eval();
  }
  return multiplier_.imag() > least_angle * std::abs(multiplier_) &&
         std::min(std::abs(multiplier_ - last), std::abs(multiplier_ - std::conj(last))) < farthest * std::abs(last);
}

/// Newton's method for mu on the bordered problem.
bool CriticalPair::iterate(const std::vector<double>& values) {
  constexpr int most_iterations = 12;
  constexpr double tolerance = 1e-14;
  const int size = map_.size();
  const int first = map_.last_connectivity_row();
  const Eigen::Index n = size - first;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!solve_bordered(values)) return false;
    const Complex slope = -w_.segment(first, n).dot(v_.head(n));  // dg / dmu; dot conjugates its left side
    const Complex change = -v_(size) / slope;
    if (!std::isfinite(change.real()) || !std::isfinite(change.imag())) return false;
    multiplier_ += change;
    column_ = w_.head(size).normalized();
    row_ = v_.head(size).normalized();
    if (std::abs(change) < tolerance * (1.0 + std::abs(multiplier_))) return true;
  }
  return solve_bordered(values) && std::abs(v_(size)) < 1e-9;
}

bool CriticalPair::evaluate(CondensedSystem& condensed, const Orbit& x) {
  std::vector<double> values;
  map_.values(condensed, x, 1.0, values);
  if (!find_multiplier(values)) return false;
  const int size = map_.size();
  const int first = map_.last_connectivity_row();
  const Eigen::Index n = size - first;
  const Complex denominator = w_.segment(first, n).dot(v_.head(n));
  if (denominator == 0.0) return false;
  // dG = Re(gamma w^H (dS) v), that is (the parts of conj(gamma) w) with (the parts of v).
  const Complex gamma = -2.0 * std::conj(multiplier_) / denominator;
  const Vector weights = -std::conj(gamma) * w_.head(size);
  const Eigen::VectorXd v_real = v_.head(size).real();
  const Eigen::VectorXd v_imag = v_.head(size).imag();
  const Eigen::VectorXd w_real = weights.real();
  const Eigen::VectorXd w_imag = weights.imag();
  gradient_.set_zero();
  map_.subtract_derivative(condensed, x, v_real.data(), w_real.data(), extended_, gradient_);
  map_.subtract_derivative(condensed, x, v_imag.data(), w_imag.data(), extended_, gradient_);
  return true;
}

}  // namespace tchat
