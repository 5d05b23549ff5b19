#include "orbit/periodic_orbit_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

namespace {

/// r' by tau at Gauss point g of interval j, times the length of the interval.
void slope_at(const Orbit& r, const CollocationRule& rule, int s, int j, int g, double* slope) {
  const double* node = r.node(s, j * r.shape.collocation);
  std::fill_n(slope, r.shape.dimension, 0.0);
  for (int i = 0; i <= rule.points(); ++i)
    for (int a = 0; a < r.shape.dimension; ++a) slope[a] += rule.slope(g, i) * *node++;
}

}  // namespace

PeriodicOrbitSystem::PeriodicOrbitSystem(const HybridSystem& system, Signature signature,
                                         std::vector<int> free_parameters)
    : RingSystem(system, std::move(signature), std::move(free_parameters)),
      difference_(static_cast<std::size_t>(dimension())),
      slope_(difference_.size()) {
  for (int s = 0; s < segments(); ++s)
    if (!has_event(s)) without_event_.push_back(s);
}

void PeriodicOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  if (has_event(s)) system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
}

void PeriodicOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                          double* dp) const {
  if (has_event(s))
    system().first(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, free_parameters(),
                   values, dx, dp);
}

std::string PeriodicOrbitSystem::end_condition_name(int s, int) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("event {} ({}) at the end of segment {}", j, system().function_name(FunctionKind::event, j),
                     s + 1);
}

void PeriodicOrbitSystem::integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                                          double* values) const {
  const int n = dimension();
  for (const int s : without_event_) {
    double phase = 0.0;
    double speed = 0.0;
    for_each_gauss_point(x, rule, s, [&](int j, int g, double h, double weight) {
      interpolate(x, rule, s, j, g, difference_.data());
      interpolate(reference, rule, s, j, g, slope_.data());
      for (int a = 0; a < n; ++a) difference_[static_cast<std::size_t>(a)] -= slope_[static_cast<std::size_t>(a)];
      slope_at(reference, rule, s, j, g, slope_.data());
      for (std::size_t a = 0; a < slope_.size(); ++a) {
        phase += weight / h * difference_[a] * slope_[a];
        speed += weight / (h * h) * slope_[a] * slope_[a];
      }
    });
    *values++ = speed > 0.0 ? phase / std::sqrt(speed) : 0.0;
  }
}

void PeriodicOrbitSystem::integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                                             double* values, std::span<OrbitVector> rows) const {
  integral_values(x, reference, rule, values);
  for (std::size_t r = 0; r < without_event_.size(); ++r) {
    const int s = without_event_[r];
    OrbitVector& row = rows[r];
    row.set_zero();
    double speed = 0.0;
    for_each_gauss_point(x, rule, s, [&](int j, int g, double h, double weight) {
      slope_at(reference, rule, s, j, g, slope_.data());
      const int column = x.shape.first_node(s) + j * x.shape.collocation;
      for (int a = 0; a < dimension(); ++a) {
        const double slope = slope_[static_cast<std::size_t>(a)];
        speed += weight / (h * h) * slope * slope;
        for (int i = 0; i <= rule.points(); ++i) row.states(a, column + i) += weight / h * rule.value(g, i) * slope;
      }
    });
    if (speed > 0.0) row.scale(1.0 / std::sqrt(speed));
  }
}

std::string PeriodicOrbitSystem::integral_name(int r) const {
  return fmt::format("integral phase condition of segment {}", without_event_[static_cast<std::size_t>(r)] + 1);
}

void PeriodicOrbitSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  if (has_event(s)) return RingSystem::section_gradient(s, x, par, gradient);
  system().value(FunctionKind::field, signature()[static_cast<std::size_t>(s)].field, x, par, gradient);
}

namespace {

using Eigen::VectorXd;

/// Changes of H, relative to its gradient and how fast the state moves, and to its value and to what a state of size 1
/// makes of it, that derivatives by differences and orbits that are solved to the usual tolerances make.
constexpr double relative_rounding = level::same;
constexpr double least_change = level::orbit;
/// The same of its mean slope on the way from the start of a segment, relative to its gradient. Near a kink of H the
/// rate by differences is wrong, and where the orbit has errors the change is.
constexpr double least_slope = 1e-3;

std::vector<int> with_unfolding(std::vector<int> free, const ParameterLayout& layout, std::size_t segments) {
  free.push_back(layout.unfolding(static_cast<int>(segments)));
  return free;
}

}  // namespace

ConservativeOrbitSystem::ConservativeOrbitSystem(const HybridSystem& system, const Signature& signature,
                                                 std::vector<int> free_parameters, Quantity conserved, std::string name)
    : PeriodicOrbitSystem(system, signature,
                          with_unfolding(std::move(free_parameters), system.layout(), signature.size())),
      conserved_(system, conserved, {}),
      name_(std::move(name)),
      gradient_(static_cast<std::size_t>(dimension())),
      flow_(gradient_.size()),
      after_(gradient_.size()) {}

void ConservativeOrbitSystem::find_direction(const Orbit& x) const {
  conserved_.first(x.start(0), x.par.data(), gradient_.data(), unused_.data());
  Eigen::Map<VectorXd> gradient(gradient_.data(), dimension());
  gradient /= std::max(gradient.norm(), std::numeric_limits<double>::min());
}

void ConservativeOrbitSystem::target_pattern(int s, int row, CouplingPattern& pattern) const {
  PeriodicOrbitSystem::target_pattern(s, row, pattern);
  if (closes(s)) pattern.global(row, dimension(), free_count() - 1);
}

void ConservativeOrbitSystem::target_value(int s, const Orbit& x, double* target) const {
  PeriodicOrbitSystem::target_value(s, x, target);
  if (!closes(s)) return;
  find_direction(x);
  const double lambda = x.par(layout().unfolding(segments()) - 1);
  for (int a = 0; a < dimension(); ++a) target[a] += lambda * gradient_[static_cast<std::size_t>(a)];
}

double* ConservativeOrbitSystem::target_derivatives(int s, const Orbit& x, double* entries) const {
  entries = PeriodicOrbitSystem::target_derivatives(s, x, entries);
  if (!closes(s)) return entries;
  return std::copy(gradient_.begin(), gradient_.end(), entries);
}

std::string ConservativeOrbitSystem::why_no_solution(const Orbit& x) const {
  const std::string gap = why_not_closed(x), change = why_not_constant(x);
  if (!gap.empty() && change.empty())
    return fmt::format("NTST = {} does not resolve this orbit: {}, though {} is conserved at its states; raise NTST",
                       x.shape.intervals, gap, name_);
  const std::string& why = gap.empty() ? change : gap;
  if (why.empty()) return "";
  return fmt::format(
      "CONSERVED = {0} is not conserved: {1}; remove CONSERVED (CONSERVED=) and free a parameter, or set the "
      "parameters "
      "so that {0} is conserved",
      name_, why);
}

std::string ConservativeOrbitSystem::segment_name(int s) const {
  const IndexVector& index = signature()[static_cast<std::size_t>(s)];
  return fmt::format("on segment {} (field {})", s + 1, system().function_name(FunctionKind::field, index.field));
}

std::string ConservativeOrbitSystem::jump_name(int s) const {
  const IndexVector& index = signature()[static_cast<std::size_t>(s)];
  return fmt::format("in jump {} ({}) at the end of segment {}", index.jump,
                     system().function_name(FunctionKind::jump, index.jump), s + 1);
}

std::string ConservativeOrbitSystem::why_not_closed(const Orbit& x) const {
  constexpr double gap = level::located;  // of the states where the ring closes
  const double lambda = x.par(layout().unfolding(segments()) - 1);
  if (std::abs(lambda) <= gap * x.states.cwiseAbs().maxCoeff()) return "";
  std::string places;
  double largest = 0.0;
  const auto look = [&](double change, const std::string& place) {
    if (!(std::abs(change) > largest)) return;
    largest = std::abs(change);
    places = fmt::format("by {:.3g} {}", change, place);
  };
  for (int s = 0; s < segments(); ++s) {
    const double end = value(x.end(s), x);
    look(end - value(x.start(s), x), segment_name(s));
    const IndexVector& index = signature()[static_cast<std::size_t>(s)];
    system().value(FunctionKind::jump, index.jump, x.end(s), x.par.data(), after_.data());
    look(value(after_.data(), x) - end, jump_name(s));
  }
  return fmt::format("the orbit closes only with lambda = {:.3g} instead of 0, and {} changes {}", lambda, name_,
                     places);
}

std::string ConservativeOrbitSystem::why_not_constant(const Orbit& x) const {
  std::string why;
  for (int s = 0; s < segments() && why.empty(); ++s) {
    why = why_not_constant_on(s, x);
    if (why.empty()) why = why_not_kept_by_jump(s, x);
  }
  return why;
}

/// At three nodes within the segment, as H may have a kink at its ends, and not at places that are alike in symmetric
/// orbits. Told where both the rate and the change are larger than rounding.
std::string ConservativeOrbitSystem::why_not_constant_on(int s, const Orbit& x) const {
  if (lasts_no_time(x, s, x.period())) return "";
  const int field = signature()[static_cast<std::size_t>(s)].field, last = x.shape.nodes_of(s) - 1;
  const Eigen::Map<const VectorXd> flow(flow_.data(), dimension()), gradient(gradient_.data(), dimension());
  const Eigen::Map<const VectorXd> start(x.start(s), dimension());
  const double at_start = value(x.start(s), x);
  for (const int part : {2, 5, 8}) {
    const double* const state = x.node(s, std::clamp(part * last / 11, 1, last - 1));
    system().value(FunctionKind::field, field, state, x.par.data(), flow_.data());
    const double here = conserved_.first(state, x.par.data(), gradient_.data(), unused_.data());
    const double rate = gradient.dot(flow);
    if (!std::isfinite(rate)) continue;
    const double way = (Eigen::Map<const VectorXd>(state, dimension()) - start).norm();
    const bool is_rounding = std::abs(here - at_start) <= least_slope * gradient.norm() * way ||
                             std::abs(rate) <= relative_rounding * gradient.norm() * flow.norm() ||
                             std::abs(rate * x.duration(s)) <= least_change * (gradient.norm() + std::abs(here));
    if (!is_rounding)
      return fmt::format("{} it changes at the rate {:.3g} where it is {:.6g}", segment_name(s), rate, here);
  }
  return "";
}

std::string ConservativeOrbitSystem::why_not_kept_by_jump(int s, const Orbit& x) const {
  system().value(FunctionKind::jump, signature()[static_cast<std::size_t>(s)].jump, x.end(s), x.par.data(),
                 after_.data());
  const double before = conserved_.first(x.end(s), x.par.data(), gradient_.data(), unused_.data());
  const double change = value(after_.data(), x) - before;
  const Eigen::Map<const VectorXd> end(x.end(s), dimension()), after(after_.data(), dimension());
  const double slope = Eigen::Map<const VectorXd>(gradient_.data(), dimension()).norm();
  const bool is_rounding = std::abs(change) <= relative_rounding * slope * (end.norm() + after.norm()) ||
                           std::abs(change) <= least_change * (slope + std::abs(before));
  return is_rounding ? "" : fmt::format("it changes by {:.3g} {}", change, jump_name(s));
}

GrazingOrbitSystem::GrazingOrbitSystem(const HybridSystem& system, Signature signature,
                                       std::vector<int> free_parameters, int grazing_segment)
    : RingSystem(system, std::move(signature), std::move(free_parameters)),
      grazing_segment_(grazing_segment),
      rate_(dimension(), free_count()) {}

void GrazingOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  if (s != grazing_segment_) {
    system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
    return;
  }
  rate_.evaluate(system(), contact(), x, par, free_parameters());
  values[0] = rate_.h;
  values[1] = rate_.rate;
}

void GrazingOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                         double* dp) const {
  if (s != grazing_segment_) {
    system().first(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, free_parameters(),
                   values, dx, dp);
    return;
  }
  rate_.evaluate(system(), contact(), x, par, free_parameters());
  values[0] = rate_.h;
  values[1] = rate_.rate;
  Eigen::Map<Eigen::MatrixXd> by_state(dx, 2, dimension());
  Eigen::Map<Eigen::MatrixXd> by_parameter(dp, 2, free_count());
  by_state.row(0) = rate_.hx;
  by_state.row(1) = rate_.rate_x;
  by_parameter.row(0) = rate_.hp;
  by_parameter.row(1) = rate_.rate_p;
}

std::string GrazingOrbitSystem::end_condition_name(int s, int r) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("{} ({}) at the end of segment {}{}", r == 0 ? fmt::format("event {}", j) : "h_x f of event",
                     system().function_name(FunctionKind::event, j), s + 1, r == 0 ? "" : " (grazing)");
}

void GrazingOrbitSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  if (s != grazing_segment_) return DefiningSystem::section_gradient(s, x, par, gradient);
  rate_.evaluate(system(), contact(), x, par, free_parameters());
  Eigen::Map<Eigen::VectorXd>(gradient, dimension()) = rate_.rate_x;
}

}  // namespace tchat
