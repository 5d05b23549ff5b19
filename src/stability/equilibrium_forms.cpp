#include "stability/equilibrium_forms.hpp"

namespace tchat {

EquilibriumForms::EquilibriumForms(const DefiningSystem& system, const Orbit& x)
    : system_(system), x_(x), states_(system.dimension_of(0)) {
  const int n = system.dimension();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd fx(n, n), fp(n, system.free_count());
  system.system().first(FunctionKind::field, field_index(), x.end(0), x.par.data(), system.free_parameters(), f.data(),
                        fx.data(), fp.data());
  field_ = f.head(states_);
  by_state_ = fx.topLeftCorner(states_, states_);
  by_parameter_ = fp.col(0).head(states_);
}

Eigen::VectorXd EquilibriumForms::part(const std::array<const Eigen::VectorXd*, 3>& directions) const {
  const int n = system_.dimension();
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(n, 8), values(n, 8);
  parts.col(0) = Eigen::Map<const Eigen::VectorXd>(x_.end(0), n);
  Eigen::Index wanted = 0;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    if (directions[k] == nullptr) continue;
    const Eigen::Index m = Eigen::Index{1} << k;
    parts.col(m).head(states_) = *directions[k];
    wanted += m;
  }
  system_.system().third(FunctionKind::field, field_index(), parts.data(), x_.par.data(), values.data());
  return values.col(wanted).head(states_);
}

Eigen::VectorXd EquilibriumForms::second_with_parameter(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const {
  const int n = system_.dimension();
  const int q = system_.free_count();
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(n + q), along(n);
  direction.head(states_) = u.head(states_);
  direction(n) = u(states_);
  Eigen::MatrixXd by_state(n, n), by_parameter(n, q);
  system_.system().second(FunctionKind::field, field_index(), x_.end(0), x_.par.data(), system_.free_parameters(),
                          direction.data(), along.data(), by_state.data(), by_parameter.data());
  return by_state.topLeftCorner(states_, states_) * v.head(states_) + by_parameter.col(0).head(states_) * v(states_);
}

}  // namespace tchat
