/// A strongly nonlinear problem with its gradients and Hessians worked out by hand, for tests of differentiation.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <tchat/problem.hpp>

struct NonlinearProblem {
  static constexpr int dimension = 3, parameters = 4;
  static constexpr int fields = 1, events = 1, jumps = 1;

  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = sin(p[0] * x[0]) * exp(x[1]) + log(x[2]) * p[1];
    f[1] = sqrt(x[2]) * pow(x[0], 3) + tanh(p[2] * x[1]) / x[2];
    f[2] = atan2(x[1], x[0]) + cos(x[2]) * pow(x[2], p[3]);
    if (x[0] > 0.0)
      f[2] += x[0] * x[0];
    else
      f[2] -= x[0] * x[1];
  }

  template <class T>
  T event(int, const T* x, const T* p) const {
    return x[0] * x[1] - p[0] / x[2];
  }

  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    using std::max;
    g[0] = fabs(x[0]) * p[1];
    g[1] = max(x[1], x[2]) * p[2];
    g[2] = hypot(x[0], x[1]);
  }
};

/// Value, gradient and Hessian of a scalar function of z = (x1, x2, x3, p1, p2, p3, p4).
struct Exact {
  double value = 0.0;
  Eigen::Matrix<double, 7, 1> gradient = Eigen::Matrix<double, 7, 1>::Zero();
  Eigen::Matrix<double, 7, 7> hessian = Eigen::Matrix<double, 7, 7>::Zero();

  void symmetric(int a, int b, double second) { hessian(a, b) = hessian(b, a) = second; }
};

using Point7 = Eigen::Matrix<double, 7, 1>;
enum { X1, X2, X3, P1, P2, P3, P4 };

inline Exact exact_field_1(const Point7& z) {
  const double s = std::sin(z[P1] * z[X1]), c = std::cos(z[P1] * z[X1]), e = std::exp(z[X2]), l = std::log(z[X3]);
  Exact f;
  f.value = s * e + l * z[P2];
  f.gradient << z[P1] * c * e, s * e, z[P2] / z[X3], z[X1] * c * e, l, 0, 0;
  f.symmetric(X1, X1, -z[P1] * z[P1] * s * e);
  f.symmetric(X1, X2, z[P1] * c * e);
  f.symmetric(X1, P1, c * e - z[P1] * z[X1] * s * e);
  f.symmetric(X2, X2, s * e);
  f.symmetric(X2, P1, z[X1] * c * e);
  f.symmetric(X3, X3, -z[P2] / (z[X3] * z[X3]));
  f.symmetric(X3, P2, 1 / z[X3]);
  f.symmetric(P1, P1, -z[X1] * z[X1] * s * e);
  return f;
}

inline Exact exact_field_2(const Point7& z) {
  const double x1 = z[X1], x2 = z[X2], x3 = z[X3], p = z[P3];
  const double a = std::sqrt(x3), t = std::tanh(p * x2), u = 1 - t * t;
  Exact f;
  f.value = a * x1 * x1 * x1 + t / x3;
  f.gradient << 3 * x1 * x1 * a, p * u / x3, x1 * x1 * x1 / (2 * a) - t / (x3 * x3), 0, 0, x2 * u / x3, 0;
  f.symmetric(X1, X1, 6 * x1 * a);
  f.symmetric(X1, X3, 3 * x1 * x1 / (2 * a));
  f.symmetric(X2, X2, -2 * p * p * t * u / x3);
  f.symmetric(X2, X3, -p * u / (x3 * x3));
  f.symmetric(X2, P3, (u - 2 * p * x2 * t * u) / x3);
  f.symmetric(X3, X3, -x1 * x1 * x1 / (4 * a * a * a) + 2 * t / (x3 * x3 * x3));
  f.symmetric(X3, P3, -x2 * u / (x3 * x3));
  f.symmetric(P3, P3, -2 * x2 * x2 * t * u / x3);
  return f;
}

inline Exact exact_field_3(const Point7& z) {
  const double x1 = z[X1], x2 = z[X2], x3 = z[X3], p = z[P4];
  const double r2 = x1 * x1 + x2 * x2, r4 = r2 * r2;
  const double power = std::exp(p * std::log(x3)), l = std::log(x3), c = std::cos(x3), s = std::sin(x3);
  Exact f;
  f.value = std::atan2(x2, x1) + c * power;
  f.gradient << -x2 / r2, x1 / r2, -s * power + c * p * power / x3, 0, 0, 0, c * power * l;
  f.symmetric(X1, X1, 2 * x1 * x2 / r4);
  f.symmetric(X1, X2, (x2 * x2 - x1 * x1) / r4);
  f.symmetric(X2, X2, -2 * x1 * x2 / r4);
  f.symmetric(X3, X3, -c * power - 2 * s * p * power / x3 + c * p * (p - 1) * power / (x3 * x3));
  f.symmetric(X3, P4, -s * power * l + c * power * (1 + p * l) / x3);
  f.symmetric(P4, P4, c * power * l * l);
  if (x1 > 0) {
    f.value += x1 * x1;
    f.gradient[X1] += 2 * x1;
    f.hessian(X1, X1) += 2;
  } else {
    f.value -= x1 * x2;
    f.gradient[X1] -= x2;
    f.gradient[X2] -= x1;
    f.symmetric(X1, X2, f.hessian(X1, X2) - 1);
  }
  return f;
}

inline Exact exact_event(const Point7& z) {
  Exact h;
  h.value = z[X1] * z[X2] - z[P1] / z[X3];
  h.gradient << z[X2], z[X1], z[P1] / (z[X3] * z[X3]), -1 / z[X3], 0, 0, 0;
  h.symmetric(X1, X2, 1);
  h.symmetric(X3, X3, -2 * z[P1] / (z[X3] * z[X3] * z[X3]));
  h.symmetric(X3, P1, 1 / (z[X3] * z[X3]));
  return h;
}

inline Exact exact_jump_1(const Point7& z) {
  const double sign = z[X1] < 0 ? -1 : 1;
  Exact g;
  g.value = sign * z[X1] * z[P2];
  g.gradient << sign * z[P2], 0, 0, 0, sign * z[X1], 0, 0;
  g.symmetric(X1, P2, sign);
  return g;
}

inline Exact exact_jump_2(const Point7& z) {
  const int larger = z[X2] > z[X3] ? X2 : X3;
  Exact g;
  g.value = z[larger] * z[P3];
  g.gradient[larger] = z[P3];
  g.gradient[P3] = z[larger];
  g.symmetric(larger, P3, 1);
  return g;
}

inline Exact exact_jump_3(const Point7& z) {
  const double x1 = z[X1], x2 = z[X2], r = std::sqrt(x1 * x1 + x2 * x2), r3 = r * r * r;
  Exact g;
  g.value = r;
  g.gradient << x1 / r, x2 / r, 0, 0, 0, 0, 0;
  g.symmetric(X1, X1, x2 * x2 / r3);
  g.symmetric(X1, X2, -x1 * x2 / r3);
  g.symmetric(X2, X2, x1 * x1 / r3);
  return g;
}
