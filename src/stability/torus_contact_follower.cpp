#include "stability/torus_contact_follower.hpp"

#include <algorithm>
#include <cmath>

#include "orbit/torus_system.hpp"

namespace tchat {

namespace {

constexpr int most_steps = 30;
/// Of |h_x| |f|: h falls towards an end of the segment, or is stationary there.
constexpr double falls_to_end = 1e-6;

}  // namespace

TorusContactFollower::TorusContactFollower(const TorusSystem& system, const OrbitShape& shape, int segment, int event)
    : system_(system),
      segment_(segment),
      event_(event),
      field_(system.signature()[static_cast<std::size_t>(segment)].field),
      weights_(system.orbits()),
      slopes_(system.orbits()),
      basis_(shape.collocation + 1),
      basis_slopes_(shape.collocation + 1),
      start_basis_(Eigen::VectorXd::Unit(shape.collocation + 1, 0)),
      u_(shape.dimension),
      f_(shape.dimension),
      hx_(shape.dimension),
      curvature_(shape.dimension),
      fxf_(shape.dimension),
      by_phase_(shape.dimension),
      fx_(shape.dimension, shape.dimension),
      y_(static_cast<std::size_t>(shape.dimension)),
      stepper_(boost::numeric::odeint::make_controlled<boost::numeric::odeint::runge_kutta_fehlberg78<State>>(1e-14,
                                                                                                              1e-13)) {}

void TorusContactFollower::find_place(const Orbit& x, const CollocationRule& rule, double tau) {
  // Just before a mesh point it is that one which tells most: Newton's step on the time does the rest.
  constexpr double just_before = 1e-6;
  const auto beyond = std::upper_bound(x.mesh.begin(), x.mesh.end() - 1, tau + just_before);
  interval_ = static_cast<int>(std::max<std::ptrdiff_t>(beyond - x.mesh.begin() - 1, 0));
  const double left = x.mesh[static_cast<std::size_t>(interval_)];
  const double right = x.mesh[static_cast<std::size_t>(interval_ + 1)];
  rule.basis((tau - left) / (right - left), basis_.data(), basis_slopes_.data());
}

/// `turns` times w and the sum over orbits l and nodes of weights * basis * (node - w l / N).
void TorusContactFollower::state_of(const Orbit& x, const Eigen::RowVectorXd& weights, const Eigen::VectorXd& basis,
                                    double turns, Eigen::VectorXd& u) const {
  u.setZero();
  double phase = 0.0;
  for (int l = 0; l < system_.orbits(); ++l) {
    const int first =
        (l * system_.segments_per_return() + segment_) * x.shape.nodes() + interval_ * x.shape.collocation;
    for (int k = 0; k < basis.size(); ++k) u += weights(l) * basis(k) * x.states.col(first + k);
    phase += weights(l) * l / system_.orbits();
  }
  u += (turns - phase) * system_.winding().curve;
}

double TorusContactFollower::duration_of(const Orbit& x) const {
  double duration = 0.0;
  for (int l = 0; l < system_.orbits(); ++l)
    duration += weights_(l) * x.duration(l * system_.segments_per_return() + segment_);
  return duration;
}

/// h_x f and its derivative along the flow; hx_ and f_ there.
bool TorusContactFollower::rate_at(const double* u, const double* par, double& rate, double& rate_slope) {
  const HybridSystem& system = system_.system();
  double h = 0.0;
  system.first(FunctionKind::event, event_, u, par, {}, &h, hx_.data(), nullptr);
  system.first(FunctionKind::field, field_, u, par, {}, f_.data(), fx_.data(), nullptr);
  system.second(FunctionKind::event, event_, u, par, {}, f_.data(), &rate, curvature_.data(), nullptr);
  fxf_.noalias() = fx_ * f_;
  rate_slope = curvature_.dot(f_) + hx_.dot(fxf_);
  return std::isfinite(rate) && std::isfinite(rate_slope);
}

bool TorusContactFollower::find_least_time(const Orbit& x, const CollocationRule& rule, double phi, double& tau) {
  const double duration = duration_of(x);
  double rate = 0.0, rate_slope = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    find_place(x, rule, tau);
    state_of(x, weights_, basis_, phi, u_);
    if (!rate_at(u_.data(), x.par.data(), rate, rate_slope) || !(rate_slope > 0.0)) return false;
    const double change = -rate / rate_slope / duration;
    tau += change;
    if (!(tau > 0.0 && tau < 1.0)) return false;
    if (std::abs(change) < 1e-10) return true;
  }
  return false;
}

bool TorusContactFollower::flow(const Orbit& x, double time) {
  constexpr int most_trials = 2000;  // of steps; the part of one mesh interval takes some ten
  std::copy_n(u_.data(), u_.size(), y_.begin());
  const HybridSystem& system = system_.system();
  const double* par = x.par.data();
  const auto rhs = [&system, par, this](const State& y, State& dydt, double) {
    system.value(FunctionKind::field, field_, y.data(), par, dydt.data());
  };
  double t = 0.0;
  double dt = time;
  for (int trial = 0; t < time; ++trial) {
    if (trial == most_trials) return false;
    dt = std::min(dt, time - t);
    stepper_.try_step(rhs, y_, t, dt);
  }
  std::copy_n(y_.begin(), u_.size(), u_.data());
  return u_.allFinite();
}

bool TorusContactFollower::polish(const Orbit& x, double phi, double tau, TorusContact& contact) {
  const double duration = duration_of(x);
  const double left = x.mesh[static_cast<std::size_t>(interval_)];
  state_of(x, weights_, start_basis_, phi, u_);
  if (!flow(x, (tau - left) * duration)) state_of(x, weights_, basis_, phi, u_);
  double rate = 0.0, rate_slope = 0.0;
  if (!rate_at(u_.data(), x.par.data(), rate, rate_slope) || !(rate_slope > 0.0)) return false;
  const double correction = -rate / rate_slope;
  contact.value = system_.system().event(event_, u_.data(), x.par.data()) + 0.5 * rate * correction;
  contact.state = u_;
  contact.state += correction * f_;
  contact.tau = tau + correction / duration;
  return contact.tau > 0.0 && contact.tau < 1.0;
}

bool TorusContactFollower::at(const Orbit& x, const CollocationRule& rule, double phi, TorusContact& contact,
                              double& slope) {
  set_interpolation_weights(phi, 0, weights_);
  set_interpolation_weights(phi, 1, slopes_);
  contact.phi = phi;
  if (contact.tau > 0.0 && contact.tau < 1.0) {
    double tau = contact.tau;
    if (!find_least_time(x, rule, phi, tau) || !polish(x, phi, tau, contact)) return false;
  } else {
    find_place(x, rule, contact.tau);
    state_of(x, weights_, basis_, phi, u_);
    double rate = 0.0, rate_slope = 0.0;
    if (!rate_at(u_.data(), x.par.data(), rate, rate_slope)) return false;
    const double towards = contact.tau > 0.0 ? rate : -rate;
    if (towards > falls_to_end * hx_.norm() * f_.norm()) return false;
    contact.value = system_.system().event(event_, u_.data(), x.par.data());
    contact.state = u_;
  }
  find_place(x, rule, contact.tau);
  state_of(x, slopes_, basis_, 1.0, by_phase_);
  double h = 0.0;
  system_.system().first(FunctionKind::event, event_, contact.state.data(), x.par.data(), {}, &h, hx_.data(), nullptr);
  slope = hx_.dot(by_phase_);
  return std::isfinite(slope) && std::isfinite(contact.value);
}

void TorusContactFollower::take_place(const Orbit& x, const CollocationRule& rule, const TorusContact& contact) {
  set_interpolation_weights(contact.phi, 0, weights_);
  find_place(x, rule, contact.tau);
}

bool TorusContactFollower::follow(const Orbit& x, const CollocationRule& rule, TorusContact& contact) {
  const double reach = 1.0 / system_.orbits();
  const double begin = contact.phi;
  double before = begin - 1e-4 * reach, phi = begin;
  double slope_before = 0.0, slope = 0.0, change = reach;
  if (!at(x, rule, before, contact, slope_before) || !at(x, rule, phi, contact, slope)) return false;
  for (int step = 0; step < most_steps; ++step) {
    const double second = (slope - slope_before) / (phi - before);
    // Of phases close together the slopes differ by rounding.
    if (!(second > 0.0)) return std::abs(change) < 1e-6 * reach;
    change = std::clamp(-slope / second, -0.25 * reach, 0.25 * reach);
    if (std::abs(change) < 1e-8 * reach) break;  // the value does not see it
    before = phi;
    slope_before = slope;
    phi += change;
    if (std::abs(phi - begin) > reach || !at(x, rule, phi, contact, slope)) return false;
  }
  contact.phi -= std::floor(contact.phi);
  return true;
}

}  // namespace tchat
