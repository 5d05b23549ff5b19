#include "model/boundary_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <random>

#include "model/difference_derivatives.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double boundary_tolerance = 1e-6;  // of the derivatives' scale; differences are good to about 1e-9
constexpr std::size_t most_listed = 5;

}  // namespace

BoundaryCheck check_boundary(const HybridSystem& system, int segments, const VectorXd& par, unsigned seed) {
  const int n = system.dimension();
  const int rows = system.boundary_conditions();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto any = [&] { return uniform(random); };
  const MatrixXd starts = MatrixXd::NullaryExpr(n, segments, any);
  const MatrixXd ends = MatrixXd::NullaryExpr(n, segments, any);
  VectorXd values = par;
  const ParameterLayout layout = system.layout();
  for (int s = 0; s < segments; ++s) values(layout.duration(s) - 1) = 1.5 + any();
  std::vector<int> active(static_cast<std::size_t>(system.parameters()));
  std::iota(active.begin(), active.end(), 1);
  for (int s = 0; s < segments; ++s) active.push_back(layout.duration(s));

  // Columns: starts, ends, parameters and durations.
  const int states = n * segments;
  MatrixXd supplied(rows, 2 * states + static_cast<int>(active.size()));
  MatrixXd expected = supplied;
  VectorXd b(rows);
  const OrbitEnds at{segments, starts.data(), ends.data(), values.data()};
  const auto column = [rows](MatrixXd& m, int c) { return m.data() + c * rows; };
  system.boundary_first(at, active, b.data(), column(supplied, 0), column(supplied, states),
                        column(supplied, 2 * states));
  difference_boundary(system, at, active, b.data(), column(expected, 0), column(expected, states),
                      column(expected, 2 * states));

  const auto variable = [&](int c) {
    if (c < 2 * states) {
      const int place = c % states;
      return fmt::format("{} at the {} of segment {}", system.state_name(place % n + 1), c < states ? "start" : "end",
                         place / n + 1);
    }
    const int k = active[static_cast<std::size_t>(c - 2 * states)];
    return layout.is_duration(k, segments) ? fmt::format("T of segment {}", layout.duration_segment(k) + 1)
                                           : system.parameter_name(k);
  };
  BoundaryCheck check{segments, rows, 0.0, {}};
  const double scale = 1.0 + (expected.allFinite() ? expected.cwiseAbs().maxCoeff() : 0.0);
  for (int r = 0; r < rows; ++r) {
    if (!std::isfinite(b(r)))
      check.faults.push_back(
          fmt::format("boundary condition {} is {} on {} segment{}: is it left unset, or does it ask "
                      "for another segment (their number is GCNOSEG)?",
                      r + 1, b(r), segments, segments == 1 ? "" : "s"));
    for (int c = 0; std::isfinite(b(r)) && c < supplied.cols(); ++c) {
      const double error = std::abs(supplied(r, c) - expected(r, c)) / scale;
      if (!(error <= check.error)) check.error = error;
      if (!(error <= boundary_tolerance) && check.faults.size() < most_listed)
        check.faults.push_back(fmt::format("d b_{} / d {} is {:.10g}, differences give {:.10g}", r + 1, variable(c),
                                           supplied(r, c), expected(r, c)));
    }
  }
  return check;
}

std::string to_text(const BoundaryCheck& check) {
  return fmt::format("  boundary conditions 1 to {:<12}  first {:.1e}  {}\n", check.conditions, check.error,
                     check.faults.empty() ? "ok" : "FAULT");
}

}  // namespace tchat
