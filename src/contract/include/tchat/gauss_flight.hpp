/// Intervals with five Gauss points each, and small systems of linear equations, for the short flights between impacts.
/// Included by tchat/chatter.hpp.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace tchat {

/// The Gauss method of order 10 on equal intervals of [0, 1]: with all its stages i, x(c_i t) = x(0) + t sum_j a_ij f_j
/// and x(t) = x(0) + t sum_j b_j f_j.
class GaussRule {
 public:
  static constexpr std::size_t points = 5;  // of an interval

  explicit GaussRule(std::size_t intervals) : intervals_(intervals) {
    const double inner = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double outer = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double of_inner = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
    const double of_outer = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
    const double nodes[] = {-outer, -inner, 0.0, inner, outer};
    const double weights[] = {of_outer, of_inner, 128.0 / 225.0, of_inner, of_outer};
    for (std::size_t i = 0; i < points; ++i) nodes_[i] = 0.5 * (1.0 + nodes[i]), weights_[i] = 0.5 * weights[i];
    for (std::size_t i = 0; i < points; ++i)
      for (std::size_t j = 0; j < points; ++j) inner_[i][j] = lagrange_integral(j, nodes_[i]);
  }

  std::size_t stages() const { return points * intervals_; }
  double c(std::size_t i) const {
    const std::size_t interval = i / points;
    return (static_cast<double>(interval) + nodes_[i % points]) * length();
  }
  double b(std::size_t j) const { return weights_[j % points] * length(); }
  double a(std::size_t i, std::size_t j) const {
    if (j / points > i / points) return 0.0;
    return j / points < i / points ? b(j) : inner_[i % points][j % points] * length();
  }

  /// The largest share that the fourth Legendre polynomial has in values at the stages, in any interval: its square is
  /// about the error of the method.
  template <class ValueAt>
  double last_share(const ValueAt& value) const {
    double largest = 0.0, share = 0.0;
    for (std::size_t i = 0; i < stages(); ++i) largest = std::fmax(largest, std::fabs(value(i)));
    for (std::size_t k = 0; k < intervals_; ++k) {
      double last = 0.0;
      for (std::size_t i = 0; i < points; ++i) {
        const double z = 2.0 * nodes_[i] - 1.0;
        last += 9.0 * weights_[i] * ((35.0 * z * z - 30.0) * z * z + 3.0) / 8.0 * value(k * points + i);
      }
      share = std::fmax(share, std::fabs(last));
    }
    return largest > 0.0 ? share / largest : 0.0;
  }

 private:
  double length() const { return 1.0 / static_cast<double>(intervals_); }

  /// Of the j-th Lagrange polynomial from 0 to `end`, which the rule itself integrates exactly.
  double lagrange_integral(std::size_t j, double end) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < points; ++k) {
      double value = end * weights_[k];
      for (std::size_t m = 0; m < points; ++m)
        if (m != j) value *= (end * nodes_[k] - nodes_[m]) / (nodes_[j] - nodes_[m]);
      sum += value;
    }
    return sum;
  }

  std::size_t intervals_;
  std::array<double, points> nodes_{}, weights_{};
  std::array<std::array<double, points>, points> inner_{};
};

/// A square matrix with units for its rows and columns, then its LU factors with exchanges of rows.
class SmallMatrix {
 public:
  /// `units`: of the unknowns, and of the equations, of which each belongs to one.
  explicit SmallMatrix(std::vector<double> units)
      : size_(units.size()), units_(std::move(units)), entries_(size_ * size_), pivots_(size_) {}

  double& operator()(std::size_t row, std::size_t column) { return entries_[column * size_ + row]; }

  /// False where it is singular. Of the rows of a flight's interval few columns beyond their own are not zero.
  bool factor() {
    auto& m = *this;
    for (std::size_t j = 0; j < size_; ++j)
      for (std::size_t i = 0; i < size_; ++i) m(i, j) *= units_[j] / units_[i];
    for (std::size_t k = 0; k < size_; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < size_; ++i)
        if (std::fabs(m(i, k)) > std::fabs(m(pivot, k))) pivot = i;
      if (!(std::fabs(m(pivot, k)) > 0.0)) return false;
      pivots_[k] = pivot;
      for (std::size_t j = 0; j < size_ && pivot != k; ++j) std::swap(m(k, j), m(pivot, j));
      for (std::size_t i = k + 1; i < size_; ++i) m(i, k) /= m(k, k);
      for (std::size_t j = k + 1; j < size_; ++j)
        if (const double entry = m(k, j); entry != 0.0)
          for (std::size_t i = k + 1; i < size_; ++i) m(i, j) -= m(i, k) * entry;
    }
    return true;
  }

  /// The factors are those of numbers; what is solved for may have derivatives.
  template <class T>
  void solve(std::vector<T>& r) const {
    const auto m = [this](std::size_t i, std::size_t j) { return entries_[j * size_ + i]; };
    for (std::size_t k = 0; k < size_; ++k) r[k] = r[k] / units_[k];
    for (std::size_t k = 0; k < size_; ++k) std::swap(r[k], r[pivots_[k]]);
    for (std::size_t k = 0; k < size_; ++k)
      for (std::size_t i = k + 1; i < size_; ++i)
        if (m(i, k) != 0.0) r[i] -= m(i, k) * r[k];
    for (std::size_t k = size_; k-- > 0;) {
      r[k] = r[k] / m(k, k);
      for (std::size_t i = 0; i < k; ++i)
        if (m(i, k) != 0.0) r[i] -= m(i, k) * r[k];
    }
    for (std::size_t k = 0; k < size_; ++k) r[k] = r[k] * units_[k];
  }

 private:
  std::size_t size_;
  std::vector<double> units_, entries_;
  std::vector<std::size_t> pivots_;
};

}  // namespace tchat
