#include "stability/torus_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/event_minima.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

namespace {

Signature one_return_of(const TorusSystem& system) {
  return {system.signature().begin(), system.signature().begin() + system.segments_per_return()};
}

double whole_turns_off(double phi) { return phi - std::floor(phi); }

}  // namespace

TorusContactSearch::TorusContactSearch(const TorusSystem& system, int segment, int event)
    : system_(system), one_return_(system.system(), one_return_of(system), {}), segment_(segment), event_(event) {}

std::optional<TorusContact> TorusContactSearch::at(const Orbit& x, const CollocationRule& rule, double phi) const {
  const auto contact = least_value(one_return_, rule, return_at(system_, x, phi), segment_, event_);
  if (!contact) return std::nullopt;
  return TorusContact{whole_turns_off(phi), contact->tau, contact->value, contact->state};
}

std::optional<TorusContact> TorusContactSearch::least_near(const Orbit& x, const CollocationRule& rule,
                                                           double phi) const {
  const double reach = 1.0 / system_.orbits();
  constexpr int bits = 40;  // of phi; a minimum is known to half the digits of its value
  const auto value = [&](double t) {
    const auto contact = at(x, rule, t);
    return contact ? contact->value : std::numeric_limits<double>::max();
  };
  std::uintmax_t iterations = 60;
  const auto [least_phi, least] =
      boost::math::tools::brent_find_minima(value, phi - reach, phi + reach, bits, iterations);
  return at(x, rule, stationary(x, rule, least_phi));
}

/// A minimum is known to half the digits of its value: where h_x x_phi changes sign close to it, that says it better.
double TorusContactSearch::stationary(const Orbit& x, const CollocationRule& rule, double phi) const {
  const double reach = 1e-3 / system_.orbits();
  const double low = slope(x, rule, phi - reach);
  const double high = slope(x, rule, phi + reach);
  if (!(low < 0.0 && high > 0.0)) return phi;
  std::uintmax_t iterations = 30;
  const auto bracket =
      boost::math::tools::toms748_solve([&](double t) { return slope(x, rule, t); }, phi - reach, phi + reach, low,
                                        high, boost::math::tools::eps_tolerance<double>(45), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

/// h_x x_phi at the least value of h on the orbit of phase phi; 0 without one.
double TorusContactSearch::slope(const Orbit& x, const CollocationRule& rule, double phi) const {
  const auto contact = at(x, rule, phi);
  if (!contact) return 0.0;
  const Orbit derivative = return_at(system_, x, phi, 1);
  const auto [interval, weights] = node_weights(x, rule, contact->tau);
  const int first = segment_ * x.shape.nodes() + interval * x.shape.collocation;
  const Eigen::VectorXd by_phase = derivative.states.middleCols(first, weights.size()) * weights;
  return event_at(system_.system(), event_, contact->state.data(), x.par.data()).gradient.dot(by_phase);
}

std::optional<TorusContact> TorusContactSearch::least(const Orbit& x, const CollocationRule& rule) const {
  const int n = system_.orbits();
  constexpr double none = std::numeric_limits<double>::max();
  std::vector<double> values(static_cast<std::size_t>(n), none);
  for (int i = 0; i < n; ++i)
    if (const auto contact = least_value(system_, rule, x, i * system_.segments_per_return() + segment_, event_))
      values[static_cast<std::size_t>(i)] = contact->value;
  const double lowest = *std::min_element(values.begin(), values.end());

  // Every orbit that is lower than its neighbours, and may have the least value between them. There are several where
  // the torus is lowest near the section: at the end of some returns and, a little lower, at the start of the next.
  std::optional<TorusContact> least;
  for (int i = 0; i < n; ++i) {
    const double value = values[static_cast<std::size_t>(i)];
    const double neighbours[] = {values[static_cast<std::size_t>((i + n - 1) % n)],
                                 values[static_cast<std::size_t>((i + 1) % n)]};
    const double higher = std::max(neighbours[0], neighbours[1]);
    if (value == none || value > std::min(neighbours[0], neighbours[1])) continue;
    if (higher < none && value - (higher - value) > lowest) continue;
    const auto contact = least_near(x, rule, static_cast<double>(i) / n);
    if (contact && (!least || contact->value < least->value)) least = contact;
  }
  return least;
}

TorusContactTest::TorusContactTest(const TorusSystem& system, int segment, int event, bool stop)
    : system_(system), search_(system, segment, event), stop_(stop) {}

std::string TorusContactTest::name() const {
  const std::string where = system_.segments_per_return() > 1 ? fmt::format(", segment {}", search_.segment() + 1) : "";
  return fmt::format("least h{} on the torus{}", search_.event(), where);
}

TestValue TorusContactTest::evaluate(const TestedPoint& point) const {
  const auto contact = search_.least(point.orbit, point.condensed.rule());
  if (!contact) return TestValue::undefined();
  return TestValue::of(contact->value, orbit_accuracy * event_scale(system_.system(), point.orbit, search_.event()));
}

SpecialPoint TorusContactTest::classify(const TestedPoint& point, bool rising) const {
  const auto contact = search_.least(point.orbit, point.condensed.rule());
  const int event = search_.event();
  const std::string name = system_.system().function_name(FunctionKind::event, event);
  SpecialPoint special{PointType::user,
                       {UserPointKind::contact, search_.segment() + 1, event, contact ? contact->tau : 0.0},
                       stop_ && !rising,
                       fmt::format("grazing: the torus touches event {} ({})", event, name)};
  if (contact)
    special.description += fmt::format(" at phi = {:.8g}, tau = {:.8g}, {}", contact->phi, contact->tau,
                                       state_text(system_.system(), point.orbit, contact->state.data()));
  return special;
}

std::string StrongResonanceTest::name() const { return fmt::format("rho - {}/{}", p_, q_); }

TestValue StrongResonanceTest::evaluate(const TestedPoint& point) const {
  return TestValue::of(TorusSystem::rotation(point.orbit) - static_cast<double>(p_) / q_, orbit_accuracy);
}

SpecialPoint StrongResonanceTest::classify(const TestedPoint&, bool) const {
  constexpr std::array types{PointType::resonance_1, PointType::resonance_2, PointType::resonance_3,
                             PointType::resonance_4};
  return {
      types[static_cast<std::size_t>(q_ - 1)],
      {},
      false,
      fmt::format("strong resonance: the rotation number passes {}/{}; near it the motion on the torus may lock to a "
                  "periodic orbit of {} return{}, and the torus break",
                  p_, q_, q_, q_ == 1 ? "" : "s")};
}

namespace {

constexpr int most_steps = 30;
/// Of |h_x| |f|: h falls towards an end of the segment, or is stationary there.
constexpr double falls_to_end = level::located;

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
      stepper_(boost::numeric::odeint::make_controlled<boost::numeric::odeint::runge_kutta_fehlberg78<State>>(
          level::reference_flow.absolute, level::reference_flow.relative)) {}

void TorusContactFollower::find_place(const Orbit& x, const CollocationRule& rule, double tau) {
  // Just before a mesh point it is that one which tells most: Newton's step on the time does the rest.
  constexpr double just_before = level::located;
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
    if (std::abs(change) < level::converged) return true;
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
    if (!(second > 0.0)) return std::abs(change) < level::stalled * reach;
    change = std::clamp(-slope / second, -0.25 * reach, 0.25 * reach);
    if (std::abs(change) < level::differences * reach) break;  // the value does not see it
    before = phi;
    slope_before = slope;
    phi += change;
    if (std::abs(phi - begin) > reach || !at(x, rule, phi, contact, slope)) return false;
  }
  contact.phi -= std::floor(contact.phi);
  return true;
}

TorusContactCondition::TorusContactCondition(const TorusSystem& system, const OrbitShape& shape, int segment, int event)
    : system_(system),
      search_(system, segment, event),
      follower_(system, shape, segment, event),
      gradient_(shape, system.free_count()) {}

/// From where it was; where that leads nowhere, by a search.
bool TorusContactCondition::find(const CollocationRule& rule, const Orbit& x) {
  const double phi = contact_.phi;
  if (started_ && follower_.follow(x, rule, contact_)) return true;
  const auto found = started_ ? search_.least_near(x, rule, phi) : search_.least(x, rule);
  if (!found || !std::isfinite(found->value)) return false;
  contact_ = *found;
  started_ = true;
  follower_.take_place(x, rule, contact_);
  return true;
}

bool TorusContactCondition::evaluate(CondensedSystem& condensed, const Orbit& x) {
  if (!find(condensed.rule(), x)) return false;
  gradient_.set_zero();
  double h = 0.0;
  Eigen::VectorXd& hx = gradient_at_contact_;
  hx.resize(x.shape.dimension);
  system_.system().first(FunctionKind::event, search_.event(), contact_.state.data(), x.par.data(),
                         system_.free_parameters(), &h, hx.data(), gradient_.globals.data());
  const Eigen::VectorXd& basis = follower_.node_weights();
  for (int l = 0; l < system_.orbits(); ++l) {
    const int segment = l * system_.segments_per_return() + search_.segment();
    const int first = segment * x.shape.nodes() + follower_.interval() * x.shape.collocation;
    for (int k = 0; k < basis.size(); ++k)
      gradient_.states.col(first + k) = follower_.phase_weights()(l) * basis(k) * hx;
  }
  return hx.allFinite() && gradient_.globals.allFinite();
}

void TorusContactCondition::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.push_back(contact_.phi);
  memory.push_back(contact_.tau);
}

void TorusContactCondition::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  contact_.phi = memory[0];
  contact_.tau = memory[1];
}

}  // namespace tchat
