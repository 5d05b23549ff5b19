#include "stability/torus_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "model/event_at.hpp"
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

}  // namespace tchat
