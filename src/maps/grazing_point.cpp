#include "maps/grazing_point.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/user_error.hpp"
#include "linear/dense_matrix.hpp"
#include "model/event_at.hpp"
#include "model/mode_dimensions.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of states and of |h_x| |x|: what is left of h_D and h_P at a state that has been corrected, with room to spare.
constexpr double on_surfaces = 1e-9;
/// Of |h_{P,x}| |f|: an a* below this is zero.
constexpr double no_minimum = 1e-9;
/// Of the sizes of what is compared.
constexpr double same_state = 1e-8;

std::string named(const HybridSystem& system, FunctionKind kind, int index) {
  const char* const word = kind == FunctionKind::event ? "event" : kind == FunctionKind::jump ? "jump" : "field";
  return fmt::format("{} {} ({})", word, index, system.function_name(kind, index));
}

/// The identity on the states of the field's mode.
MatrixXd identity_of(const HybridSystem& system, int field) {
  MatrixXd unit = MatrixXd::Zero(system.dimension(), system.dimension());
  unit.diagonal().head(system.dimension_of(field)).setOnes();
  return unit;
}

/// The jump is the identity where h_D = h_P = 0: at x*, and to first order beside it.
void require_identity_at_contact(const HybridSystem& system, const GrazingPoint& at, const VectorXd& after,
                                 const MatrixXd& gx, const std::string& source) {
  const double moved = (after - at.x).lpNorm<Eigen::Infinity>();
  const Eigen::Index n = at.x.size();
  MatrixXd rows(2, n);
  rows.row(0) = at.event_gradient.normalized().transpose();
  rows.row(1) = at.section_gradient.normalized().transpose();
  const MatrixXd change = gx - identity_of(system, at.field);
  // (g_x - Id) t = 0 for t with h_{D,x} t = h_{P,x} t = 0: each row of g_x - Id is a sum of the two gradients.
  const MatrixXd shares = least_squares(rows.transpose(), change.transpose());
  const double beside = (change.transpose() - rows.transpose() * shares).lpNorm<Eigen::Infinity>();
  if (moved <= same_state * (1.0 + at.x.lpNorm<Eigen::Infinity>()) &&
      beside <= 1e-6 * (1.0 + gx.lpNorm<Eigen::Infinity>()))
    return;
  throw UserError(fmt::format(
      "{}: {} changes states in grazing contact (by {:.2g}): the discontinuity map belongs to jumps that leave them as "
      "they are, as an impact of velocity zero does; name another one with --jump",
      source, named(system, FunctionKind::jump, at.jump),
      moved > same_state * (1.0 + at.x.lpNorm<Eigen::Infinity>()) ? moved : beside));
}

/// g_x (Id - f h_x / (h_x f)) of a segment of no duration at x*.
MatrixXd short_segment(const HybridSystem& system, const IndexVector& v, const GrazingPoint& at,
                       const std::string& source) {
  const Eigen::Index n = at.x.size();
  const EventAt event = event_at(system, v.event, v.field, at.x.data(), at.par.data());
  const auto [after, gx] = jump_at(system, v.jump, at.x.data(), at.par.data());
  const bool is_empty = std::abs(event.h) <= on_surfaces * event.scale(at.x.data()) &&
                        (after - at.x).lpNorm<Eigen::Infinity>() <= same_state * (1.0 + at.x.norm());
  if (!is_empty || !(std::abs(event.rate()) > no_minimum * event.sizes()))
    throw UserError(fmt::format(
        "{}: after an impact of velocity zero segment {} ({}) follows, which {}: the discontinuity map belongs to "
        "impacts after which the flow goes on as before, at once or after a short slip",
        source, to_string({v}), system.function_name(FunctionKind::field, v.field),
        is_empty ? "leaves its surface tangentially" : "lasts"));
  return gx * event.project(MatrixXd::Identity(n, n));
}

/// After contact the flow goes on in the field of the contact, or first in those of the aftermath.
void require_modes(const HybridSystem& system, const GrazingPoint& at, const std::string& source) {
  Signature passed{{at.field, at.event, at.jump}};
  passed.insert(passed.end(), at.aftermath.begin(), at.aftermath.end());
  for (std::size_t s = 0; s < passed.size(); ++s) {
    const std::string fault = mode_fault(system, passed[s], passed[(s + 1) % passed.size()].field);
    if (!fault.empty()) throw UserError(fmt::format("{}: {}", source, fault));
  }
}

void require_minimum(const HybridSystem& system, const GrazingPoint& at, const std::string& source) {
  const double scale = at.section_gradient.norm() * at.f.norm();
  if (at.a > no_minimum * scale) return;
  const std::string event = named(system, FunctionKind::event, at.event);
  if (at.a < -no_minimum * scale)
    throw UserError(
        fmt::format("{}: a* = {:.6g} is negative, the function of {} has a maximum along the orbit at the contact, "
                    "not a minimum: the orbit comes from the forbidden side; choose another label or state",
                    source, at.a, event));
  throw UserError(fmt::format(
      "{}: a* = {:.2g} is zero to rounding, the function of {} has no simple minimum at the contact (codimension two): "
      "the discontinuity map has another form there; choose another label",
      source, at.a, event));
}

void require_on_surfaces(const HybridSystem& system, const GrazingPoint& at, double h, double rate,
                         const std::string& source) {
  const double scale = 1.0 + at.event_gradient.norm() * at.x.norm();
  const double speed = at.event_gradient.norm() * at.f.norm();
  if (std::abs(h) <= on_surfaces * scale && std::abs(rate) <= on_surfaces * (1.0 + speed)) return;
  throw UserError(fmt::format(
      "{}: the state is no grazing point of {}: h_D = {:.3e}, h_P = h_{{D,x}} f = {:.3e}, and both must be zero; "
      "--correct takes the nearest state where they are",
      source, named(system, FunctionKind::event, at.event), h, rate));
}

}  // namespace

bool GrazingPoint::has_square_root() const { return !impact.is_zero(); }

GrazingPoint grazing_point(const HybridSystem& system, int field, int event, int jump, const VectorXd& x,
                           const ParameterVector& par, const std::string& source, const Signature& aftermath) {
  const int n = system.dimension();
  GrazingPoint at{field, event, jump, aftermath, x, par, 0.0, VectorXd(n), {}, {}, {}, {}, {}};
  require_modes(system, at, source);
  SurfaceRate surface(n, 0);
  surface.evaluate(system, {field, event, jump}, x.data(), par.data(), {});
  system.value(FunctionKind::field, field, x.data(), par.data(), at.f.data());
  auto [after, gx] = jump_at(system, jump, x.data(), par.data());
  gx *= identity_of(system, field);
  at.event_gradient = surface.hx;
  at.section_gradient = surface.rate_x;
  at.a = at.section_gradient.dot(at.f);
  if (!(std::isfinite(surface.h) && std::isfinite(at.a) && gx.allFinite() && after.allFinite()))
    throw UserError(fmt::format("{}: a function has no finite value or derivative at the contact", source));
  require_on_surfaces(system, at, surface.h, surface.rate, source);
  require_minimum(system, at, source);
  if ((after - x).norm() == 0.0 && (gx - identity_of(system, field)).norm() == 0.0)
    throw UserError(fmt::format(
        "{}: {} is the identity, contact would have no effect; name the jump that it brings with --jump, or "
        "GRJUMP in the constants",
        source, named(system, FunctionKind::jump, jump)));
  require_identity_at_contact(system, at, after, gx, source);
  at.jump_derivative = gx;
  for (const IndexVector& v : aftermath) at.jump_derivative = short_segment(system, v, at, source) * at.jump_derivative;
  at.impact = impact_direction(at.f, at.section_gradient, at.jump_derivative);
  at.B = -std::sqrt(2.0 / at.a) * at.impact.beta;
  return at;
}

VectorXd corrected_contact(const HybridSystem& system, int field, int event, const VectorXd& x0,
                           const ParameterVector& par, const std::string& source) {
  constexpr int most_iterations = 30;
  constexpr double small = 1e-15;
  VectorXd x = x0;
  SurfaceRate surface(system.dimension(), 0);
  MatrixXd rows(2, x.size());
  double last = INFINITY;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    surface.evaluate(system, {field, event, no_function}, x.data(), par.data(), {});
    rows.row(0) = surface.hx.transpose();
    rows.row(1) = surface.rate_x.transpose();
    const VectorXd step = least_squares(rows, -Eigen::Vector2d(surface.h, surface.rate));
    x += step;
    const double size = step.norm() / (1.0 + x.norm());
    if (!std::isfinite(size)) break;
    if (size <= small || (size <= 1e-12 && size >= 0.5 * last)) return x;
    last = size;
  }
  throw UserError(
      fmt::format("{}: Newton's method finds no state with h_D = h_P = 0 of {} near this one; give a "
                  "nearer one",
                  source, named(system, FunctionKind::event, event)));
}

}  // namespace tchat
