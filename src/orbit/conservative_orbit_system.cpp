#include "orbit/conservative_orbit_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "orbit/coupling.hpp"
#include "orbit/no_duration.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Changes of H, relative to its gradient and how fast the state moves, and absolutely, that derivatives by differences
/// and orbits that are solved to the usual tolerances make.
constexpr double relative_rounding = 1e-5;
constexpr double least_change = 1e-9;
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

void ConservativeOrbitSystem::find_gradient(const Orbit& x) const {
  conserved_.first(x.start(0), x.par.data(), gradient_.data(), unused_.data());
}

void ConservativeOrbitSystem::target_pattern(int s, int row, CouplingPattern& pattern) const {
  PeriodicOrbitSystem::target_pattern(s, row, pattern);
  if (closes(s)) pattern.global(row, dimension(), free_count() - 1);
}

void ConservativeOrbitSystem::target_value(int s, const Orbit& x, double* target) const {
  PeriodicOrbitSystem::target_value(s, x, target);
  if (!closes(s)) return;
  find_gradient(x);
  const double lambda = x.par(layout().unfolding(segments()) - 1);
  for (int a = 0; a < dimension(); ++a) target[a] += lambda * gradient_[static_cast<std::size_t>(a)];
}

double* ConservativeOrbitSystem::target_derivatives(int s, const Orbit& x, double* entries) const {
  entries = PeriodicOrbitSystem::target_derivatives(s, x, entries);
  if (!closes(s)) return entries;
  return std::copy(gradient_.begin(), gradient_.end(), entries);
}

std::string ConservativeOrbitSystem::why_no_solution(const Orbit& x) const {
  const std::string what = why_not_closed(x), why = what.empty() ? why_not_constant(x) : what;
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
  constexpr double gap = 1e-6;  // of the states where the ring closes
  find_gradient(x);
  const double lambda = x.par(layout().unfolding(segments()) - 1);
  const double slope = Eigen::Map<const VectorXd>(gradient_.data(), dimension()).norm();
  if (std::abs(lambda) * slope <= gap * x.states.cwiseAbs().maxCoeff()) return "";
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
                             std::abs(rate * x.duration(s)) <= least_change * (1.0 + std::abs(here));
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
                           std::abs(change) <= least_change * (1.0 + std::abs(before));
  return is_rounding ? "" : fmt::format("it changes by {:.3g} {}", change, jump_name(s));
}

}  // namespace tchat
