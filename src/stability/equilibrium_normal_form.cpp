#include "stability/equilibrium_normal_form.hpp"

#include <cmath>

#include "linear/dense_matrix.hpp"
#include "stability/equilibrium_forms.hpp"

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;

/// q, p and lambda of the eigenvalue nearest to 0.
struct CriticalDirection {
  Vector q, p;
  double lambda;
};

std::optional<CriticalDirection> critical_direction(const Eigen::MatrixXd& a) {
  const Eigen::VectorXcd values = eigenvalues(a);
  if (!values.allFinite()) return std::nullopt;
  Eigen::Index nearest = 0, largest = 0;
  values.cwiseAbs().minCoeff(&nearest);
  if (values(nearest).imag() != 0.0) return std::nullopt;
  CriticalDirection result{eigenvector(a, values(nearest)).real(), eigenvector(a.transpose(), values(nearest)).real(),
                           values(nearest).real()};
  result.q.cwiseAbs().maxCoeff(&largest);
  result.q *= (result.q(largest) > 0.0 ? 1.0 : -1.0) / result.q.norm();
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
    const std::optional<CriticalDirection> found = critical_direction(forms_->jacobian());
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
    return step_.head(q_.size()).lpNorm<Eigen::Infinity>();
  }
  void move(Orbit& x) const override {
    x.states.topRows(q_.size()).colwise() += step_.head(q_.size());
    x.par(system_.free_parameters().front() - 1) += step_(q_.size());
  }
  double parameter(const Orbit& x) const override { return x.par(system_.free_parameters().front() - 1); }

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
  const std::optional<CriticalDirection> critical = critical_direction(forms.jacobian());
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

}  // namespace tchat
