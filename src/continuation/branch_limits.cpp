#include "continuation/branch_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuation/newton_chord.hpp"
#include "linear/dense_matrix.hpp"
#include "linear/stack_array.hpp"
#include "orbit/orbit.hpp"
#include "stability/test_function.hpp"

namespace tchat {

namespace {

/// The largest z whose growth exp(z) an interval of `collocation` Gauss points has with a relative error below 1.
double resolved_growth(int collocation) {
  double constant = 1.0;  // (c!)^2 / ((2c)! (2c+1)!)
  for (int k = 1; k <= collocation; ++k) constant *= static_cast<double>(k) * k;
  for (int k = 1; k <= 2 * collocation + 1; ++k) constant /= k;
  for (int k = 1; k <= 2 * collocation; ++k) constant /= k;
  return std::pow(constant, -1.0 / (2 * collocation + 1));
}

/// What changes by a factor of exp(z) on a mesh interval.
enum class Rate {
  of_perturbations_and_flow,
  of_decaying_flow  ///< |f| before an event, whose time has the relative error of f
};

/// Per unit time at one state.
double rate_at(const Eigen::VectorXd& f, const Eigen::MatrixXd& fx, double time, Rate rate) {
  const double flow = f.dot(fx * f) / f.squaredNorm();  // d ln |f| / dt
  const double of_flow = std::isfinite(flow) ? flow : 0.0;
  if (rate == Rate::of_decaying_flow) return std::max(-of_flow, 0.0);
  const Eigen::VectorXd rates = eigenvalues(fx).real();
  // What decays beside what grows has its share in the multipliers, what decays alone has none.
  const double perturbations = rates.maxCoeff() * time > 1.0 ? rates.cwiseAbs().maxCoeff() : 0.0;
  return std::max(perturbations, std::abs(of_flow));
}

/// Of which intervals of a segment.
enum class Which { all, last };

/// The largest z of the orbit's mesh intervals, 0 where none exceeds `least`, which is cheap to see.
double largest_growth(const DefiningSystem& system, const Orbit& x, Which which, Rate rate, double least) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  StackVector f(n);
  StackMatrix fx(n, n);
  double largest = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    const int field = system.signature()[static_cast<std::size_t>(s)].field;
    const auto growth_at = [&](int mesh_point, double time) {
      system.system().first(FunctionKind::field, field, x.node(s, mesh_point * c), x.par.data(), {}, f.data(),
                            fx.data(), nullptr);
      return fx.allFinite() && fx.norm() * time > least ? rate_at(f, fx, time, rate) * time : 0.0;
    };
    const int intervals = x.shape.intervals_of(s);
    for (int j = which == Which::all ? 0 : intervals - 1; j < intervals; ++j) {
      const double time = (x.mesh_of(s)[j + 1] - x.mesh_of(s)[j]) * x.duration(s);
      const double left = growth_at(j, time);
      if (left > std::max(largest, least)) largest = std::max(largest, std::min(left, growth_at(j + 1, time)));
    }
  }
  return largest > least ? largest : 0.0;
}

}  // namespace

std::string unresolved_by_mesh(const DefiningSystem& system, const Orbit& x, const PointData& data, double bound) {
  if (!(bound > 0.0)) return "";
  const auto text = [&](const char* figure, double value) {
    return fmt::format("NTST = {} does not resolve the next orbit: {} {:.1e} exceeds ERRMAX = {:.3g}",
                       x.shape.intervals, figure, value, bound);
  };
  if (!(data.estimated_error <= bound)) return text("the estimated relative error", data.estimated_error);
  const FloquetMultipliers& multipliers = data.multipliers;
  if (!(multipliers.structural <= bound))
    return text(multipliers.has_trivial ? "the trivial multiplier's distance from 1" : "the structural multiplier",
                multipliers.structural);
  if (!multipliers.valid) return "";
  const double limit = resolved_growth(x.shape.collocation);
  const double growth = count_unstable(multipliers).outside > 0
                            ? largest_growth(system, x, Which::all, Rate::of_perturbations_and_flow, limit)
                            : largest_growth(system, x, Which::last, Rate::of_decaying_flow, limit);
  if (growth == 0.0) return "";
  return fmt::format(
      "NTST = {} does not resolve the next orbit: perturbations or the flow change by a factor of exp({:.3g}) "
      "on one mesh interval, where NCOL = {} resolves exp({:.2g})",
      x.shape.intervals, growth, x.shape.collocation, limit);
}

double growth_exponent(const DefiningSystem& system, const Orbit& x) {
  const int n = x.shape.dimension;
  Eigen::VectorXd f(n);
  Eigen::MatrixXd fx(n, n);
  double exponent = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    for (int j = 0; j < x.shape.intervals_of(s); ++j) {
      const double time = (x.mesh_of(s)[j + 1] - x.mesh_of(s)[j]) * x.duration(s);
      system.system().first(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field,
                            x.node(s, j * x.shape.collocation), x.par.data(), {}, f.data(), fx.data(), nullptr);
      if (fx.allFinite()) exponent += std::max(eigenvalues(fx).real().maxCoeff() * time, 0.0);
    }
  return exponent;
}

std::string undetermined_duration(const DefiningSystem& system, const Orbit& x) {
  constexpr double rounding = 1e-12;
  StackVector f(x.shape.dimension);
  const double sizes = 1.0 + largest_state(x);
  const double period = x.period();
  for (int s = 0; s < x.shape.segments; ++s) {
    if (lasts_no_time(x, s, period)) continue;
    system.system().value(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field, x.end(s),
                          x.par.data(), f.data());
    const double moved = f.cwiseAbs().maxCoeff() * std::abs(x.duration(s));
    if (moved < rounding * sizes)
      return fmt::format(
          "segment {} ends at rest to within rounding (|f| T = {:.1e}), so that its duration {:.6g} is not "
          "determined",
          s + 1, moved, x.duration(s));
  }
  return "";
}

std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds) {
  const Orbit& x = from.orbit;
  const Orbit& y = to.orbit;
  const auto passes = [ds](double before, double rate, double after) {
    return before * after < 0.0 && before * rate * ds > 0.0;
  };
  const auto text = [](const std::string& what, double before, double after) {
    return fmt::format("{} passes infinity (from {:.6g} to {:.6g})", what, before, after);
  };
  if (passes(x.period(), from.tangent.durations.sum(), y.period())) return text("the period", x.period(), y.period());
  const double period = x.period();
  for (int s = 0; s < x.shape.segments; ++s)
    if (!lasts_no_time(x, s, period) && passes(x.duration(s), from.tangent.durations(s), y.duration(s)))
      return text(fmt::format("the duration of segment {}", s + 1), x.duration(s), y.duration(s));
  return "";
}

std::string passed_zero(const Orbit& from, const Orbit& to) {
  const double before = from.period();
  const double after = to.period();
  const bool is_negative = after < -no_duration * std::abs(before) && before > -no_duration * std::abs(after);
  return is_negative ? fmt::format("the period passes zero (from {:.6g} to {:.6g})", before, after) : "";
}

std::string passed_zero_segment(const Orbit& from, const Orbit& to) {
  const double before = -no_contact * from.period(), after = -no_contact * to.period();
  for (int s = 0; s < from.shape.segments; ++s)
    if (from.duration(s) >= before && to.duration(s) < after)
      return fmt::format("the duration of segment {} passes zero (from {:.6g} to {:.6g})", s + 1,
                         contact_lasts_no_time(from, s) ? 0.0 : from.duration(s), to.duration(s));
  return "";
}

}  // namespace tchat
