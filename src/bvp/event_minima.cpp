#include "bvp/event_minima.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "bvp/orbit_accuracy.hpp"
#include "bvp/with_dimension.hpp"
#include "hybrid/event_at.hpp"
#include "linear_algebra/array_kernel.hpp"

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;

/// How close to parallel two gradients of a pinned start must be, and how close to zero h there (of its size).
constexpr double structural_tolerance = 1e-6;

/// One event function along one segment's collocation polynomials.
class EventAlongSegment {
 public:
  EventAlongSegment(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x, int s,
                    int event)
      : system_(system),
        field_(field),
        rule_(rule),
        x_(x),
        s_(s),
        event_(event),
        values_(Vector::Constant(x.shape.nodes(), NAN)),
        slopes_(x.shape.collocation + 1, x.shape.intervals) {
    find_slopes(find_gradients());
  }

  double length(int j) const { return x_.mesh[static_cast<std::size_t>(j + 1)] - x_.mesh[static_cast<std::size_t>(j)]; }

  /// d h / d tau at sigma in [0, 1] of interval j, from the polynomial.
  double slope(int j, double sigma) const {
    const Basis basis = basis_at(sigma);
    return gradient(nodes(j) * basis.values).dot(nodes(j) * basis.slopes) / length(j);
  }

  /// The same at node i of the interval.
  double slope_at_node(int j, int i) const { return slopes_(i, j); }

  /// h at all nodes.
  const Vector& values() const { return values_; }

  /// h at sigma of interval j, from the polynomial.
  double value(int j, double sigma) const {
    const Vector u = nodes(j) * basis_at(sigma).values;
    return system_.event(event_, u.data(), par());
  }

  /// The minimum near sigma of interval j, by the flow from the interval's left mesh point (by the polynomial where
  /// there is no flow); the small rest of h_x f there is removed by one Newton step on the time.
  EventMinimum polished(int j, double sigma) const {
    const double time = sigma * length(j) * x_.duration(s_);
    Vector u = flow(x_.node(s_, j * x_.shape.collocation), time).value_or(nodes(j) * basis_at(sigma).values);
    const int n = x_.shape.dimension;
    Vector f(n);
    Eigen::MatrixXd fx(n, n);
    system_.first(FunctionKind::field, field_, u.data(), par(), {}, f.data(), fx.data(), nullptr);
    double rate = 0.0;  // h_x f
    Vector curvature(n);
    system_.second(FunctionKind::event, event_, u.data(), par(), {}, f.data(), &rate, curvature.data(), nullptr);
    const double rate_slope = curvature.dot(f) + gradient(u).dot(fx * f);  // of h_x f along the flow
    const double to_zero = rate_slope > 0.0 ? -rate / rate_slope : 0.0;
    // Farther off than the segment lasts (one that vanishes, whose slopes are rounding) it is no minimum of its.
    const double correction = std::abs(to_zero) <= x_.duration(s_) ? to_zero : 0.0;
    const double value = system_.event(event_, u.data(), par()) + 0.5 * rate * correction;
    u += correction * f;
    const double tau = x_.mesh[static_cast<std::size_t>(j)] + sigma * length(j) + correction / x_.duration(s_);
    return {snapped(tau), value, u};
  }

 private:
  /// Those of h at the nodes, one a column, and its values. All in one call; where one point spoils it for others (an
  /// exception makes all of them unknown), each on its own.
  Eigen::MatrixXd find_gradients() {
    const int nodes = x_.shape.nodes();
    Eigen::MatrixXd gradients = Eigen::MatrixXd::Constant(x_.shape.dimension, nodes, NAN);
    system_.first_at_points(FunctionKind::event, event_, nodes, x_.node(s_, 0), par(), {}, values_.data(),
                            gradients.data(), nullptr);
    if (values_.allFinite() && gradients.allFinite()) return gradients;
    for (int k = 0; k < nodes; ++k)
      if (!std::isfinite(values_(k)) || !gradients.col(k).allFinite())
        system_.first(FunctionKind::event, event_, x_.node(s_, k), par(), {}, &values_(k), gradients.col(k).data(),
                      nullptr);
    return gradients;
  }

  void find_slopes(const Eigen::MatrixXd& gradients) {
    const int n = x_.shape.dimension;
    const int c = x_.shape.collocation;
    Eigen::MatrixXd of_basis(c + 1, c + 1);
    for (int i = 0; i <= c; ++i) of_basis.row(i) = basis_at(static_cast<double>(i) / c).slopes;
    Eigen::MatrixXd rates(n, (c + 1) * x_.shape.intervals);
    array_functions().interpolate({of_basis.data(), c + 1, c, n, x_.shape.intervals}, x_.node(s_, 0), rates.data(), n);
    with_dimension(n, [&](auto entries) {
      const double* rate = rates.data();
      for (int j = 0; j < x_.shape.intervals; ++j)
        for (int i = 0; i <= c; ++i, rate += entries) {
          const double* gradient = gradients.col(j * c + i).data();
          double slope = 0.0;
          for (int a = 0; a < entries; ++a) slope += gradient[a] * rate[a];
          slopes_(i, j) = slope / length(j);
        }
    });
  }

  const double* par() const { return x_.par.data(); }

  /// Rounding may place a minimum slightly inside an end; it is then moved onto the end.
  static double snapped(double tau) {
    constexpr double rounding = 1e-12;
    if (tau < rounding) return 0.0;
    return tau > 1.0 - rounding ? 1.0 : tau;
  }

  Vector gradient(const Vector& u) const { return event_at(system_, event_, u.data(), par()).gradient; }

  /// Nothing where the flow cannot be integrated: the field has no value near the orbit, or is too stiff for an
  /// explicit method of this accuracy.
  std::optional<Vector> flow(const double* from, double time) const {
    namespace odeint = boost::numeric::odeint;
    using State = std::vector<double>;
    constexpr int most_trials = 2000;  // of steps; the part of one mesh interval takes some ten
    State u(from, from + x_.shape.dimension);
    const auto rhs = [&](const State& y, State& dydt, double) {
      system_.value(FunctionKind::field, field_, y.data(), par(), dydt.data());
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

  const HybridSystem& system_;
  int field_;
  const CollocationRule& rule_;
  const Orbit& x_;
  int s_;
  int event_;
  Vector values_;           // of h at the nodes
  Eigen::MatrixXd slopes_;  // d h / d tau at the nodes of each interval, which is a column
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

Minima find_minima(const EventAlongSegment& along, int intervals, int c) {
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

bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event) {
  const int before = (s + x.shape.segments - 1) % x.shape.segments;
  const IndexVector& v = signature[static_cast<std::size_t>(before)];
  const double* par = x.par.data();
  if (v.event == no_function) return false;
  if (std::abs(system.event(event, x.start(s), par)) > structural_tolerance * event_scale(system, x, event))
    return false;
  const Eigen::MatrixXd gx = jump_at(system, v.jump, x.end(before), par).derivative;
  const Vector composed = gx.transpose() * event_at(system, event, x.start(s), par).gradient;
  const Vector terminal = event_at(system, v.event, x.end(before), par).gradient;
  const double sizes = composed.norm() * terminal.norm();
  return sizes > 0.0 && std::abs(std::abs(composed.dot(terminal)) / sizes - 1.0) < structural_tolerance;
}

EventCourse event_course(const HybridSystem& system, const Signature& signature, const CollocationRule& rule,
                         const Orbit& x, int s, int event, double below) {
  const IndexVector& v = signature[static_cast<std::size_t>(s)];
  const EventAlongSegment along(system, v.field, rule, x, s, event);
  EventCourse course{along.values(), {}};
  if (!(x.duration(s) > 0.0)) return course;
  const Minima minima = find_minima(along, x.shape.intervals, x.shape.collocation);
  for (std::size_t i = 0; i < minima.list.size(); ++i) {
    const Minimum& at = minima.list[i];
    if (along.value(at.interval, at.sigma) >= below) continue;
    if (i == 0 && minima.first_hangs_on_start && is_pinned_start(system, signature, x, s, event)) continue;
    if (i + 1 == minima.list.size() && minima.last_hangs_on_end && v.event == event) continue;
    course.minima.push_back(along.polished(at.interval, at.sigma));
  }
  return course;
}

std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           int s, int event) {
  std::vector<EventMinimum> candidates;
  const EventCourse course = event_course(system.system(), system.signature(), rule, x, s, event);
  const auto add_node = [&](int k) {
    candidates.push_back({x.tau(k), course.at_nodes(k), Vector::Map(x.node(s, k), x.shape.dimension)});
  };
  if (!is_pinned_start(system.system(), system.signature(), x, s, event)) add_node(0);
  if (system.signature()[static_cast<std::size_t>(s)].event != event) add_node(x.shape.nodes() - 1);
  candidates.insert(candidates.end(), course.minima.begin(), course.minima.end());
  return candidates;
}

std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        int s, int event) {
  const std::vector<EventMinimum> candidates = least_candidates(system, rule, x, s, event);
  const auto least = std::min_element(candidates.begin(), candidates.end(),
                                      [](const EventMinimum& a, const EventMinimum& b) { return a.value < b.value; });
  if (least == candidates.end()) return std::nullopt;
  return *least;
}

}  // namespace tchat
