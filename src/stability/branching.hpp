/// What crosses at a branch point: the equations reduced to two unknowns, with their coefficients.
///
/// F(u, p) = 0, N equations for u in R^N and one parameter, has at the branch point V and W with F_u V = 0, W F_u = 0,
/// W F_p = 0. With a column b, W b = 1, and a row r, r V = 1, the system
///
///     F(u, p) + zeta b = 0,     r (u - u_0) = y,     p = p_0 + s                              (N + 1 unknowns u, zeta)
///
/// is regular, and zeta = g(y, s) vanishes where the original one has a solution: y is the distance of two solutions at
/// one parameter along V. With V^ = (V, 0), U^ = (U, 1), F_u U + F_p = 0, r U = 0,
///
///     g = a y^2 + g_ys y s + g_ss s^2 / 2 + c y^3 + ...,
///     a = -W F''(V^, V^) / 2,   g_ys = -W F''(V^, U^),   g_ss = -W F''(U^, U^),
///     c = -W (F'''(V, V, V) + 3 F''(V, H)) / 6,          F_u H + F''(V, V) = zeta b, r H = 0.
///
/// Two branches cross where b^2 = g_ys^2 - 2 a g_ss > 0, and the critical eigenvalue (or multiplier less 1) is g_y: on
/// one it grows by b, on the other by -b per unit of the parameter. For a = 0 (pitchfork) the second one turns, y^2 =
/// -g_ys s / c, at the rate -2 b times the sign of g_ys: c < 0 is supercritical, with what is born where the other one
/// is unstable.
///
/// The point itself is refined: F + zeta b = 0, g_y = 0, g_s = 0 are N + 2 equations for the N + 2 unknowns u, zeta and
/// p. So the centre of the bifurcation is found where errors of a mesh make an imperfect one of it, which zeta
/// balances, and the place of the label along the branch adds no error (G. Moore, The numerical treatment of
/// non-trivial bifurcation points, Numer. Funct. Anal. Optim. 2, 1980).
#pragma once

#include <optional>

#include "orbit/orbit.hpp"
#include "stability/multilinear.hpp"

namespace tchat {

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
  /// Newton's step from that point to F + zeta b = 0 with these changes of y and p: the largest change in u.
  virtual double find_step(double y, double s) = 0;
  /// That step; x is the orbit of reduce().
  virtual void move(Orbit& x) const = 0;
  virtual double parameter(const Orbit& x) const = 0;
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

}  // namespace tchat
