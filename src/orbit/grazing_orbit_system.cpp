#include "orbit/grazing_orbit_system.hpp"

#include <fmt/format.h>

namespace tchat {

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
