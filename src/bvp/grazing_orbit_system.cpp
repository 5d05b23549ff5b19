#include "bvp/grazing_orbit_system.hpp"

#include <fmt/format.h>

#include <Eigen/Core>

namespace tchat {

double slope_along_flow(const DefiningSystem& defining, int s, const double* x, const double* par, double* dx,
                        double* dp) {
  const HybridSystem& system = defining.system();
  const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
  const int n = defining.dimension();
  const int q = defining.free_count();
  const std::vector<int>& active = defining.free_parameters();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd fx(n, n);
  Eigen::MatrixXd fp(n, q);
  Eigen::VectorXd hx(n);
  Eigen::VectorXd hp(q);
  double h = 0.0;
  system.first(FunctionKind::field, v.field, x, par, active, f.data(), fx.data(), fp.data());
  system.first(FunctionKind::event, v.event, x, par, active, &h, hx.data(), hp.data());

  // d (h_x f) = h_xx f + h_x f_x: the first part is the second derivative in the direction (f, 0).
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(n + q);
  direction.head(n) = f;
  double slope = 0.0;
  Eigen::VectorXd by_state(n);
  Eigen::VectorXd by_parameter(q);
  system.second(FunctionKind::event, v.event, x, par, active, direction.data(), &slope, by_state.data(),
                by_parameter.data());
  Eigen::Map<Eigen::VectorXd>(dx, n) = by_state + fx.transpose() * hx;
  if (dp != nullptr) Eigen::Map<Eigen::VectorXd>(dp, q) = by_parameter + fp.transpose() * hx;
  return slope;
}

GrazingOrbitSystem::GrazingOrbitSystem(const HybridSystem& system, Signature signature,
                                       std::vector<int> free_parameters, int grazing_segment)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)), grazing_segment_(grazing_segment) {}

void GrazingOrbitSystem::end_values(int s, const double* x, const double* par, double* values) const {
  system().value(FunctionKind::event, signature()[static_cast<std::size_t>(s)].event, x, par, values);
  if (s != grazing_segment_) return;
  Eigen::VectorXd gradient(dimension());
  values[1] = slope_along_flow(*this, s, x, par, gradient.data(), nullptr);
}

void GrazingOrbitSystem::end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                                         double* dp) const {
  const int n = dimension();
  const int q = free_count();
  const int event = signature()[static_cast<std::size_t>(s)].event;
  if (s != grazing_segment_) {
    system().first(FunctionKind::event, event, x, par, free_parameters(), values, dx, dp);
    return;
  }
  Eigen::MatrixXd by_state(n, 2);
  Eigen::MatrixXd by_parameter(q, 2);
  system().first(FunctionKind::event, event, x, par, free_parameters(), values, by_state.col(0).data(),
                 by_parameter.col(0).data());
  values[1] = slope_along_flow(*this, s, x, par, by_state.col(1).data(), by_parameter.col(1).data());
  Eigen::Map<Eigen::MatrixXd>(dx, 2, n) = by_state.transpose();
  Eigen::Map<Eigen::MatrixXd>(dp, 2, q) = by_parameter.transpose();
}

std::string GrazingOrbitSystem::end_condition_name(int s, int r) const {
  const int j = signature()[static_cast<std::size_t>(s)].event;
  return fmt::format("{} ({}) at the end of segment {}{}", r == 0 ? fmt::format("event {}", j) : "h_x f of event",
                     system().function_name(FunctionKind::event, j), s + 1, r == 0 ? "" : " (grazing)");
}

void GrazingOrbitSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  if (s == grazing_segment_)
    slope_along_flow(*this, s, x, par, gradient, nullptr);
  else
    DefiningSystem::section_gradient(s, x, par, gradient);
}

}  // namespace tchat
