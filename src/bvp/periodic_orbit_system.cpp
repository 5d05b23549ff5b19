#include "bvp/periodic_orbit_system.hpp"

#include <fmt/format.h>

namespace tchat {

void PeriodicOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
}

void PeriodicOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                          double* dp) const {
  system().first(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, free_parameters(), values,
                 dx, dp);
}

std::string PeriodicOrbitSystem::end_condition_name(int s, int) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("event {} ({}) at the end of segment {}", j, system().function_name(FunctionKind::event, j),
                     s + 1);
}

}  // namespace tchat
