#include "bvp/transversality.hpp"

namespace tchat {

Crossing crossing_at_end(const DefiningSystem& defining, const Orbit& x, int s) {
  if (!defining.has_event(s)) return {-1.0, 1.0};
  const int n = defining.dimension();
  Eigen::VectorXd f(n);
  Eigen::VectorXd gradient(n);
  const int field = defining.signature()[static_cast<std::size_t>(s)].field;
  defining.system().value(FunctionKind::field, field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return {gradient.dot(f), gradient.norm() * f.norm()};
}

}  // namespace tchat
