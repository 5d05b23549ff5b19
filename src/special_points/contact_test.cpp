#include "special_points/contact_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "bvp/admissibility.hpp"
#include "bvp/no_duration.hpp"
#include "bvp/transversality.hpp"
#include "hybrid/event_at.hpp"
#include "special_points/bifurcation_tests.hpp"

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;

/// One event function along one segment's collocation polynomials.
class EventAlongSegment {
 public:
  EventAlongSegment(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s, int event)
      : defining_(system),
        rule_(rule),
        x_(x),
        s_(s),
        event_(event),
        values_(Vector::Constant(x.shape.nodes(), NAN)),
        gradients_(Eigen::MatrixXd::Constant(x.shape.dimension, x.shape.nodes(), NAN)),
        rate_(x.shape.dimension),
        slopes_at_nodes_(x.shape.collocation + 1, x.shape.collocation + 1) {
    for (int i = 0; i <= x.shape.collocation; ++i)
      slopes_at_nodes_.col(i) = basis_at(static_cast<double>(i) / x.shape.collocation).slopes;
    find_gradients();
  }

  double length(int j) const { return x_.mesh[static_cast<std::size_t>(j + 1)] - x_.mesh[static_cast<std::size_t>(j)]; }

  /// d h / d tau at sigma in [0, 1] of interval j, from the polynomial.
  double slope(int j, double sigma) const {
    const Basis basis = basis_at(sigma);
    return gradient(nodes(j) * basis.values).dot(nodes(j) * basis.slopes) / length(j);
  }

  /// The same at node i of the interval.
  double slope_at_node(int j, int i) {
    rate_.noalias() = nodes(j).lazyProduct(slopes_at_nodes_.col(i));
    return gradients_.col(j * x_.shape.collocation + i).dot(rate_) / length(j);
  }

  Contact at_node(int k) const {
    return {x_.tau(k), values_(k), Eigen::Map<const Vector>(x_.node(s_, k), x_.shape.dimension)};
  }

  /// The minimum near sigma of interval j, by the flow from the interval's left mesh point (by the polynomial where
  /// there is no flow); the small rest of h_x f there is removed by one Newton step on the time.
  Contact polished(int j, double sigma) const {
    const double time = sigma * length(j) * x_.duration(s_);
    Vector u = flow(x_.node(s_, j * x_.shape.collocation), time).value_or(nodes(j) * basis_at(sigma).values);
    const int n = x_.shape.dimension;
    const int field = defining_.signature()[static_cast<std::size_t>(s_)].field;
    Vector f(n);
    Eigen::MatrixXd fx(n, n);
    system().first(FunctionKind::field, field, u.data(), par(), {}, f.data(), fx.data(), nullptr);
    double rate = 0.0;  // h_x f
    Vector curvature(n);
    system().second(FunctionKind::event, event_, u.data(), par(), {}, f.data(), &rate, curvature.data(), nullptr);
    const double rate_slope = curvature.dot(f) + gradient(u).dot(fx * f);  // of h_x f along the flow
    const double to_zero = rate_slope > 0.0 ? -rate / rate_slope : 0.0;
    // Farther off than the segment lasts (one that vanishes, whose slopes are rounding) it is no minimum of its.
    const double correction = std::abs(to_zero) <= x_.duration(s_) ? to_zero : 0.0;
    const double value = system().event(event_, u.data(), par()) + 0.5 * rate * correction;
    u += correction * f;
    const double tau = x_.mesh[static_cast<std::size_t>(j)] + sigma * length(j) + correction / x_.duration(s_);
    return {snapped(tau), value, u};
  }

 private:
  /// All in one call; where one point spoils it for others (an exception makes all of them unknown), each on its own.
  void find_gradients() {
    const int nodes = x_.shape.nodes();
    system().first_at_points(FunctionKind::event, event_, nodes, x_.node(s_, 0), par(), {}, values_.data(),
                             gradients_.data(), nullptr);
    for (int k = 0; k < nodes; ++k)
      if (!std::isfinite(values_(k)) || !gradients_.col(k).allFinite())
        system().first(FunctionKind::event, event_, x_.node(s_, k), par(), {}, &values_(k), gradients_.col(k).data(),
                       nullptr);
  }

  const HybridSystem& system() const { return defining_.system(); }
  const double* par() const { return x_.par.data(); }

  /// A minimum on an end but for rounding is on it.
  static double snapped(double tau) {
    constexpr double rounding = 1e-12;
    if (tau < rounding) return 0.0;
    return tau > 1.0 - rounding ? 1.0 : tau;
  }

  Vector gradient(const Vector& u) const { return event_at(system(), event_, u.data(), par()).gradient; }

  /// Nothing where the flow cannot be integrated: the field has no value near the orbit, or is too stiff for an
  /// explicit method of this accuracy.
  std::optional<Vector> flow(const double* from, double time) const {
    namespace odeint = boost::numeric::odeint;
    using State = std::vector<double>;
    constexpr int most_trials = 2000;  // of steps; the part of one mesh interval takes some ten
    State u(from, from + x_.shape.dimension);
    const int field = defining_.signature()[static_cast<std::size_t>(s_)].field;
    const auto rhs = [&](const State& y, State& dydt, double) {
      system().value(FunctionKind::field, field, y.data(), par(), dydt.data());
    };
    auto stepper = odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-14, 1e-13);
    double t = 0.0;
    double dt = time;
    for (int trial = 0; t < time; ++trial) {
      if (trial == most_trials) return std::nullopt;
      dt = std::min(dt, time - t);
      stepper.try_step(rhs, u, t, dt);
    }
    const Vector end = Eigen::Map<const Vector>(u.data(), x_.shape.dimension);
    return end.allFinite() ? std::optional(end) : std::nullopt;
  }

  struct Basis {
    using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, CollocationRule::most_points + 1, 1>;
    Numbers values;
    Numbers slopes;
  };
  Basis basis_at(double sigma) const {
    Basis basis{Basis::Numbers(x_.shape.collocation + 1), Basis::Numbers(x_.shape.collocation + 1)};
    rule_.basis(sigma, basis.values.data(), basis.slopes.data());
    return basis;
  }

  /// The nodes of interval j, one a column.
  Eigen::MatrixXd::ConstColsBlockXpr nodes(int j) const {
    const int c = x_.shape.collocation;
    return x_.states.middleCols(s_ * x_.shape.nodes() + j * c, c + 1);
  }

  const DefiningSystem& defining_;
  const CollocationRule& rule_;
  const Orbit& x_;
  int s_;
  int event_;
  Vector values_;              // of h at the nodes
  Eigen::MatrixXd gradients_;  // a column for each node
  Vector rate_;
  Eigen::MatrixXd slopes_at_nodes_;  // of the basis, a column for each node
};

/// A place where h turns from falling to rising: inside interval j at sigma.
struct Minimum {
  int interval;
  double sigma;
};

/// All interior minima in order. `rises_before` and `falls_after` tell for the first and the last one whether h rises
/// anywhere before, falls anywhere after it: if not, the minimum hangs on the segment's end.
struct Minima {
  std::vector<Minimum> list;
  bool first_hangs_on_start = false;
  bool last_hangs_on_end = false;
};

Minima find_minima(EventAlongSegment& along, int intervals, int c) {
  Minima result;
  bool risen = false;
  double before = 0.0;
  for (int j = 0; j < intervals; ++j) {
    for (int i = 0; i <= c; ++i) {
      const double sigma = static_cast<double>(i) / c;
      const double slope = along.slope_at_node(j, i);
      const bool turns = before < 0.0 && slope >= 0.0;
      if (turns) {
        if (result.list.empty()) result.first_hangs_on_start = !risen;
        double at = sigma;
        if (i > 0 && slope > 0.0) {
          std::uintmax_t iterations = 50;
          const auto bracket = boost::math::tools::toms748_solve(
              [&](double t) { return along.slope(j, t); }, static_cast<double>(i - 1) / c, sigma, before, slope,
              boost::math::tools::eps_tolerance<double>(40), iterations);
          at = 0.5 * (bracket.first + bracket.second);
        }
        result.list.push_back({j, at});
        result.last_hangs_on_end = true;
      }
      if (slope < 0.0) result.last_hangs_on_end = false;
      risen = risen || slope > 0.0;
      before = slope;
    }
  }
  return result;
}

}  // namespace

std::vector<Contact> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s,
                                      int event) {
  EventAlongSegment along(system, rule, x, s, event);
  const bool start_pinned = is_pinned_start(system.system(), system.signature(), x, s, event);
  const bool end_pinned = system.signature()[static_cast<std::size_t>(s)].event == event;
  std::vector<Contact> candidates;
  if (!start_pinned) candidates.push_back(along.at_node(0));
  if (!end_pinned) candidates.push_back(along.at_node(x.shape.nodes() - 1));
  if (!(x.duration(s) > 0.0)) return candidates;
  const Minima minima = find_minima(along, x.shape.intervals, x.shape.collocation);
  for (std::size_t i = 0; i < minima.list.size(); ++i) {
    if (i == 0 && start_pinned && minima.first_hangs_on_start) continue;
    if (i + 1 == minima.list.size() && end_pinned && minima.last_hangs_on_end) continue;
    candidates.push_back(along.polished(minima.list[i].interval, minima.list[i].sigma));
  }
  return candidates;
}

std::optional<Contact> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s,
                                   int event) {
  const std::vector<Contact> candidates = least_candidates(system, rule, x, s, event);
  const auto least = std::min_element(candidates.begin(), candidates.end(),
                                      [](const Contact& a, const Contact& b) { return a.value < b.value; });
  if (least == candidates.end()) return std::nullopt;
  return *least;
}

ContactTest::ContactTest(const DefiningSystem& system, int segment, int event, bool stop)
    : system_(system), segment_(segment), event_(event), stop_(stop) {}

std::string ContactTest::name() const { return fmt::format("least h{} on segment {}", event_, segment_ + 1); }

TestValue ContactTest::evaluate(const TestedPoint& point) const {
  const auto contact = least_value(system_, point.condensed.rule(), point.orbit, segment_, event_);
  if (!contact) return TestValue::undefined(sign_without_minimum(point.orbit));
  return TestValue::of(contact->value, orbit_accuracy * event_scale(system_.system(), point.orbit, event_));
}

/// Between pinned ends h may rise and fall without a minimum in between: no contact, positive.
int ContactTest::sign_without_minimum(const Orbit& x) const {
  if (!(x.duration(segment_) > 0.0)) return 0;
  for (int k = 1; k + 1 < x.shape.nodes(); ++k)
    if (system_.system().event(event_, x.node(segment_, k), x.par.data()) > 0.0) return 1;
  return 0;
}

/// At an end of the segment h may pass zero with a slope: its surface is met there, where another event cuts the orbit.
bool ContactTest::crosses(const TestedPoint& point, const Contact& contact) const {
  if (contact.tau > 0.0 && contact.tau < 1.0) return false;
  const int field = system_.signature()[static_cast<std::size_t>(segment_)].field;
  const EventAt at = event_at(system_.system(), event_, field, contact.state.data(), point.orbit.par.data());
  return std::abs(at.rate()) > tangent_contact * at.sizes();
}

SpecialPoint ContactTest::vanishing_segment(bool ends_branch) const {
  const int own = system_.signature()[static_cast<std::size_t>(segment_)].event;
  const auto name = [this](int event) {
    return fmt::format("event {} ({})", event, system_.system().function_name(FunctionKind::event, event));
  };
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, 1.0},
          ends_branch,
          fmt::format("two events at once: segment {}, which ends in {}, has shrunk to T = 0{}", segment_ + 1,
                      name(own), own == event_ ? "" : " on the surface of " + name(event_))};
}

SpecialPoint ContactTest::classify(const TestedPoint& point, bool rising) const {
  const std::optional<Contact> contact = least_value(system_, point.condensed.rule(), point.orbit, segment_, event_);
  const bool ends_branch = stop_ && !rising;
  // Where the segment lasts no time every point of it is the contact.
  if (lasts_no_time(point.orbit, segment_)) return vanishing_segment(ends_branch);
  const std::string where = fmt::format("event {} ({}) inside segment {}", event_,
                                        system_.system().function_name(FunctionKind::event, event_), segment_ + 1);
  if (!contact)
    return {PointType::user,
            {UserPointKind::contact, segment_ + 1, event_, 0.0},
            ends_branch,
            "grazing: contact with " + where};
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, contact->tau},
          ends_branch,
          fmt::format("{} with {}, tau = {:.10g}, {}",
                      crosses(point, *contact) ? "two events at once: crossing" : "grazing: contact", where,
                      contact->tau, state_text(system_.system(), point.orbit, contact->state.data()))};
}

}  // namespace tchat
