#include "stability/normal_form.hpp"

#include <algorithm>
#include <cmath>

#include "orbit/mesh_adaptation.hpp"
#include "stability/condensed_orbit.hpp"
#include "stability/multilinear.hpp"
#include "stability/orbit_forms.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;

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
      : system_(system),
        orbit_(system, shape, 1.0),
        along_parameter_(orbit_.forms().make_vector()),
        by_vector_(along_parameter_),
        by_change_(along_parameter_),
        curvature_(along_parameter_),
        step_(along_parameter_) {}

  std::optional<ReducedEquation> reduce(const Orbit& x) override {
    CriticalVectors vectors;
    if (!orbit_.linearise(x) || !forms().find_critical(1.0, vectors) || vectors.multiplier.imag() != 0.0)
      return std::nullopt;
    forms().set_vectors(vectors);
    x_ = &x;
    ReducedEquation g;
    g.y = vectors.multiplier.real() - 1.0;
    g.s = forms().solve_along_parameter(along_parameter_);
    forms().differentiate(vector(), by_vector_);
    forms().differentiate(along_parameter_, by_change_);
    g.yy = derivative(by_vector_, vector());
    g.ys = derivative(by_vector_, along_parameter_);
    g.ss = derivative(by_change_, along_parameter_);
    return g;
  }
  Coefficient cubic() override {
    const ReturnMapForms::AlongVector along = forms().find_along_vector();
    forms().solve_beside(along.second, curvature_);
    const Coefficient bent = derivative(by_vector_, curvature_);
    return {(3.0 * bent.value - along.third.value.real()) / 6.0,
            (3.0 * bent.uncertainty + error() * along.third.size) / 6.0};
  }
  double find_step(double y, double s) override {
    forms().solve_beside(orbit_.residual(*x_), step_);
    step_.states += y * vector().states + s * along_parameter_.states;
    step_.durations += y * vector().durations + s * along_parameter_.durations;
    step_.globals = s * along_parameter_.globals;
    return std::max(step_.states.lpNorm<Eigen::Infinity>(), step_.durations.lpNorm<Eigen::Infinity>());
  }
  void move(Orbit& x) const override { advance(x, 1.0, step_, system_.free_parameters()); }
  double parameter(const Orbit& x) const override { return x.par(system_.free_parameters().front() - 1); }

  Vector start() { return vector().states.col(0); }  ///< q

 private:
  ReturnMapForms& forms() { return orbit_.forms(); }
  const OrbitVector& vector() { return forms().right_vector(); }
  double error() const { return error_of_sums(system_.system()); }
  Coefficient derivative(const OrbitVector& row, const OrbitVector& v) const {
    return {dot(row, v), error() * dot_of_sizes(row, v)};
  }

  const DefiningSystem& system_;
  CondensedOrbit orbit_;
  const Orbit* x_ = nullptr;
  OrbitVector along_parameter_;        // U
  OrbitVector by_vector_, by_change_;  // -W F''(V, .) and -W F''(U, .)
  OrbitVector curvature_, step_;
};

/// At a fold the sign of a is that of q, which may have two entries of largest modulus.
double difference(const Found& a, const Found& b, Complex critical) {
  const bool is_turned = is_fold(critical) && a.q.dot(b.q) < 0.0;
  return std::abs(a.form.coefficient - (is_turned ? -1.0 : 1.0) * b.form.coefficient);
}

/// `other`, which has another mesh, moved by a step of this relative size along the tangent at x. It is an orbit to
/// first order.
Orbit along_branch(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent, Orbit other, double size) {
  double fastest = tangent.states.cwiseAbs().maxCoeff() / (1.0 + x.states.cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < system.free_parameters().size(); ++k)
    fastest = std::max(fastest, std::abs(tangent.globals(static_cast<Eigen::Index>(k))) /
                                    (1.0 + std::abs(x.par(system.free_parameters()[k] - 1))));
  const double step = size / fastest;
  other.states += step * interpolate_states(tangent.states, x.shape, x.mesh, other.shape, other.mesh);
  advance_parameters(other, step, tangent, system.free_parameters());
  return other;
}

/// The form beside x along the branch, so near that the multiplier is still near the critical value: close to grazing
/// it changes by far more than the orbit.
std::optional<Found> form_beside(const DefiningSystem& system, CondensedOrbit& coarse, const Orbit& x,
                                 const OrbitVector& tangent, const Orbit& other, Complex critical) {
  for (const double size : {1e-5, 1e-7, 1e-9})
    if (std::optional<Found> found = form_of(system, coarse, along_branch(system, x, tangent, other, size), critical))
      return found;
  return std::nullopt;
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
  const std::optional<Found> beside = form_beside(system, coarse, x, tangent, other, critical);
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
