#include "hybrid/event_at.hpp"

namespace tchat {

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
  at.f.resize(system.dimension());
  system.value(FunctionKind::field, field, x, par, at.f.data());
  return at;
}

}  // namespace tchat
