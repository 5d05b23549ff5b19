#include "stability/equilibrium_normal_form.hpp"

#include <cmath>
#include <complex>

#include "linear/dense_matrix.hpp"
#include "model/scales.hpp"

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

namespace {

using Vector = Eigen::VectorXd;

/// q, p and lambda of the eigenvalue nearest to 0.
struct CriticalDirection {
  Vector q, p;
  double lambda;
};

std::optional<CriticalDirection> critical_direction(const HybridSystem& system, const Eigen::MatrixXd& a) {
  const Eigen::VectorXcd values = eigenvalues(a);
  if (!values.allFinite()) return std::nullopt;
  Eigen::Index nearest = 0;
  values.cwiseAbs().minCoeff(&nearest);
  if (values(nearest).imag() != 0.0) return std::nullopt;
  CriticalDirection result{eigenvector(a, values(nearest)).real(), eigenvector(a.transpose(), values(nearest)).real(),
                           values(nearest).real()};
  const bool is_positive = result.q(largest_in_users_units(system, result.q)) > 0.0;
  result.q *= (is_positive ? 1.0 : -1.0) / length_in_users_units(system, result.q);
  result.p /= result.p.dot(result.q);
  if (!result.q.allFinite() || !result.p.allFinite()) return std::nullopt;
  return result;
}

Vector with_entry(const Vector& v, double last) {
  Vector result(v.size() + 1);
  result << v, last;
  return result;
}

class EquilibriumEquations final : public SingularEquations {
 public:
  explicit EquilibriumEquations(const DefiningSystem& system) : system_(system) {}

  std::optional<ReducedEquation> reduce(const Orbit& x) override {
    x_ = x;
    forms_.emplace(system_, x_);
    const std::optional<CriticalDirection> found = critical_direction(system_.system(), forms_->jacobian());
    if (!found) return std::nullopt;
    q_ = found->q, w_ = -found->p;
    const Eigen::Index n = q_.size();
    bordered_ = Eigen::MatrixXd::Zero(n + 1, n + 1);
    bordered_.topLeftCorner(n, n) = forms_->jacobian();
    bordered_.topRightCorner(n, 1) = -q_;
    bordered_.bottomLeftCorner(1, n) = q_.transpose();
    ReducedEquation g;
    g.y = found->lambda;
    v_ = with_entry(q_, 0.0);
    u_ = with_entry(solve(-forms_->by_parameter(), g.s), 1.0);
    along_v_ = forms_->second_with_parameter(v_, v_);
    g.yy = weighted(along_v_);
    g.ys = weighted(forms_->second_with_parameter(v_, u_));
    g.ss = weighted(forms_->second_with_parameter(u_, u_));
    return g;
  }
  Coefficient cubic() override {
    double excess = 0.0;
    const Vector curvature = with_entry(solve(-along_v_, excess), 0.0);
    const Coefficient third = weighted(forms_->third(q_, q_, q_));
    const Coefficient bent = weighted(3.0 * forms_->second_with_parameter(v_, curvature));
    return {(third.value + bent.value) / 6.0, (third.uncertainty + bent.uncertainty) / 6.0};
  }
  double find_step(double y, double s) override {
    double excess = 0.0;
    step_ = with_entry(solve(-forms_->field(), excess), 0.0) + y * v_ + s * u_;
    return step_.head(q_.size()).lpNorm<Eigen::Infinity>() / (1.0 + x_.states.lpNorm<Eigen::Infinity>());
  }
  void move(Orbit& x) const override {
    x.states.topRows(q_.size()).colwise() += step_.head(q_.size());
    x.par(system_.free_parameters().front() - 1) += step_(q_.size());
  }
  double parameter_size(const Orbit& x) const override { return tchat::parameter_size(system_, x, 0); }

 private:
  Vector solve(const Vector& right, double& excess) const {
    const Vector solution = tchat::solve(bordered_, with_entry(right, 0.0));
    excess = solution(right.size());
    return solution.head(right.size());
  }
  Coefficient weighted(const Vector& rows) const {
    return {-w_.dot(rows), error_of_sums(system_.system()) * w_.cwiseAbs().dot(rows.cwiseAbs())};
  }

  const DefiningSystem& system_;
  Orbit x_;
  std::optional<EquilibriumForms> forms_;
  Vector q_, w_;
  Eigen::MatrixXd bordered_;
  Vector v_, u_, step_;  // with the parameter
  Vector along_v_;       // F''(V, V)
};

}  // namespace

std::optional<Coefficient> equilibrium_fold_form(const DefiningSystem& system, const Orbit& x) {
  const EquilibriumForms forms(system, x);
  const std::optional<CriticalDirection> critical = critical_direction(system.system(), forms.jacobian());
  if (!critical) return std::nullopt;
  const Product sum = product(critical->p, forms.second(critical->q, critical->q));
  if (!std::isfinite(sum.size)) return std::nullopt;
  return Coefficient{0.5 * sum.value.real(), 0.5 * error_of_sums(system.system()) * sum.size};
}

std::optional<BranchingForm> equilibrium_branching(const DefiningSystem& system, const Orbit& x) {
  EquilibriumEquations equations(system);
  Orbit refined = x;
  return branching_form(equations, refined);
}

Coefficient first_lyapunov_coefficient(const DefiningSystem& system, const Orbit& x, double omega) {
  using Vector = Eigen::VectorXd;
  using ComplexVector = Eigen::VectorXcd;
  const EquilibriumForms forms(system, x);
  const Eigen::MatrixXd a = forms.jacobian();
  const auto second = [&](const Vector& u, const Vector& v) { return forms.second(u, v); };
  const auto third = [&](const Vector& u, const Vector& v, const Vector& w) { return forms.third(u, v, w); };
  ComplexVector q = eigenvector(a, {0.0, omega});
  q /= length_in_users_units(system.system(), q);
  ComplexVector p = eigenvector(a.transpose(), {0.0, -omega});
  p /= std::conj(p.dot(q));  // dot conjugates its first vector
  const ComplexVector w = p.conjugate(), qbar = q.conjugate();
  const ComplexVector mean = solve_shifted(a, 0.0, bilinear(second, q, qbar));
  const ComplexVector twice = -solve_shifted(a, {0.0, 2.0 * omega}, bilinear(second, q, q));
  const Product cubic = product(w, trilinear(third, q));
  const Product by_mean = product(w, bilinear(second, q, mean));
  const Product by_twice = product(w, bilinear(second, qbar, twice));
  const std::complex<double> sum = cubic.value - 2.0 * by_mean.value + by_twice.value;
  const double error = error_of_sums(system.system()) * (cubic.size + 2.0 * by_mean.size + by_twice.size);
  return {sum.real() / (2.0 * omega), error / (2.0 * omega)};
}

}  // namespace tchat
