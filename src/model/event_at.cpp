#include "model/event_at.hpp"

#include "model/mode_dimensions.hpp"

namespace tchat {

Eigen::RowVectorXd change_of_time(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& v) {
  return -(gradient.transpose() * v) / gradient.dot(f);
}

Eigen::MatrixXd project_along_flow(const Eigen::VectorXd& f, const Eigen::VectorXd& gradient,
                                   const Eigen::MatrixXd& v) {
  return v + f * change_of_time(f, gradient, v);
}

double EventAt::scale(const double* x) const {
  return 1.0 + gradient.norm() * Eigen::Map<const Eigen::VectorXd>(x, gradient.size()).norm();
}

EventAt event_at(const HybridSystem& system, int event, const double* x, const double* par) {
  EventAt at{0.0, Eigen::VectorXd(system.dimension()), {}};
  system.first(FunctionKind::event, event, x, par, {}, &at.h, at.gradient.data(), nullptr);
  return at;
}

EventAt event_at(const HybridSystem& system, int event, int field, const double* x, const double* par) {
  EventAt at = event_at(system, event, x, par);
  clear_absent(system, field, at.gradient);
  at.f.resize(system.dimension());
  system.value(FunctionKind::field, field, x, par, at.f.data());
  return at;
}

Eigen::VectorXd rate_gradient(const HybridSystem& system, const EventAt& at, int event, int field, const double* x,
                              const double* par) {
  const int n = system.dimension();
  Eigen::VectorXd f(n), gradient(n);
  Eigen::MatrixXd fx(n, n);
  double rate = 0.0;
  system.first(FunctionKind::field, field, x, par, {}, f.data(), fx.data(), nullptr);
  // h_xx f is the second derivative of h in the direction f.
  system.second(FunctionKind::event, event, x, par, {}, at.f.data(), &rate, gradient.data(), nullptr);
  gradient += fx.transpose() * at.gradient;
  clear_absent(system, field, gradient);
  return gradient;
}

JumpAt jump_at(const HybridSystem& system, int jump, const double* x, const double* par) {
  const int n = system.dimension();
  JumpAt at{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
  system.first(FunctionKind::jump, jump, x, par, {}, at.image.data(), at.derivative.data(), nullptr);
  return at;
}

}  // namespace tchat
