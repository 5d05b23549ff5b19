#include "orbit/transversality.hpp"

#include "linear/stack_array.hpp"

namespace tchat {

Crossing crossing_at_end(const DefiningSystem& defining, const Orbit& x, int s) {
  if (!defining.has_event(s)) return {-1.0, 1.0};
  const int n = defining.dimension();
  StackVector f(n);
  StackVector gradient(n);
  const int field = defining.signature()[static_cast<std::size_t>(s)].field;
  defining.system().value(FunctionKind::field, field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return {gradient.dot(f), gradient.norm() * f.norm()};
}

Crossing crossing_of_event(const HybridSystem& system, int event, int field, const double* x, const double* par) {
  StackVector f(system.dimension());
  StackVector gradient(system.dimension());
  double h = 0.0;
  system.first(FunctionKind::event, event, x, par, {}, &h, gradient.data(), nullptr);
  system.value(FunctionKind::field, field, x, par, f.data());
  return {gradient.dot(f), gradient.norm() * f.norm()};
}

}  // namespace tchat
