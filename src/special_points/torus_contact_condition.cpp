#include "special_points/torus_contact_condition.hpp"

#include <cmath>

#include "bvp/rotation.hpp"

namespace tchat {

TorusContactCondition::TorusContactCondition(const TorusSystem& system, const OrbitShape& shape, int segment, int event)
    : system_(system), search_(system, segment, event), gradient_(shape, system.free_count()) {}

bool TorusContactCondition::evaluate(CondensedSystem& condensed, const Orbit& x) {
  const CollocationRule& rule = condensed.rule();
  const auto contact = started_ ? search_.least_near(x, rule, contact_.phi) : search_.least(x, rule);
  if (!contact || !std::isfinite(contact->value)) return false;
  contact_ = *contact;
  started_ = true;

  Eigen::VectorXd hx(x.shape.dimension);
  double h = 0.0;
  gradient_.set_zero();
  system_.system().first(FunctionKind::event, search_.event(), contact_.state.data(), x.par.data(),
                         system_.free_parameters(), &h, hx.data(), gradient_.globals.data());
  const auto [j, basis] = node_weights(x, rule, contact_.tau);
  const Eigen::RowVectorXd weights = interpolation_weights(system_.orbits(), contact_.phi);
  for (int l = 0; l < system_.orbits(); ++l) {
    const int segment = l * system_.segments_per_return() + search_.segment();
    for (int k = 0; k < basis.size(); ++k)
      gradient_.states.col(segment * x.shape.nodes() + j * x.shape.collocation + k) = weights(l) * basis(k) * hx;
  }
  return hx.allFinite() && gradient_.globals.allFinite();
}

void TorusContactCondition::remember(std::vector<double>& memory) const {
  memory.clear();
  if (started_) memory.push_back(contact_.phi);
}

void TorusContactCondition::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (started_) contact_.phi = memory.front();
}

}  // namespace tchat
