#include "bvp/grazing_orbit_system.hpp"

#include <fmt/format.h>

namespace tchat {

GrazingOrbitSystem::GrazingOrbitSystem(const HybridSystem& system, Signature signature,
                                       std::vector<int> free_parameters, int grazing_segment)
    : RingSystem(system, std::move(signature), std::move(free_parameters)),
      grazing_segment_(grazing_segment),
      f_(dimension()),
      hx_(dimension()),
      slope_x_(dimension()),
      direction_(Eigen::VectorXd::Zero(dimension() + free_count())),
      hp_(free_count()),
      slope_p_(free_count()),
      fx_(dimension(), dimension()),
      fp_(dimension(), free_count()) {}

void GrazingOrbitSystem::evaluate_contact(const double* x, const double* par) const {
  const IndexVector& v = signature()[static_cast<std::size_t>(grazing_segment_)];
  const std::vector<int>& active = free_parameters();
  system().first(FunctionKind::field, v.field, x, par, active, f_.data(), fx_.data(), fp_.data());
  system().first(FunctionKind::event, v.event, x, par, active, &h_, hx_.data(), hp_.data());
  // d (h_x f) = h_xx f + h_x f_x: the first part is the second derivative in the direction (f, 0).
  direction_.head(dimension()) = f_;
  system().second(FunctionKind::event, v.event, x, par, active, direction_.data(), &slope_, slope_x_.data(),
                  slope_p_.data());
  for (int b = 0; b < dimension(); ++b) slope_x_(b) += fx_.col(b).dot(hx_);
  for (int k = 0; k < free_count(); ++k) slope_p_(k) += fp_.col(k).dot(hx_);
}

void GrazingOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  if (s != grazing_segment_) {
    system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
    return;
  }
  evaluate_contact(x, par);
  values[0] = h_;
  values[1] = slope_;
}

void GrazingOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                         double* dp) const {
  if (s != grazing_segment_) {
    system().first(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, free_parameters(),
                   values, dx, dp);
    return;
  }
  evaluate_contact(x, par);
  values[0] = h_;
  values[1] = slope_;
  Eigen::Map<Eigen::MatrixXd> by_state(dx, 2, dimension());
  Eigen::Map<Eigen::MatrixXd> by_parameter(dp, 2, free_count());
  by_state.row(0) = hx_;
  by_state.row(1) = slope_x_;
  by_parameter.row(0) = hp_;
  by_parameter.row(1) = slope_p_;
}

std::string GrazingOrbitSystem::end_condition_name(int s, int r) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("{} ({}) at the end of segment {}{}", r == 0 ? fmt::format("event {}", j) : "h_x f of event",
                     system().function_name(FunctionKind::event, j), s + 1, r == 0 ? "" : " (grazing)");
}

void GrazingOrbitSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  if (s != grazing_segment_) return DefiningSystem::section_gradient(s, x, par, gradient);
  evaluate_contact(x, par);
  Eigen::Map<Eigen::VectorXd>(gradient, dimension()) = slope_x_;
}

}  // namespace tchat
