/// A linear hybrid orbit with known multipliers. On segment s = 1..8, in a frame Q_s that differs from segment to
/// segment, w = Q_s^T (x1, x2, x3) and theta = x4 obey
///
///     w = b(theta) + z,    z' = diag(rates_s) z,    theta' = 1,    b(theta) = a (sin 2 pi theta, cos 2 pi theta, sin 4
///     pi theta)
///
/// until the tilted surface 1 - theta - d . z = 0; the jump keeps z and sets theta = 0. The orbit is z = 0 with all
/// durations 1. At z = 0 the flow of z vanishes, so how the duration changes with z does not matter to first order:
/// the multipliers are exp(sum_s rates_s), exactly, and 0. In the coordinates x, saltation is needed to find them.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

struct RotatingDirections {
  static constexpr int dimension = 4, parameters = 1;  // PAR: the amplitude a
  static constexpr int fields = 8, events = 8, jumps = 8;
  static constexpr std::array<double, 3> multipliers{1e-12, 1e-3, 1e12};

  /// Q_s: product of two plane rotations.
  static Eigen::Matrix3d frame(int s) {
    const double a = 0.7 * s, b = 1.3 * s + 0.4;
    Eigen::Matrix3d first, second;
    first << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
    second << 1, 0, 0, 0, std::cos(b), -std::sin(b), 0, std::sin(b), std::cos(b);
    return first * second;
  }
  /// Uneven shares of log mu: 1 + 0.5 cos(s + j) around the circle sums to 8 over s.
  static double rate(int s, int j) {
    return std::log(multipliers[static_cast<std::size_t>(j)]) / 8 * (1 + 0.5 * std::cos(pi / 4 * s + j));
  }

  template <class T>
  static std::array<T, 3> b(const T& theta, const T& a) {
    using std::cos, std::sin;
    return {a * sin(2 * pi * theta), a * cos(2 * pi * theta), a * sin(4 * pi * theta)};
  }
  template <class T>
  static std::array<T, 3> slope(const T& theta, const T& a) {
    using std::cos, std::sin;
    return {2 * pi * a * cos(2 * pi * theta), -2 * pi * a * sin(2 * pi * theta), 4 * pi * a * cos(4 * pi * theta)};
  }
  template <class T>
  static std::array<T, 3> deviation(int s, const T* x, const T* par) {
    const Eigen::Matrix3d q = frame(s);
    std::array<T, 3> z = b(x[3], par[0]);
    for (int j = 0; j < 3; ++j)
      z[static_cast<std::size_t>(j)] =
          q(0, j) * x[0] + q(1, j) * x[1] + q(2, j) * x[2] - z[static_cast<std::size_t>(j)];
    return z;
  }
  template <class T>
  static void turn(int s, const std::array<T, 3>& w, T* x) {
    const Eigen::Matrix3d q = frame(s);
    for (int i = 0; i < 3; ++i) x[i] = q(i, 0) * w[0] + q(i, 1) * w[1] + q(i, 2) * w[2];
  }

  template <class T>
  void field(int s, const T* x, const T* par, T* f) const {
    const std::array<T, 3> z = deviation(s, x, par);
    std::array<T, 3> w = slope(x[3], par[0]);
    for (int j = 0; j < 3; ++j) w[static_cast<std::size_t>(j)] += rate(s, j) * z[static_cast<std::size_t>(j)];
    turn(s, w, f);
    f[3] = T(1.0);
  }
  template <class T>
  T event(int s, const T* x, const T* par) const {
    const std::array<T, 3> z = deviation(s, x, par);
    return 1.0 - x[3] - 0.3 * z[0] + 0.2 * z[1] - 0.1 * z[2];
  }
  template <class T>
  void jump(int s, const T* x, const T* par, T* g) const {
    std::array<T, 3> w = deviation(s, x, par);
    const std::array<T, 3> landing = b(T(0.0), par[0]);
    for (std::size_t j = 0; j < 3; ++j) w[j] += landing[j];
    turn(s % 8 + 1, w, g);
    g[3] = T(0.0);
  }

  static Signature signature() {
    Signature result;
    for (int s = 1; s <= 8; ++s) result.push_back({s, s, s});
    return result;
  }
  static std::vector<Piece> pieces(double a) {
    std::vector<Piece> result;
    for (int s = 1; s <= 8; ++s)
      result.push_back({1.0, [s, a](double t) {
                          Eigen::VectorXd x(4);
                          turn(s, b(t, a), x.data());
                          x(3) = t;
                          return x;
                        }});
    return result;
  }
};

}  // namespace tchat::test
