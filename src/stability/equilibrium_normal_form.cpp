#include "stability/equilibrium_normal_form.hpp"

#include <cmath>

#include "linear_algebra/dense_matrix.hpp"
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

class EquilibriumEquations final : public SingularEquations {
 public:
  explicit EquilibriumEquations(const DefiningSystem& system) : system_(system) {}

  bool linearise(const Orbit& x) override {
    x_ = x;
    forms_.emplace(system_, x_);
    const std::optional<CriticalDirection> found = critical_direction(forms_->jacobian());
    if (!found) return false;
    const Eigen::Index n = found->q.size();
    q_ = found->q, w_ = -found->p, critical_ = found->lambda;
    bordered_ = Eigen::MatrixXd::Zero(n + 1, n + 1);
    bordered_.topLeftCorner(n, n) = forms_->jacobian();
    bordered_.topRightCorner(n, 1) = -q_;
    bordered_.bottomLeftCorner(1, n) = q_.transpose();
    return true;
  }
  const Vector& right_vector() const override { return q_; }
  const Vector& left_vector() const override { return w_; }
  double critical() const override { return critical_; }
  Vector residual() const override { return forms_->field(); }
  Vector by_parameter() const override { return forms_->by_parameter(); }
  Vector solve(const Vector& right, double& excess) override {
    Vector rows(right.size() + 1);
    rows << right, 0.0;
    const Vector solution = tchat::solve(bordered_, rows);
    excess = solution(right.size());
    return solution.head(right.size());
  }
  Vector second(const Vector& u, const Vector& v) const override { return forms_->second_with_parameter(u, v); }
  Vector third(const Vector& v) const override { return forms_->third(v, v, v); }
  void move(Orbit& x, const Vector& change) const override {
    x.states.topRows(q_.size()).colwise() += change.head(q_.size());
    x.par(system_.free_parameters().front() - 1) += change(q_.size());
  }
  double parameter(const Orbit& x) const override { return x.par(system_.free_parameters().front() - 1); }
  double error() const override { return error_of_sums(system_.system()); }

 private:
  const DefiningSystem& system_;
  Orbit x_;
  std::optional<EquilibriumForms> forms_;
  Vector q_, w_;
  double critical_ = 0.0;
  Eigen::MatrixXd bordered_;
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
