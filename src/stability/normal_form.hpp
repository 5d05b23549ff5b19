/// Normal forms of the bifurcations of periodic orbits: what is born at a period doubling or a torus bifurcation, and
/// how a branch turns at a fold (Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., 5.4).
///
/// With A, B, C the first three derivatives of the return map of the state x_1(0), events and jumps included, A q = mu
/// q, p A = mu p, p q = 1, |q| = 1 (Euclidean, in the units of the states; complex products without conjugation),
///
///     fold             mu = 1               a = p B(q, q) / 2
///     period doubling  mu = -1              c = p (C(q, q, q) + 3 B(q, (1 - A)^-1 B(q, q))) / 6
///     torus            mu = e^(i theta)     d = e^(-i theta) p (C(q, q, q*) + 2 B(q, (1 - A)^-1 B(q, q*))
///                                               + B(q*, (e^(2 i theta) - A)^-1 B(q, q))) / 2
///
/// c > 0: the doubled orbits are on the side where the orbit is unstable, and stable if no other multiplier is outside
/// the unit circle (supercritical); c < 0: on the other side, unstable. So for the torus with Re d < 0 and > 0. The
/// state moves by q eps on the doubled orbits, where eps^2 is about (-1 - mu(parameter)) / c. q has its largest entry
/// positive, which fixes the sign of a.
///
/// No derivative of the map is formed. With M(mu) of return_map.hpp the whole orbit is expanded
/// (return_map_forms.hpp): M(mu) V = 0 and W M(mu) = 0 are q and p on all nodes and rows, M(1) H = -F''(V, V) is the
/// second term, F the equations, and c = -W (F'''(V, V, V) + 3 F''(V, H)) / 6: solutions of linear problems
/// that are as well posed as the orbit's own, however much it contracts or expands. One factorisation of M(mu_0) serves
/// all: that of another mu differs in n rows. mu_0 is 1, at a fold -1.
#pragma once

#include <complex>
#include <memory>
#include <optional>

#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/branching.hpp"
#include "stability/multilinear.hpp"
#include "stability/return_map_forms.hpp"

namespace tchat {

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

/// What crosses at the branch point near x (branching.hpp): with V and W as above and mu = 1, g is the return map less
/// the identity along q, so that a = p B(q, q) / 2 as at a fold. Nothing under the same conditions, or where no branch
/// crosses. Allocates.
std::optional<BranchingForm> orbit_branching(const DefiningSystem& system, const Orbit& x);

/// c or Re d at points of a curve of period doublings or torus bifurcations, from the linearisation that Newton's
/// method has left there and from the vectors of the curve's condition. Without an estimate of the mesh's error: the
/// uncertainty is that of sums and differences alone. Allocates at the first point of a shape, and where third
/// derivatives are differences.
class NormalFormSolver {
 public:
  explicit NormalFormSolver(const DefiningSystem& system) : system_(system) {}
  /// `condition` is evaluated at x, whose linearisation is in `condensed`. Nothing where that has segments with meshes
  /// of their own, or equations are singular.
  std::optional<Coefficient> find(CondensedSystem& condensed, const Orbit& x, const OrbitCondition& condition);

 private:
  const DefiningSystem& system_;
  std::optional<OrbitShape> shape_;
  std::unique_ptr<ReturnMapForms> forms_;  // of shape_
  CriticalVectors vectors_;
};

}  // namespace tchat
