#include "maps/grazing_point.hpp"

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of states and of |h_x| |x|: what is left of h_D and h_P at a state that has been corrected, with room to spare.
constexpr double on_surfaces = level::orbit;
/// Of |h_{P,x}| |f|: an a* below this is zero.
constexpr double no_minimum = level::orbit;
/// Of the sizes of what is compared.
constexpr double same_state = level::differences;

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

VectorXd sizes_of(const HybridSystem& system, const GrazingPoint& at) {
  return sizes_at(system, at.field, at.x, at.par);
}

/// The jump is the identity where h_D = h_P = 0: at x*, and to first order beside it.
void require_identity_at_contact(const HybridSystem& system, const GrazingPoint& at, const VectorXd& after,
                                 const MatrixXd& gx, const std::string& source) {
  const double moved = length_in_sizes(after - at.x, sizes_of(system, at));
  const Eigen::Index n = at.x.size();
  MatrixXd rows(2, n);
  rows.row(0) = at.event_gradient.normalized().transpose();
  rows.row(1) = at.section_gradient.normalized().transpose();
  const MatrixXd change = gx - identity_of(system, at.field);
  // (g_x - Id) t = 0 for t with h_{D,x} t = h_{P,x} t = 0: each row of g_x - Id is a sum of the two gradients.
  const MatrixXd shares = least_squares(rows.transpose(), change.transpose());
  const double beside = (change.transpose() - rows.transpose() * shares).lpNorm<Eigen::Infinity>();
  if (moved <= same_state && beside <= level::located * (1.0 + gx.lpNorm<Eigen::Infinity>())) return;
  throw UserError(
      fmt::format("{}: {} changes states in grazing contact (by {:.2g} of their sizes): the discontinuity map belongs "
                  "to jumps that leave them as they are, as an impact of velocity zero does; name another one with "
                  "--jump",
                  source, named(system, FunctionKind::jump, at.jump), moved > same_state ? moved : beside));
}

/// g_x (Id - f h_x / (h_x f)) of a segment of no duration at x*.
MatrixXd short_segment(const HybridSystem& system, const IndexVector& v, const GrazingPoint& at,
                       const std::string& source) {
  const Eigen::Index n = at.x.size();
  const EventAt event = event_at(system, v.event, v.field, at.x.data(), at.par.data());
  const auto [after, gx] = jump_at(system, v.jump, at.x.data(), at.par.data());
  const VectorXd sizes = sizes_of(system, at);
  const bool is_empty = std::abs(event.h) <= on_surfaces * event.scale(at.x.data(), sizes) &&
                        length_in_sizes(after - at.x, sizes) <= same_state;
  if (!is_empty || !(std::abs(event.rate()) > no_minimum * event.rate_scale(sizes)))
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
  const VectorXd sizes = sizes_of(system, at);
  const double of_h = surface_scale(at.event_gradient, at.x.data(), sizes);
  const double of_rate = surface_scale(at.section_gradient, at.x.data(), sizes);
  if (std::abs(h) <= on_surfaces * of_h && std::abs(rate) <= on_surfaces * of_rate) return;
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
  constexpr double small = std::numeric_limits<double>::epsilon();
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
    const double moved = step.norm(), size = std::max(x.norm(), x0.norm());
    if (!std::isfinite(moved)) break;
    if (moved <= small * size || (moved <= level::negligible * size && moved >= 0.5 * last)) return x;
    last = moved;
  }
  throw UserError(
      fmt::format("{}: Newton's method finds no state with h_D = h_P = 0 of {} near this one; give a "
                  "nearer one",
                  source, named(system, FunctionKind::event, event)));
}

namespace {

using State = std::vector<double>;

constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr double stalled = level::negligible;  // of the time: Newton's steps that are no longer halved stop there

/// The integral over s from 0 to 1 of `gradient(s d)` . d, or of a matrix times d: what a function changes from x* to
/// x* + d.
template <class Value, class Function>
Value change_along(const VectorXd& d, const Value& zero, const Function& at) {
  using Rule = boost::math::quadrature::gauss<double, 7>;
  const auto& nodes = Rule::abscissa();
  const auto& weights = Rule::weights();
  Value sum = zero;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    sum += 0.5 * weights[i] * at(0.5 * (1.0 + nodes[i]) * d);
    if (nodes[i] != 0.0) sum += 0.5 * weights[i] * at(0.5 * (1.0 - nodes[i]) * d);
  }
  return sum;
}

}  // namespace

/// z = (d, u, w, Phi): toward h_P = 0 or a height of h_D, u = h_D and w = h_P less what they are at the start or not;
/// toward a section u is its function. Phi, n x n, is there where it is variational.
struct LocalFlow::Motion {
  State z;
  const CrossSection* section;
  bool variational;
  Eigen::Index n;

  Eigen::Map<VectorXd> d() { return {z.data(), n}; }
  double& u() { return z[static_cast<std::size_t>(n)]; }
  double& w() { return z[static_cast<std::size_t>(n) + 1]; }
  Eigen::Map<const MatrixXd> phi() const { return {z.data() + n + 2, n, n}; }
};

LocalFlow::LocalFlow(const HybridSystem& system, const IndexVector& contact, const VectorXd& x_star,
                     const ParameterVector& base, const ParameterVector& par)
    : system_(system),
      contact_(contact),
      x_star_(x_star),
      base_(base),
      par_(par),
      is_at_base_(par == base),
      surface_(system.dimension(), 0),
      x_(x_star),
      f_(x_star.size()),
      g_(x_star.size()),
      fx_(x_star.size(), x_star.size()),
      jump_offset_(VectorXd::Zero(x_star.size())) {
  if (is_at_base_) return;
  surface_.evaluate(system, contact, x_star.data(), base.data(), {});
  height_offset_ = -surface_.h;
  rate_offset_ = -surface_.rate;
  surface_.evaluate(system, contact, x_star.data(), par.data(), {});
  height_offset_ += surface_.h;
  rate_offset_ += surface_.rate;
  system.value(FunctionKind::jump, contact.jump, x_star.data(), par.data(), jump_offset_.data());
  system.value(FunctionKind::jump, contact.jump, x_star.data(), base.data(), g_.data());
  jump_offset_ -= g_;
}

VectorXd LocalFlow::height_gradient(const VectorXd& d) {
  return event_at(system_, contact_.event, contact_.field, state(d).data(), par_.data()).gradient;
}

double LocalFlow::height(const VectorXd& d) {
  return height_offset_ + change_along(d, 0.0, [&](const VectorXd& at) { return height_gradient(at).dot(d); });
}

double LocalFlow::rate(const VectorXd& d) {
  return rate_offset_ + change_along(d, 0.0, [&](const VectorXd& at) {
           surface_.evaluate(system_, contact_, state(at).data(), par_.data(), {});
           return surface_.rate_x.dot(d);
         });
}

double LocalFlow::acceleration(const VectorXd& d) {
  surface_.evaluate(system_, contact_, state(d).data(), par_.data(), {});
  return surface_.rate_x.dot(field(d));
}

VectorXd LocalFlow::field(const VectorXd& d) {
  VectorXd f(d.size());
  system_.value(FunctionKind::field, contact_.field, state(d).data(), par_.data(), f.data());
  return f;
}

VectorXd LocalFlow::section_gradient(const CrossSection& section, const VectorXd& d) {
  if (section.event == 0) return VectorXd::Unit(d.size(), section.state - 1);
  return event_at(system_, section.event, contact_.field, state(d).data(), par_.data()).gradient;
}

double LocalFlow::section(const CrossSection& section, const VectorXd& d) {
  if (section.event == 0) return d(section.state - 1);
  const double offset = is_at_base_ ? 0.0
                                    : system_.event(section.event, x_star_.data(), par_.data()) -
                                          system_.event(section.event, x_star_.data(), base_.data());
  return offset + change_along(d, 0.0, [&](const VectorXd& at) { return section_gradient(section, at).dot(d); });
}

VectorXd LocalFlow::jumped(const VectorXd& d, MatrixXd* derivative) {
  const auto slope = [&](const VectorXd& at) -> const MatrixXd& {
    system_.first(FunctionKind::jump, contact_.jump, state(at).data(), par_.data(), {}, g_.data(), fx_.data(), nullptr);
    return fx_;
  };
  if (derivative != nullptr) *derivative = slope(d) * *derivative;
  const VectorXd zero = jump_offset_;
  return change_along(d, zero, [&](const VectorXd& at) -> VectorXd { return slope(at) * d; });
}

LocalFlow::Motion LocalFlow::motion(const VectorXd& d, const CrossSection* section, bool variational) const {
  const auto n = static_cast<std::size_t>(d.size());
  Motion result{State(n + 2 + (variational ? n * n : 0), 0.0), section, variational, d.size()};
  result.d() = d;
  if (variational)
    for (std::size_t i = 0; i < n; ++i) result.z[n + 2 + i * (n + 1)] = 1.0;
  return result;
}

void LocalFlow::slopes(const Motion& motion, const State& z, State& out) {
  const Eigen::Index n = motion.n;
  x_ = x_star_ + Eigen::Map<const VectorXd>(z.data(), n);
  if (motion.variational) {
    system_.first(FunctionKind::field, contact_.field, x_.data(), par_.data(), {}, f_.data(), fx_.data(), nullptr);
    Eigen::Map<MatrixXd>(out.data() + n + 2, n, n).noalias() = fx_ * Eigen::Map<const MatrixXd>(z.data() + n + 2, n, n);
  } else {
    system_.value(FunctionKind::field, contact_.field, x_.data(), par_.data(), f_.data());
  }
  std::copy_n(f_.data(), n, out.begin());
  double& du = out[static_cast<std::size_t>(n)];
  double& dw = out[static_cast<std::size_t>(n) + 1];
  if (motion.section == nullptr) {
    surface_.evaluate(system_, contact_, x_.data(), par_.data(), {});
    du = z[static_cast<std::size_t>(n) + 1];
    dw = surface_.rate_x.dot(f_);
    return;
  }
  dw = 0.0;
  if (motion.section->event == 0) {
    du = f_(motion.section->state - 1);
    return;
  }
  double h = 0.0;
  system_.first(FunctionKind::event, motion.section->event, x_.data(), par_.data(), {}, &h, g_.data(), nullptr);
  du = g_.dot(f_);
}

/// Steps of equal length, halved until the embedded error estimate of each is at rounding level.
bool LocalFlow::follow(Motion& motion, double time) {
  constexpr double accuracy = 8.0 * rounding;
  constexpr double variational_accuracy = level::rounding_of_sums;
  constexpr double most_steps = 65536.0;
  if (time == 0.0) return true;
  if (!std::isfinite(time)) return false;
  boost::numeric::odeint::runge_kutta_fehlberg78<State> stepper;
  const auto rhs = [&](const State& z, State& out, double) { slopes(motion, z, out); };
  const auto n = static_cast<std::size_t>(motion.n);
  State after(motion.z.size()), error(motion.z.size()), slope(motion.z.size());
  const auto size = [&](const State& z, std::size_t from, std::size_t count) {
    return Eigen::Map<const VectorXd>(z.data() + from, static_cast<Eigen::Index>(count)).norm();
  };
  double steps = 1.0;
  for (double done = 0.0; done < steps;) {
    const double h = time / steps;
    stepper.do_step(rhs, motion.z, 0.0, after, h, error);
    rhs(motion.z, slope, 0.0);
    // Each against what it changes by in the step: the integral of a small rate is small.
    const double rates = std::max(std::abs(motion.z[n + 1]), std::abs(after[n + 1]));
    const double level = motion.section == nullptr ? rates : std::abs(slope[n]);
    const bool is_accurate = size(error, 0, n) <= accuracy * std::abs(h) * size(slope, 0, n) &&
                             std::abs(error[n]) <= accuracy * std::abs(h) * level &&
                             std::abs(error[n + 1]) <= accuracy * std::abs(h * slope[n + 1]) &&
                             size(error, n + 2, error.size() - n - 2) <= variational_accuracy;
    if (is_accurate) {
      motion.z.swap(after);
      done += 1.0;
      continue;
    }
    steps *= 2.0;
    done *= 2.0;
    if (steps > most_steps) return false;
  }
  return true;
}

/// The derivative of the flow to the surface with this gradient at the end of the motion: (Id - f s_x / (s_x f)) Phi.
void LocalFlow::change(const Motion& motion, const VectorXd& gradient, MatrixXd& derivative) {
  const VectorXd f = field(Eigen::Map<const VectorXd>(motion.z.data(), motion.n));
  derivative = project_along_flow(f, gradient, motion.phi() * derivative);
}

bool LocalFlow::to_height(VectorXd& d, double y, MatrixXd* derivative) {
  constexpr int most_iterations = 30;
  Motion motion = this->motion(d, nullptr, derivative != nullptr);
  double t = 0.0;
  if (y != 0.0) {
    const double a = acceleration(d);
    if (!(a > 0.0)) return false;
    double step = -y * std::sqrt(2.0 / a);
    double last = INFINITY;
    for (int iteration = 0;; ++iteration) {
      if (iteration == most_iterations || !follow(motion, step)) return false;
      t += step;
      // With u = h_D less its start, sqrt(u) with the sign of -t is y; its slope is that of t / |t| w / (2 sqrt(u)).
      const double u = motion.u();
      if (!(u > 0.0) || !(motion.w() * t > 0.0) || t * y > 0.0) return false;
      const double root = std::sqrt(u);
      step = (y - std::copysign(root, y)) * 2.0 * root / (std::copysign(1.0, y) * motion.w());
      if (!std::isfinite(step)) return false;
      if (std::abs(step) <= 2.0 * rounding * std::abs(t)) break;
      if (iteration > 3 && std::abs(step) >= 0.5 * last) {
        if (std::abs(step) <= stalled * std::abs(t)) break;
        return false;
      }
      last = std::abs(step);
    }
  }
  d = motion.d();
  if (derivative != nullptr) change(motion, height_gradient(d), *derivative);
  return d.allFinite();
}

/// Newton's method on the time, for the zero of w (h_P) or, toward a section, of u.
bool LocalFlow::to_zero(Motion& motion) {
  constexpr int most_iterations = 30;
  State slope(motion.z.size());
  double last = INFINITY;
  double t = 0.0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const auto at = static_cast<std::size_t>(motion.n) + (motion.section == nullptr ? 1 : 0);
    slopes(motion, motion.z, slope);
    const double step = -motion.z[at] / slope[at];
    if (!std::isfinite(step)) return false;
    if (std::abs(step) <= rounding * std::abs(t)) return true;
    if (iteration > 3 && std::abs(step) >= 0.5 * last)
      return std::abs(step) * f_.norm() <= stalled * (std::abs(t) * f_.norm() + motion.d().norm());
    if (!follow(motion, step)) return false;
    t += step;
    last = std::abs(step);
  }
  return false;
}

bool LocalFlow::to_least_height(VectorXd& d, MatrixXd* derivative) {
  Motion motion = this->motion(d, nullptr, derivative != nullptr);
  motion.w() = rate(d);
  if (!to_zero(motion) || !(acceleration(motion.d()) > 0.0)) return false;
  d = motion.d();
  if (derivative != nullptr) {
    surface_.evaluate(system_, contact_, state(d).data(), par_.data(), {});
    const VectorXd gradient = surface_.rate_x;
    change(motion, gradient, *derivative);
  }
  return d.allFinite();
}

bool LocalFlow::to_section(VectorXd& d, const CrossSection& section, MatrixXd* derivative) {
  Motion motion = this->motion(d, &section, derivative != nullptr);
  motion.u() = this->section(section, d);
  if (!to_zero(motion)) return false;
  d = motion.d();
  if (derivative != nullptr) change(motion, section_gradient(section, d), *derivative);
  return d.allFinite();
}

}  // namespace tchat
