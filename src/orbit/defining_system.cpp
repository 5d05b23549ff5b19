#include "orbit/defining_system.hpp"

#include <algorithm>
#include <utility>

#include "model/contact_segment.hpp"

namespace tchat {

DefiningSystem::DefiningSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : system_(system), signature_(std::move(signature)), free_parameters_(std::move(free_parameters)) {
  for (int s = 0; s < segments(); ++s) contact_segments_.push_back(tchat::is_contact_segment(system_, signature_, s));
}

void DefiningSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  double h = 0.0;
  if (!has_event(s))
    std::fill_n(gradient, dimension(), 0.0);
  else
    system_.first(FunctionKind::event, signature_[static_cast<std::size_t>(s)].event, x, par, {}, &h, gradient,
                  nullptr);
}

}  // namespace tchat
