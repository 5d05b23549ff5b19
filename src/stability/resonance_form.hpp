/// Coefficients of normal forms where two multipliers are critical, or the first coefficient is zero: at the cusp and
/// at the strong resonances 1:1 to 1:4 (Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., ch. 9; Kuznetsov
/// and Meijer, SIAM J. Sci. Comput. 26, 2005).
///
/// With A, B, C the first three derivatives of the return map, complex products without conjugation:
///
///     cusp    A q = q, p A = p, p q = 1, |q| = 1:  (1 - A) h = B(q, q) - (p B(q, q)) q,
///             c = p (C(q,q,q) + 3 B(q,h)) / 6
///     1:1     A q = q, A q1 = q1 + q, p A = p, p1 A = p1 + p, p q1 = p1 q = 1, p1 q1 = 0, |q| = 1:
///             (x, y) -> (x + y, y + a x^2 + b x y),  a = p B(q,q) / 2,  b = p B(q,q1) + p1 B(q,q)
///     1:2     A q = -q, A q1 = -q1 + q, p A = -p, p1 A = -p1 + p, and so on:
///             (x, y) -> (-x + y, -y + c x^3 + d x^2 y),  h = (1-A)^-1 B(q,q),  k = (1-A)^-1 (B(q,q1) + h),
///             c = p (C(q,q,q) + 3 B(q,h)) / 6,
///             d = (p (C(q,q,q1) + 2 B(q,k) + B(q1,h)) + p1 (C(q,q,q) + 3 B(q,h))) / 2
///     1:3     A q = mu q, mu = e^(2 pi i / 3), |q| = 1:  z -> mu z + b z*^2 + c z |z|^2,  b = p B(q*,q*) / 2,
///             (mu* - A) h = B(q,q) - 2 b* q*,  c = p (C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)) + B(q*,h)) / 2;
///             what matters: |b1| = 3 |b|, and Re c1 of c1 = 3 mu^2 c - 3 |b|^2
///     1:4     A q = i q, |q| = 1:  z -> i z + c z |z|^2 + d z*^3,
///             c = p (C(q,q,q*) + 2 B(q,(1-A)^-1 B(q,q*)) + B(q*,h)) / 2,  (-1 - A) h = B(q,q),
///             d = p (C(q*,q*,q*) + 3 B(q*,h*)) / 6;  what matters: c1 = -4 i c and |d1| = 4 |d|
///
/// As in normal_form.hpp everything is done on the nodes of the whole orbit.
#pragma once

#include <optional>
#include <vector>

#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/point_type.hpp"
#include "stability/multilinear.hpp"

namespace tchat {

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
