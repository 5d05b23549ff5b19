#include "bvp/defining_system.hpp"

#include <algorithm>

namespace tchat {

void DefiningSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  double h = 0.0;
  if (!has_event(s))
    std::fill_n(gradient, dimension(), 0.0);
  else
    system_.first(FunctionKind::event, signature_[static_cast<std::size_t>(s)].event, x, par, {}, &h, gradient,
                  nullptr);
}

}  // namespace tchat
