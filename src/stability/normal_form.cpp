#include "stability/normal_form.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/levels.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/return_map.hpp"
#include "stability/condensed_orbit.hpp"

namespace tchat {

namespace {

/// The change of y and p to the centre of the bifurcation, where g_y and g_s vanish.
Eigen::Vector2d change_to_centre(const ReducedEquation& g) {
  Eigen::Matrix2d hessian;
  hessian << g.yy.value, g.ys.value, g.ys.value, g.ss.value;
  return -hessian.inverse() * Eigen::Vector2d(g.y, g.s);
}

BranchingForm form_of(const ReducedEquation& g, const Coefficient& cubic) {
  const double rate = std::sqrt(g.square_of_rate());
  const double error = std::abs(g.ys.value) * g.ys.uncertainty +
                       0.5 * (std::abs(g.yy.value) * g.ss.uncertainty + std::abs(g.ss.value) * g.yy.uncertainty);
  return {{0.5 * g.yy.value, 0.5 * g.yy.uncertainty}, {rate, error / rate}, cubic};
}

/// `before` is that of a point one step before, `place` the rounding of states.
std::optional<BranchingForm> with_errors_of_place(BranchingForm form, const BranchingForm& before, double place) {
  form.a.uncertainty += std::abs(form.a.value - before.a.value) + 3.0 * std::abs(form.c.value) * place;
  form.b.uncertainty += std::abs(form.b.value - before.b.value);
  form.c.uncertainty += std::abs(form.c.value - before.c.value);
  for (const Coefficient& k : {form.a, form.b, form.c})
    if (!std::isfinite(k.value) || !std::isfinite(k.uncertainty)) return std::nullopt;
  return form;
}

}  // namespace

std::optional<BranchingForm> branching_form(SingularEquations& equations, Orbit& x) {
  constexpr int most_steps = 8;
  constexpr double farthest = 0.1;
  const double size = 1.0 + x.states.cwiseAbs().maxCoeff();
  std::optional<BranchingForm> before;
  double last = farthest;
  for (int k = 0; k < most_steps; ++k) {
    const std::optional<ReducedEquation> g = equations.reduce(x);
    if (!g || !(g->square_of_rate() > 0.0)) return std::nullopt;
    if (before) return with_errors_of_place(form_of(*g, equations.cubic()), *before, level::rounding_of_sums * size);
    const Eigen::Vector2d change = change_to_centre(*g);
    const double length =
        std::max(equations.find_step(change(0), change(1)), std::abs(change(1)) / equations.parameter_size(x));
    if (!(length < farthest)) return std::nullopt;
    const bool is_rounding = last < level::stalled && length > 0.5 * last;  // that the equations may amplify
    if (length < level::converged || is_rounding) before = form_of(*g, equations.cubic());
    last = length;
    equations.move(x);
  }
  return std::nullopt;
}

Branching branching_of(const BranchingForm& form) {
  constexpr double share = 1e-3;
  if (!(form.b.value > form.b.uncertainty)) return Branching::undecided;
  if (std::abs(form.a.value) > form.a.uncertainty) return Branching::transcritical;
  const bool is_cubic = std::abs(form.c.value) > form.c.uncertainty;
  return is_cubic && form.a.uncertainty < share * std::sqrt(std::abs(form.c.value)) ? Branching::pitchfork
                                                                                    : Branching::undecided;
}

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

/// M(1) with the column E q and the row q', q the start of V: what g is there is P(x, p) - x along q, P
/// the return map.
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
    return std::max(step_.states.lpNorm<Eigen::Infinity>() / (1.0 + x_->states.lpNorm<Eigen::Infinity>()),
                    step_.durations.lpNorm<Eigen::Infinity>() / std::abs(x_->period()));
  }
  void move(Orbit& x) const override { advance(x, 1.0, step_, system_.free_parameters()); }
  double parameter_size(const Orbit& x) const override { return tchat::parameter_size(system_, x, 0); }

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
  for (int k = 0; k < system.free_count(); ++k)
    fastest = std::max(fastest, std::abs(tangent.globals(k)) / parameter_size(system, x, k));
  const double step = size / fastest;
  other.states += step * interpolate_states(tangent.states, x.shape, x.mesh, other.shape, other.mesh);
  advance_parameters(other, step, tangent, system.free_parameters());
  return other;
}

/// The form beside x along the branch, so near that the multiplier is still near the critical value: close to grazing
/// it changes by far more than the orbit.
std::optional<Found> form_beside(const DefiningSystem& system, CondensedOrbit& coarse, const Orbit& x,
                                 const OrbitVector& tangent, const Orbit& other, Complex critical) {
  for (const double size : {level::same, level::tolerance, level::orbit})
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

namespace {

/// By how much an error of the return map is larger in (target - A)^-1.
double amplification(const FloquetMultipliers& multipliers, Complex target) {
  double nearest = 1.0;
  for (const Complex& mu : multipliers.nontrivial()) nearest = std::min(nearest, std::abs(mu - target));
  return 1.0 / std::max(nearest, std::numeric_limits<double>::min());
}

}  // namespace

std::optional<Coefficient> NormalFormSolver::find(CondensedSystem& condensed, const Orbit& x,
                                                  const OrbitCondition& condition,
                                                  const FloquetMultipliers& multipliers) {
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
  double amplified = amplification(multipliers, 1.0);
  if (critical.imag() != 0.0) amplified += amplification(multipliers, critical * critical);
  const double accuracy = multiplier_accuracy(multipliers);
  const double of_terms = (error_of_sums(system_.system()) + accuracy * amplified) * sum.size;
  return Coefficient{sum.value.real(), of_terms + accuracy * square_in_sizes(x)};
}

double NormalFormSolver::square_in_sizes(const Orbit& x) const {
  double sum = 0.0;
  for (Eigen::Index a = 0; a < x.shape.dimension; ++a)
    sum += std::norm(vectors_.right(a) / size_for_tolerance(x.states.row(a).cwiseAbs().maxCoeff()));
  return sum;
}

namespace {

using ComplexVector = Eigen::VectorXcd;

/// Coefficients of one orbit with the errors of sums, and the vector q, whose sign some of them have.
struct ResonanceCoefficients {
  std::vector<NamedCoefficient> coefficients;
  Vector q;
};

/// Of M's rows `sum` in place of the map's, times a factor.
Product of_map(const ComplexVector& w, const ComplexVector& rows, double factor) {
  const Product sum = product(w, rows);
  return {-factor * sum.value, factor * sum.size};
}
Product of_map(const Vector& w, const Vector& rows, double factor) {
  return of_map(w.cast<Complex>().eval(), rows.cast<Complex>().eval(), factor);
}

class ResonanceReduction {
 public:
  ResonanceReduction(const DefiningSystem& system, const Orbit& x, ShiftedOrbit& orbit)
      : error_(error_of_sums(system.system())), forms_(system, x), orbit_(orbit) {}

  std::optional<ResonanceCoefficients> find(PointType type) {
    bool is_found = false;
    if (type == PointType::cusp) is_found = find_cusp();
    if (type == PointType::resonance_1) is_found = find_double(1.0);
    if (type == PointType::resonance_2) is_found = find_double(-1.0);
    if (type == PointType::resonance_3) is_found = find_third();
    if (type == PointType::resonance_4) is_found = find_fourth();
    if (!is_found) return std::nullopt;
    for (const NamedCoefficient& of : found_.coefficients)
      if (!std::isfinite(of.coefficient.value) || !std::isfinite(of.coefficient.uncertainty)) return std::nullopt;
    return found_;
  }

 private:
  void add(const char* name, double value, double size) {
    found_.coefficients.push_back({name, {value, error_ * size}});
  }

  bool find_cusp() {
    ComplexVector v, w;
    Complex multiplier;
    if (!orbit_.find_critical(1.0, v, w, multiplier)) return false;
    found_.q = v.real().head(orbit_.dimension());
    double excess = 0.0;
    const Vector h =
        orbit_.solve_beside(1.0, -forms_.second(v, v).real(), orbit_.closing_rows(found_.q), found_.q, excess);
    const Product c = of_map(w, forms_.third(v) + 3.0 * forms_.second(v, ComplexVector(h.cast<Complex>())), 1.0 / 6.0);
    add("c", c.value.real(), c.size);
    return true;
  }

  bool find_double(double mu) {
    const auto of = orbit_.find_double(mu);
    if (!of) return false;
    found_.q = of->v.head(orbit_.dimension());
    const Vector square = forms_.second(of->v, of->v);
    const Vector mixed = forms_.second(of->v, of->v1);
    return mu > 0.0 ? add_quadratic(*of, square, mixed) : add_cubic(*of, square, mixed);
  }

  bool add_quadratic(const ShiftedOrbit::DoubleVectors& of, const Vector& square, const Vector& mixed) {
    const Product a = of_map(of.w, square, 0.5);
    const Product b = of_map(of.w, mixed, 1.0), rest = of_map(of.w1, square, 1.0);
    add("a", a.value.real(), a.size);
    add("b", (b.value + rest.value).real(), b.size + rest.size);
    return true;
  }

  bool add_cubic(const ShiftedOrbit::DoubleVectors& of, const Vector& square, const Vector& mixed) {
    const Vector h = orbit_.solve(1.0, -square.cast<Complex>()).real();
    const Vector right = orbit_.closing_rows(Vector(h.head(orbit_.dimension()))) - mixed;
    const Vector k = orbit_.solve(1.0, right.cast<Complex>()).real();
    const Vector cubic = forms_.third(of.v, of.v, of.v) + 3.0 * forms_.second(of.v, h);
    const Vector other = forms_.third(of.v, of.v, of.v1) + 2.0 * forms_.second(of.v, k) + forms_.second(of.v1, h);
    const Product c = of_map(of.w, cubic, 1.0 / 6.0);
    const Product d = of_map(of.w, other, 0.5), rest = of_map(of.w1, cubic, 0.5);
    add("c", c.value.real(), c.size);
    add("d", (d.value + rest.value).real(), d.size + rest.size);
    return true;
  }

  /// The vectors of mu, V V, and C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)).
  bool find_pair(Complex mu) {
    Complex multiplier;
    if (!orbit_.find_critical(mu, v_, w_, multiplier)) return false;
    found_.q = v_.real().head(orbit_.dimension());
    square_ = forms_.second(v_, v_);
    const ComplexVector size = orbit_.solve(1.0, -forms_.second(v_, ComplexVector(v_.conjugate())));
    cubic_ = forms_.third(v_) + 2.0 * forms_.second(v_, size);
    return true;
  }

  bool find_third() {
    const Complex mu = std::polar(1.0, 2.0 * std::numbers::pi / 3.0);
    if (!find_pair(mu)) return false;
    const Product b = of_map(w_, square_.conjugate(), 0.5);
    const ComplexVector q = v_.head(orbit_.dimension()).conjugate(), p = w_.tail(orbit_.dimension()).conjugate();
    const ComplexVector right = -square_ - 2.0 * std::conj(b.value) * orbit_.closing_rows(q);
    const ComplexVector h = orbit_.solve_singular(std::conj(mu), right, p, q);
    const Product c = of_map(w_, cubic_ + forms_.second(ComplexVector(v_.conjugate()), h), 0.5);
    add("|b1|", 3.0 * std::abs(b.value), 3.0 * b.size);
    add("Re c1", (3.0 * mu * mu * c.value).real() - 3.0 * std::norm(b.value),
        3.0 * c.size + 6.0 * std::abs(b.value) * b.size);
    return true;
  }

  bool find_fourth() {
    if (!find_pair(Complex(0.0, 1.0))) return false;
    const ComplexVector conjugate = v_.conjugate();
    const ComplexVector h = orbit_.solve(-1.0, -square_);
    const Product c = of_map(w_, cubic_ + forms_.second(conjugate, h), 0.5);
    const Product d =
        of_map(w_, forms_.cube(conjugate) + 3.0 * forms_.second(conjugate, ComplexVector(h.conjugate())), 1.0 / 6.0);
    add("Re c1", 4.0 * c.value.imag(), 4.0 * c.size);
    add("Im c1", -4.0 * c.value.real(), 4.0 * c.size);
    add("|d1|", 4.0 * std::abs(d.value), 4.0 * d.size);
    return true;
  }

  double error_;
  OrbitForms forms_;
  ShiftedOrbit& orbit_;
  ResonanceCoefficients found_;
  ComplexVector v_, w_, square_, cubic_;  // of a pair
};

Complex critical_multiplier(PointType type) {
  if (type == PointType::resonance_2) return -1.0;
  if (type == PointType::resonance_3) return std::polar(1.0, 2.0 * std::numbers::pi / 3.0);
  if (type == PointType::resonance_4) return {0.0, 1.0};
  return 1.0;
}

std::optional<ResonanceCoefficients> find_on(const DefiningSystem& system, NodalSystem& nodal, const Orbit& x,
                                             PointType type) {
  ShiftedOrbit orbit(nodal, x, shift_for(critical_multiplier(type)));
  return orbit.is_regular() ? ResonanceReduction(system, x, orbit).find(type) : std::nullopt;
}

}  // namespace

std::vector<NamedCoefficient> codimension_two_form(const DefiningSystem& system, const Orbit& x, PointType type) {
  if (x.shape.own || x.shape.intervals < 2) return {};
  NodalSystem fine(system, x.shape);
  std::optional<ResonanceCoefficients> found = find_on(system, fine, x, type);
  if (!found) return {};
  Orbit other = on_every_second_point(x);
  NodalSystem coarse(system, other.shape);
  if (!CondensedOrbit(system, other.shape, critical_multiplier(type)).correct(found->q, other)) return {};
  const std::optional<ResonanceCoefficients> compared = find_on(system, coarse, other, type);
  if (!compared) return {};
  const bool is_turned = type == PointType::resonance_1 && found->q.dot(compared->q) < 0.0;
  for (std::size_t k = 0; k < found->coefficients.size(); ++k) {
    Coefficient& of = found->coefficients[k].coefficient;
    of.uncertainty += std::abs(of.value - (is_turned ? -1.0 : 1.0) * compared->coefficients[k].coefficient.value);
  }
  return found->coefficients;
}

}  // namespace tchat
