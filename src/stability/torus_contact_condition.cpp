#include "stability/torus_contact_condition.hpp"
#include "orbit/condensed_system.hpp"

#include <cmath>

namespace tchat {

TorusContactCondition::TorusContactCondition(const TorusSystem& system, const OrbitShape& shape, int segment, int event)
    : system_(system),
      search_(system, segment, event),
      follower_(system, shape, segment, event),
      gradient_(shape, system.free_count()) {}

/// From where it was; where that leads nowhere, by a search.
bool TorusContactCondition::find(const CollocationRule& rule, const Orbit& x) {
  const double phi = contact_.phi;
  if (started_ && follower_.follow(x, rule, contact_)) return true;
  const auto found = started_ ? search_.least_near(x, rule, phi) : search_.least(x, rule);
  if (!found || !std::isfinite(found->value)) return false;
  contact_ = *found;
  started_ = true;
  follower_.take_place(x, rule, contact_);
  return true;
}

bool TorusContactCondition::evaluate(CondensedSystem& condensed, const Orbit& x) {
  if (!find(condensed.rule(), x)) return false;
  gradient_.set_zero();
  double h = 0.0;
  Eigen::VectorXd& hx = gradient_at_contact_;
  hx.resize(x.shape.dimension);
  system_.system().first(FunctionKind::event, search_.event(), contact_.state.data(), x.par.data(),
                         system_.free_parameters(), &h, hx.data(), gradient_.globals.data());
  const Eigen::VectorXd& basis = follower_.node_weights();
  for (int l = 0; l < system_.orbits(); ++l) {
    const int segment = l * system_.segments_per_return() + search_.segment();
    const int first = segment * x.shape.nodes() + follower_.interval() * x.shape.collocation;
    for (int k = 0; k < basis.size(); ++k)
      gradient_.states.col(first + k) = follower_.phase_weights()(l) * basis(k) * hx;
  }
  return hx.allFinite() && gradient_.globals.allFinite();
}

void TorusContactCondition::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.push_back(contact_.phi);
  memory.push_back(contact_.tau);
}

void TorusContactCondition::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  contact_.phi = memory[0];
  contact_.tau = memory[1];
}

}  // namespace tchat
