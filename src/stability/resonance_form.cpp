#include "stability/resonance_form.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "orbit/return_map.hpp"
#include "stability/condensed_orbit.hpp"
#include "stability/orbit_forms.hpp"
#include "stability/shifted_orbit.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;
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
