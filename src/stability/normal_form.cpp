#include "stability/normal_form.hpp"

#include <algorithm>
#include <cmath>

#include "bvp/mesh_adaptation.hpp"
#include "bvp/nodal_expansion.hpp"
#include "bvp/nodal_system.hpp"
#include "stability/condensed_orbit.hpp"
#include "stability/multilinear.hpp"
#include "stability/orbit_forms.hpp"
#include "stability/shifted_orbit.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;
using ComplexVector = Eigen::VectorXcd;

/// A coefficient with the error of sums, the vector q that it belongs to, and the multiplier itself.
struct Found {
  NormalForm form;
  Vector q;
  Complex multiplier;
};

std::optional<Found> form_of(const DefiningSystem& system, CondensedOrbit& orbit, const Orbit& x, Complex critical) {
  CriticalVectors vectors;
  if (!orbit.linearise(x) || !orbit.forms().find_critical(critical, vectors)) return std::nullopt;
  const Product sum = orbit.forms().coefficient(vectors, critical);
  if (!std::isfinite(sum.size)) return std::nullopt;
  const Vector q = vectors.right.head(x.shape.dimension).real();
  return Found{{sum.value, error_of_sums(system.system()) * sum.size}, q, vectors.multiplier};
}

/// M(1) with the column E q and the row q', q the start of V: what g is in branching.hpp is P(x, p) - x along q, P the
/// return map.
class OrbitEquations final : public SingularEquations {
 public:
  OrbitEquations(const DefiningSystem& system, const OrbitShape& shape)
      : system_(system), nodal_(system, shape), expansion_(system) {}

  bool linearise(const Orbit& x) override {
    x_ = x;
    orbit_.emplace(nodal_, x_, shift_for(1.0));
    ComplexVector v, w;
    Complex multiplier;
    if (!orbit_->is_regular() || !orbit_->find_critical(1.0, v, w, multiplier)) return false;
    v_ = v.real(), w_ = w.real();
    critical_ = multiplier.real() - 1.0;
    return true;
  }
  const Vector& right_vector() const override { return v_; }
  const Vector& left_vector() const override { return w_; }
  double critical() const override { return critical_; }
  Vector residual() const override { return expansion_.part(x_, {}, 0); }
  Vector by_parameter() const override { return orbit_->parameter_column(); }
  Vector solve(const Vector& right, double& excess) override {
    return orbit_->solve_beside(1.0, right, orbit_->closing_rows(start()), start(), excess);
  }
  Vector second(const Vector& u, const Vector& v) const override { return expansion_.second_with_parameter(x_, u, v); }
  Vector third(const Vector& v) const override { return OrbitForms(system_, x_).third(v, v, v); }
  void move(Orbit& x, const Vector& change) const override {
    move_orbit(system_, x, change, change(change.size() - 1));
  }
  double parameter(const Orbit& x) const override { return x.par(system_.free_parameters().front() - 1); }
  double error() const override { return error_of_sums(system_.system()); }

  Vector start() const { return v_.head(x_.shape.dimension); }  ///< q

 private:
  const DefiningSystem& system_;
  NodalSystem nodal_;
  NodalExpansion expansion_;
  Orbit x_;
  std::optional<ShiftedOrbit> orbit_;
  Vector v_, w_;
  double critical_ = 0.0;
};

/// At a fold the sign of a is that of q, which may have two entries of largest modulus.
double difference(const Found& a, const Found& b, Complex critical) {
  const bool is_turned = is_fold(critical) && a.q.dot(b.q) < 0.0;
  return std::abs(a.form.coefficient - (is_turned ? -1.0 : 1.0) * b.form.coefficient);
}

/// Moves `other`, which has another mesh, by a small step along the tangent at x. It is an orbit to first order.
void move_along(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent, Orbit& other) {
  constexpr double small = 1e-5;
  double fastest = tangent.states.cwiseAbs().maxCoeff() / (1.0 + x.states.cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < system.free_parameters().size(); ++k)
    fastest = std::max(fastest, std::abs(tangent.globals(static_cast<Eigen::Index>(k))) /
                                    (1.0 + std::abs(x.par(system.free_parameters()[k] - 1))));
  const double step = small / fastest;
  other.states += step * interpolate_states(tangent.states, x.shape, x.mesh, other.shape, other.mesh);
  for (int s = 0; s < x.shape.segments; ++s) other.duration(s) += step * tangent.durations(s);
  for (std::size_t k = 0; k < system.free_parameters().size(); ++k)
    other.par(system.free_parameters()[k] - 1) += step * tangent.globals(static_cast<Eigen::Index>(k));
}

void add_difference(Coefficient& fine, double coarse) { fine.uncertainty += std::abs(fine.value - coarse); }

}  // namespace

std::optional<BranchingForm> orbit_branching(const DefiningSystem& system, const Orbit& x) {
  if (x.shape.own || x.shape.intervals < 2) return std::nullopt;
  Orbit refined = x;
  OrbitEquations fine(system, x.shape);
  std::optional<BranchingForm> form = branching_form(fine, refined);
  if (!form) return form;
  Orbit other = on_every_second_point(refined);
  OrbitEquations coarse(system, other.shape);
  const std::optional<BranchingForm> compared = branching_form(coarse, other);
  if (!compared) return std::nullopt;
  add_difference(form->a, (fine.start().dot(coarse.start()) < 0.0 ? -1.0 : 1.0) * compared->a.value);
  add_difference(form->b, compared->b.value);
  add_difference(form->c, compared->c.value);
  return form;
}

std::optional<NormalForm> normal_form(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent,
                                      Complex critical) {
  if (x.shape.own || x.shape.intervals < 2) return std::nullopt;
  CondensedOrbit fine(system, x.shape, critical);
  const std::optional<Found> found = form_of(system, fine, x, critical);
  if (!found) return std::nullopt;
  Orbit other = on_every_second_point(x);
  CondensedOrbit coarse(system, other.shape, critical);
  if (!coarse.correct(found->q, other)) return std::nullopt;
  const std::optional<Found> compared = form_of(system, coarse, other, critical);
  if (!compared) return std::nullopt;
  NormalForm form = found->form;
  form.uncertainty += difference(*found, *compared, critical);
  move_along(system, x, tangent, other);
  const std::optional<Found> beside = form_of(system, coarse, other, critical);
  if (!beside) return std::nullopt;
  form.uncertainty += std::abs(found->multiplier - critical) * difference(*beside, *compared, critical) /
                      std::abs(beside->multiplier - compared->multiplier);
  return std::isfinite(form.uncertainty) ? std::optional(form) : std::nullopt;
}

std::optional<Coefficient> NormalFormSolver::find(CondensedSystem& condensed, const Orbit& x,
                                                  const OrbitCondition& condition) {
  if (x.shape.own || !condition.put_critical_vectors(vectors_)) return std::nullopt;
  const Complex critical = vectors_.multiplier / std::abs(vectors_.multiplier);
  if (!forms_ || shape_ != x.shape) {
    forms_ = std::make_unique<ReturnMapForms>(system_, x.shape, critical.imag() != 0.0);
    shape_ = x.shape;
  }
  // The conditions have the gradients -left (dS) right and that of |mu|^2 - 1.
  const Eigen::Index n = x.shape.dimension;
  const Complex overlap = (vectors_.left.tail(n).transpose() * vectors_.right.head(n)).value();
  const double factor = critical.imag() != 0.0 ? 0.5 : 1.0 / overlap.real();
  if (!forms_->factorize(condensed, x, 1.0) || !forms_->normalise(vectors_)) return std::nullopt;
  const Product sum = forms_->on_curve(vectors_, critical, condition.gradient(0), factor);
  if (!std::isfinite(sum.size)) return std::nullopt;
  return Coefficient{sum.value.real(), error_of_sums(system_.system()) * sum.size};
}

}  // namespace tchat
