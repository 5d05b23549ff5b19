#include "bvp/conservative_orbit_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/coupling.hpp"

namespace tchat {

namespace {

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
      gradient_(static_cast<std::size_t>(dimension())) {}

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
  constexpr double gap = 1e-6;  // of the states where the ring closes
  find_gradient(x);
  const double lambda = x.par(layout().unfolding(segments()) - 1);
  const double slope = Eigen::Map<const Eigen::VectorXd>(gradient_.data(), dimension()).norm();
  if (std::abs(lambda) * slope <= gap * x.states.cwiseAbs().maxCoeff()) return "";
  std::string places;
  double largest = 0.0;
  std::vector<double> after(static_cast<std::size_t>(dimension()));
  const auto look = [&](double change, std::string place) {
    if (!(std::abs(change) > largest)) return;
    largest = std::abs(change);
    places = fmt::format("by {:.3g} {}", change, place);
  };
  for (int s = 0; s < segments(); ++s) {
    const IndexVector& index = signature()[static_cast<std::size_t>(s)];
    const double end = value(x.end(s), x);
    look(end - value(x.start(s), x),
         fmt::format("on segment {} (field {})", s + 1, system().function_name(FunctionKind::field, index.field)));
    system().value(FunctionKind::jump, index.jump, x.end(s), x.par.data(), after.data());
    look(value(after.data(), x) - end, fmt::format("in jump {} ({}) at the end of segment {}", index.jump,
                                                   system().function_name(FunctionKind::jump, index.jump), s + 1));
  }
  return fmt::format(
      "CONSERVED = {0} is not conserved: the orbit closes only with lambda = {1:.3g} instead of 0, and {0} changes "
      "{2}; remove CONSERVED (CONSERVED=) and free a parameter, or set the parameters so that {0} is conserved",
      name_, lambda, places);
}

}  // namespace tchat
