/// Random systems in n dimensions whose periodic orbits and branch points are known in closed form.
///
/// In coordinates y: the unit circle, attracting with rate 2 kappa, with angular frequency omega(mu) = omega0 e^(g mu);
/// n - 3 states forced by it, z' = A z + B (y1, y2) + C w^2; and w beside it,
///
///     w' = lambda(mu) w - w^3    or    w' = lambda(mu) w - w^2,    lambda = s (mu - m_1) ... (mu - m_k) or -s.
///
/// The orbit w = 0 has branch points at m_1 ... m_k and nowhere else. What the program sees is x = P Phi(y): Phi adds
/// epsilon times quadratic terms to z and multiplies w by 1 + epsilon y1; P is a well-conditioned matrix. The subspace
/// w = 0 is a linear one in x too, so that collocation keeps it on any mesh. n = 2 is the circle alone.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "support/random_matrices.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

/// Matrices of any size, so that one piece of code serves all n.
struct RandomForm {
  static constexpr int most = 8;  // n at most

  int n;
  int rest = n > 3 ? n - 3 : 0;  // dimension of z
  double kappa = 1.0;
  double omega0 = 1.0;
  double growth = 0.0;  // g
  double slope = 1.0;   // s, with its sign
  bool pitchfork = true;
  double epsilon = 0.0;
  std::vector<double> branch_points;
  Eigen::MatrixXd a{rest, rest};
  Eigen::MatrixXd b{rest, 2};
  Eigen::MatrixXd c{rest, 4};  // of w^2 in z', of y1^2, y1 y2, w^2 in Phi
  Eigen::MatrixXd p;
  Eigen::MatrixXd inverse;

  static constexpr double least_mu = 0.0;
  static constexpr double most_mu = 3.0;

  /// Linear (epsilon = 0) in every second system; in every third one no branch point.
  RandomForm(int dimension, std::mt19937& random, int number) : n(dimension) {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto between = [&](double low, double high) { return low + (high - low) * uniform(random); };
    kappa = std::exp(between(std::log(0.5), std::log(20.0)));
    growth = between(-1.0, 1.0);
    omega0 = std::exp(between(std::log(0.3), std::log(3.0)) - 0.5 * growth * most_mu);
    slope = (uniform(random) < 0.5 ? -1.0 : 1.0) * between(0.2, 2.0);
    pitchfork = uniform(random) < 0.5;
    epsilon = number % 2 == 0 ? 0.0 : between(0.05, 0.2);
    const int count = n < 3 || number % 3 == 0 ? 0 : 1 + static_cast<int>(2.99 * uniform(random));
    for (int k = 0; k < count; ++k) {
      const double width = (most_mu - least_mu) / count;
      branch_points.push_back(least_mu + width * (k + between(0.2, 0.8)));
    }
    for (int i = 0; i < rest; ++i) {
      for (int j = 0; j < rest; ++j) a(i, j) = between(-0.5, 0.5) * (i < j ? 1.0 : 0.2);
      a(i, i) = -std::exp(between(std::log(0.6), std::log(30.0)));
      b(i, 0) = between(-1.0, 1.0), b(i, 1) = between(-1.0, 1.0);
      for (int k = 0; k < 4; ++k) c(i, k) = between(-1.0, 1.0);
    }
    Eigen::MatrixXd full(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) full(i, j) = between(-1.0, 1.0);
    p = full.householderQr().householderQ();
    for (int i = 0; i < n; ++i) p.col(i) *= between(0.5, 2.0);
    inverse = p.inverse();
  }

  template <class T>
  T frequency(const T& mu) const {
    using std::exp;
    return omega0 * exp(growth * mu);
  }
  template <class T>
  T rate(const T& mu) const {
    if (branch_points.empty()) return T(-std::abs(slope));
    T result(slope);
    for (const double m : branch_points) result *= mu - m;
    return result;
  }

  /// y of x.
  template <class T>
  void coordinates(const T* x, T* y) const {
    times(inverse, x, y);
    if (n > 2) {
      T& w = y[n - 1];
      w /= 1.0 + epsilon * y[0];
      for (int i = 0; i < rest; ++i)
        y[2 + i] -= epsilon * (c(i, 1) * y[0] * y[0] + c(i, 2) * y[0] * y[1] + c(i, 3) * w * w);
    }
  }

  /// f = P DPhi(y) y'.
  template <class T>
  void field(const T* x, const T& mu, T* f) const {
    T y[most];
    T v[most];
    coordinates(x, y);
    const T pull = kappa * (1.0 - y[0] * y[0] - y[1] * y[1]);
    const T omega = frequency(mu);
    v[0] = y[0] * pull - omega * y[1];
    v[1] = y[1] * pull + omega * y[0];
    if (n > 2) {
      const T& w = y[n - 1];
      const T w_rate = rate(mu) * w - (pitchfork ? T(w * w * w) : T(w * w));
      for (int i = 0; i < rest; ++i) {
        T sum = b(i, 0) * y[0] + b(i, 1) * y[1] + c(i, 0) * w * w;
        for (int j = 0; j < rest; ++j) sum += a(i, j) * y[2 + j];
        v[2 + i] = sum + epsilon * (2.0 * c(i, 1) * y[0] * v[0] + c(i, 2) * (v[0] * y[1] + y[0] * v[1]) +
                                    2.0 * c(i, 3) * w * w_rate);
      }
      v[n - 1] = w_rate * (1.0 + epsilon * y[0]) + epsilon * w * v[0];
    }
    times(p, v, f);
  }

  /// The section y2 = 0, which the orbit w = 0 leaves and meets at y1 = -1.
  Orbit orbit(double mu, int intervals, int collocation) const {
    const double omega = frequency(mu);
    Eigen::VectorXcd response(rest);
    if (rest > 0) {  // z = Re(response e^(i theta)) for the forcing Re(B (1, -i) e^(i theta))
      const std::complex<double> i(0.0, 1.0);
      Eigen::MatrixXcd matrix = -a.cast<std::complex<double>>();
      matrix.diagonal().array() += i * omega;
      const Eigen::VectorXcd forcing = b.cast<std::complex<double>>() * Eigen::Vector2cd(1.0, -i);
      response = complex_solution(matrix, forcing);
    }
    const auto state = [=, this](double t) {
      const double theta = pi + omega * t;
      Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
      y(0) = std::cos(theta), y(1) = std::sin(theta);
      for (int k = 0; k < rest; ++k)
        y(2 + k) =
            (response(k) * std::polar(1.0, theta)).real() + epsilon * (c(k, 1) * y(0) * y(0) + c(k, 2) * y(0) * y(1));
      return Eigen::VectorXd(p * y);
    };
    return sampled_orbit({{2 * pi / omega, state}}, n, intervals, collocation, parameters({mu}));
  }

 private:
  /// out = matrix in.
  template <class T>
  void times(const Eigen::MatrixXd& matrix, const T* in, T* out) const {
    for (int i = 0; i < n; ++i) {
      out[i] = matrix(i, 0) * in[0];
      for (int j = 1; j < n; ++j) out[i] += matrix(i, j) * in[j];
    }
  }
};

/// The random form that stands in `form` as a problem: PAR(1) = mu.
template <int N>
struct RandomSystem {
  static constexpr int dimension = N, parameters = 1, fields = 1, events = 1, jumps = 1;
  static inline const RandomForm* form = nullptr;

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    form->field(x, par[0], f);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    T sum = form->inverse(1, 0) * x[0];
    for (int j = 1; j < N; ++j) sum += form->inverse(1, j) * x[j];
    return sum;
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < N; ++i) g[i] = x[i];
  }
};

}  // namespace tchat::test
