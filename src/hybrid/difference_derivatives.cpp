#include "hybrid/difference_derivatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "hybrid/parameter_vector.hpp"

namespace tchat {

namespace {

/// A copy of the point that differences may move, on the stack.
struct MovablePoint {
  static constexpr int max_dimension = 1000;
  std::array<double, max_dimension> x;
  std::array<double, parameter_length> par;

  MovablePoint(const double* x0, int n, const double* par0) {
    std::copy(x0, x0 + n, x.begin());
    std::copy(par0, par0 + parameter_length, par.begin());
  }
};

double difference_step(double at) { return std::cbrt(std::numeric_limits<double>::epsilon()) * (1.0 + std::abs(at)); }

/// column = (F(variable + h) - F(variable - h)) / 2h, F(point, out) writing `rows` numbers.
template <class Function>
void difference_column(const Function& function, MovablePoint& point, double& variable, int rows, double* column) {
  std::array<double, MovablePoint::max_dimension> below;
  const double at = variable;
  const double h = difference_step(at);
  variable = at + h;
  const double upper = variable;
  function(point, column);
  variable = at - h;
  const double lower = variable;
  function(point, below.data());
  variable = at;
  for (int i = 0; i < rows; ++i) column[i] = (column[i] - below[static_cast<std::size_t>(i)]) / (upper - lower);
}

template <class Function>
void difference_columns(const Function& function, const HybridSystem& system, int rows, const double* x,
                        const double* par, std::span<const int> active, double* dx, double* dp) {
  const int n = system.dimension();
  MovablePoint point(x, n, par);
  for (int c = 0; c < n; ++c)
    difference_column(function, point, point.x[static_cast<std::size_t>(c)], rows, dx + c * rows);
  for (std::size_t a = 0; a < active.size(); ++a)
    difference_column(function, point, point.par[static_cast<std::size_t>(active[a] - 1)], rows,
                      dp + static_cast<int>(a) * rows);
}

}  // namespace

void difference_first(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp) {
  const int rows = kind == FunctionKind::event ? 1 : system.dimension();
  const auto value = [&](const MovablePoint& at, double* f) {
    system.value(kind, index, at.x.data(), at.par.data(), f);
  };
  system.value(kind, index, x, par, out);
  difference_columns(value, system, rows, x, par, active, dx, dp);
}

void difference_second(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                       std::span<const int> active, const double* direction, double* out, double* dx, double* dp) {
  const int n = system.dimension();
  const int rows = kind == FunctionKind::event ? 1 : n;
  const int parameters = static_cast<int>(active.size());
  std::vector<double> f(static_cast<std::size_t>(rows));
  std::vector<double> fx(static_cast<std::size_t>(rows * n));
  std::vector<double> fp(static_cast<std::size_t>(rows * std::max(parameters, 1)));
  const auto directional = [&](const MovablePoint& at, double* d) {
    system.first(kind, index, at.x.data(), at.par.data(), active, f.data(), fx.data(), fp.data());
    for (int i = 0; i < rows; ++i) {
      d[i] = 0.0;
      for (int c = 0; c < n; ++c) d[i] += fx[static_cast<std::size_t>(c * rows + i)] * direction[c];
      for (int a = 0; a < parameters; ++a) d[i] += fp[static_cast<std::size_t>(a * rows + i)] * direction[n + a];
    }
  };
  const MovablePoint here(x, n, par);
  directional(here, out);
  difference_columns(directional, system, rows, x, par, active, dx, dp);
}

}  // namespace tchat
