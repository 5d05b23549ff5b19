/// Normal forms of bifurcations of periodic orbits: branch points, period doublings, torus bifurcations and resonances.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/point_type.hpp"
#include "stability/return_map_forms.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// What crosses at a branch point: the equations reduced to two unknowns, with their coefficients.
//
// F(u, p) = 0, N equations for u in R^N and one parameter, has at the branch point V and W with F_u V = 0, W F_u = 0,
// W F_p = 0. With a column b, W b = 1, and a row r, r V = 1, the system
//
//     F(u, p) + zeta b = 0,     r (u - u_0) = y,     p = p_0 + s                              (N + 1 unknowns u, zeta)
//
// is regular, and zeta = g(y, s) vanishes where the original one has a solution: y is the distance of two solutions at
// one parameter along V. With V^ = (V, 0), U^ = (U, 1), F_u U + F_p = 0, r U = 0,
//
//     g = a y^2 + g_ys y s + g_ss s^2 / 2 + c y^3 + ...,
//     a = -W F''(V^, V^) / 2,   g_ys = -W F''(V^, U^),   g_ss = -W F''(U^, U^),
//     c = -W (F'''(V, V, V) + 3 F''(V, H)) / 6,          F_u H + F''(V, V) = zeta b, r H = 0.
//
// Two branches cross where b^2 = g_ys^2 - 2 a g_ss > 0, and the critical eigenvalue (or multiplier less 1) is g_y: on
// one it grows by b, on the other by -b per unit of the parameter. For a = 0 (pitchfork) the second one turns, y^2 =
// -g_ys s / c, at the rate -2 b times the sign of g_ys: c < 0 is supercritical, with what is born where the other one
// is unstable.
//
// The point itself is refined: F + zeta b = 0, g_y = 0, g_s = 0 are N + 2 equations for the N + 2 unknowns u, zeta and
// p. So the centre of the bifurcation is found where errors of a mesh make an imperfect one of it, which zeta
// balances, and the place of the label along the branch adds no error (G. Moore, The numerical treatment of
// non-trivial bifurcation points, Numer. Funct. Anal. Optim. 2, 1980).

/// The derivatives of g at a point, second ones with the errors of sums.
struct ReducedEquation {
  double y = 0.0, s = 0.0;
  Coefficient yy, ys, ss;

  double square_of_rate() const { return ys.value * ys.value - yy.value * ss.value; }
};

/// The equations near a branch point.
class SingularEquations {
 public:
  virtual ~SingularEquations() = default;

  /// g at x, to which the calls below refer until the next one; nothing where no simple critical value is near, or
  /// something is not finite.
  virtual std::optional<ReducedEquation> reduce(const Orbit& x) = 0;
  /// c at that point, with the errors of sums.
  virtual Coefficient cubic() = 0;
  /// Newton's step from that point to F + zeta b = 0 with these changes of y and p: the largest change in u, of a
  /// state beside 1 + |x|, of a duration beside the period.
  virtual double find_step(double y, double s) = 0;
  /// That step; x is the orbit of reduce().
  virtual void move(Orbit& x) const = 0;
  /// Of its one free parameter.
  virtual double parameter_size(const Orbit& x) const = 0;
};

/// Coefficients of g, with the errors of sums. The sign of a is that of V.
struct BranchingForm {
  Coefficient a, b, c;
};

/// At the branch point near x, which becomes the refined one. Nothing where there is none: equations more than simply
/// singular, or b^2 <= 0. Allocates.
std::optional<BranchingForm> branching_form(SingularEquations& equations, Orbit& x);

enum class Branching { transcritical, pitchfork, undecided };

/// A pitchfork: a is 0 within an uncertainty that is small for its size. A fold at a distance of a^2 / (4 c b) from the
/// branch point, by which a transcritical one differs from it, cannot be seen. Undecided also where b may be 0.
Branching branching_of(const BranchingForm& form);

// Normal forms of the bifurcations of periodic orbits: what is born at a period doubling or a torus bifurcation, and
// how a branch turns at a fold (Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., 5.4).
//
// With A, B, C the first three derivatives of the return map of the state x_1(0), events and jumps included, A q = mu
// q, p A = mu p, p q = 1, |q| = 1 (Euclidean, in the units of the states; complex products without conjugation),
//
//     fold             mu = 1               a = p B(q, q) / 2
//     period doubling  mu = -1              c = p (C(q, q, q) + 3 B(q, (1 - A)^-1 B(q, q))) / 6
//     torus            mu = e^(i theta)     d = e^(-i theta) p (C(q, q, q*) + 2 B(q, (1 - A)^-1 B(q, q*))
//                                               + B(q*, (e^(2 i theta) - A)^-1 B(q, q))) / 2
//
// c > 0: the doubled orbits are on the side where the orbit is unstable, and stable if no other multiplier is outside
// the unit circle (supercritical); c < 0: on the other side, unstable. So for the torus with Re d < 0 and > 0. The
// state moves by q eps on the doubled orbits, where eps^2 is about (-1 - mu(parameter)) / c. q has its largest entry
// positive, which fixes the sign of a.
//
// No derivative of the map is formed. With M(mu) of return_map.hpp the whole orbit is expanded
// (return_map_forms.hpp): M(mu) V = 0 and W M(mu) = 0 are q and p on all nodes and rows, M(1) H = -F''(V, V) is the
// second term, F the equations, and c = -W (F'''(V, V, V) + 3 F''(V, H)) / 6: solutions of linear problems
// that are as well posed as the orbit's own, however much it contracts or expands. One factorisation of M(mu_0) serves
// all: that of another mu differs in n rows. mu_0 is 1, at a fold -1.

struct NormalForm {
  std::complex<double> coefficient;  ///< a, c, d
  /// How well it is known: the difference to that of the same orbit on every second mesh point, what the orbit's place
  /// on the branch makes of it (its multiplier is not quite the critical one), and the errors of sums and of
  /// differences for derivatives.
  double uncertainty = 0.0;
};

/// The coefficient of an orbit that has the multiplier `critical` up to the accuracy of the branch, along `tangent`: 1,
/// -1 or e^(i theta), 0 < theta < pi. Nothing where equations are singular, as with a second critical multiplier, or
/// where the mesh has but one interval, or segments have meshes of their own. The map has to be smooth at the orbit: no
/// end of a segment tangent to its event surface. Allocates.
std::optional<NormalForm> normal_form(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent,
                                      std::complex<double> critical);

/// What crosses at the branch point near x (SingularEquations): with V and W as above and mu = 1, g is the return map
/// less the identity along q, so that a = p B(q, q) / 2 as at a fold. Nothing under the same conditions, or where no
/// branch crosses. Allocates.
std::optional<BranchingForm> orbit_branching(const DefiningSystem& system, const Orbit& x);

/// c or Re d at points of a curve of period doublings or torus bifurcations, from the linearisation that Newton's
/// method has left there and from the vectors of the curve's condition. The uncertainty has two parts: the errors of
/// the return map in each term, which are larger near the poles of (1 - A)^-1 and (mu^2 - A)^-1, and the accuracy of
/// multipliers: a coefficient that changes them by less where states are as large as on the orbit is zero. Allocates at
/// the first point of a shape, and where third derivatives are differences.
class NormalFormSolver {
 public:
  explicit NormalFormSolver(const DefiningSystem& system) : system_(system) {}
  /// `condition` is evaluated at x, whose linearisation is in `condensed`. Nothing where that has segments with meshes
  /// of their own, or equations are singular.
  std::optional<Coefficient> find(CondensedSystem& condensed, const Orbit& x, const OrbitCondition& condition,
                                  const FloquetMultipliers& multipliers);
  /// |q|^2 of the last one in sizes of the states of x. In units of the user, where |q| = 1, q may all but vanish at
  /// some section and c have a pole; c over this has none.
  double square_in_sizes(const Orbit& x) const;

 private:
  const DefiningSystem& system_;
  std::optional<OrbitShape> shape_;
  std::unique_ptr<ReturnMapForms> forms_;  // of shape_
  CriticalVectors vectors_;
};

// Coefficients of normal forms where two multipliers are critical, or the first coefficient is zero: at the cusp and
// at the strong resonances 1:1 to 1:4 (Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., ch. 9; Kuznetsov
// and Meijer, SIAM J. Sci. Comput. 26, 2005).
//
// With A, B, C the first three derivatives of the return map, complex products without conjugation:
//
//     cusp    A q = q, p A = p, p q = 1, |q| = 1:  (1 - A) h = B(q, q) - (p B(q, q)) q,
//             c = p (C(q,q,q) + 3 B(q,h)) / 6
//     1:1     A q = q, A q1 = q1 + q, p A = p, p1 A = p1 + p, p q1 = p1 q = 1, p1 q1 = 0, |q| = 1:
//             (x, y) -> (x + y, y + a x^2 + b x y),  a = p B(q,q) / 2,  b = p B(q,q1) + p1 B(q,q)
//     1:2     A q = -q, A q1 = -q1 + q, p A = -p, p1 A = -p1 + p, and so on:
//             (x, y) -> (-x + y, -y + c x^3 + d x^2 y),  h = (1-A)^-1 B(q,q),  k = (1-A)^-1 (B(q,q1) + h),
//             c = p (C(q,q,q) + 3 B(q,h)) / 6,
//             d = (p (C(q,q,q1) + 2 B(q,k) + B(q1,h)) + p1 (C(q,q,q) + 3 B(q,h))) / 2
//     1:3     A q = mu q, mu = e^(2 pi i / 3), |q| = 1:  z -> mu z + b z*^2 + c z |z|^2,  b = p B(q*,q*) / 2,
//             (mu* - A) h = B(q,q) - 2 b* q*,  c = p (C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)) + B(q*,h)) / 2;
//             what matters: |b1| = 3 |b|, and Re c1 of c1 = 3 mu^2 c - 3 |b|^2
//     1:4     A q = i q, |q| = 1:  z -> i z + c z |z|^2 + d z*^3,
//             c = p (C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)) + B(q*,h)) / 2,  (-1 - A) h = B(q,q),
//             d = p (C(q*,q*,q*) + 3 B(q*,h*)) / 6;  what matters: c1 = -4 i c and |d1| = 4 |d|
//
// As for the other normal forms everything is done on the nodes of the whole orbit.

struct NamedCoefficient {
  const char* name;
  Coefficient coefficient;
};

/// Of an orbit that is this point of codimension two (cusp, resonance_1, ..., resonance_4) up to the accuracy of its
/// curve: c; a, b; c, d; |b1|, Re c1; Re c1, Im c1, |d1|. Uncertainties are those of the mesh and of sums; that of the
/// point's place is not in them. Empty for other types, where equations are singular, and where normal_form() has no
/// coefficient. Allocates.
std::vector<NamedCoefficient> codimension_two_form(const DefiningSystem& system, const Orbit& x, PointType type);

}  // namespace tchat
