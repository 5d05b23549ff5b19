#include "orbit/event_minima.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"
#include "linear/memory.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;

/// How close to parallel two gradients of a pinned start must be, and how close to zero h there (of its size).
constexpr double structural_tolerance = level::located;
constexpr int most_nodes = CollocationRule::most_points + 1;  // of an interval

/// One event function along one segment's collocation polynomials.
class EventAlongSegment {
 public:
  EventAlongSegment(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x, int s,
                    int event)
      : system_(system), field_(field), rule_(rule), x_(x), s_(s), event_(event) {}

  double length(int j) const { return x_.mesh_of(s_)[j + 1] - x_.mesh_of(s_)[j]; }

  /// d h / d tau at sigma in [0, 1] of interval j, from the polynomial.
  double slope(int j, double sigma) const {
    const Basis basis = basis_at(sigma);
    return gradient(nodes(j) * basis.values).dot(nodes(j) * basis.slopes) / length(j);
  }

  /// h at sigma of interval j, from the polynomial.
  double value(int j, double sigma) const {
    const Vector u = nodes(j) * basis_at(sigma).values;
    return system_.event(event_, u.data(), par());
  }

  /// The minimum near sigma of interval j, by the flow from the interval's left mesh point (by the polynomial where
  /// there is no flow, or it has gone elsewhere, as near a saddle it does from rounding alone); the small rest of h_x f
  /// there is removed by one Newton step on the time. `is_near`: of a difference of states.
  template <class Nearness>
  EventMinimum polished(int j, double sigma, const Nearness& is_near) const {
    const double time = sigma * length(j) * x_.duration(s_);
    Vector u = nodes(j) * basis_at(sigma).values;
    const std::optional<Vector> flown = flow(x_.node(s_, j * x_.shape.collocation), time);
    if (flown && is_near(*flown - u)) u = *flown;
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
    const double tau = x_.mesh_of(s_)[j] + sigma * length(j) + correction / x_.duration(s_);
    return {snapped(tau), value, u};
  }

 private:
  const double* par() const { return x_.par.data(); }

  /// Rounding may place a minimum slightly inside an end; it is then moved onto the end.
  static double snapped(double tau) {
    if (tau < level::negligible) return 0.0;
    return tau > 1.0 - level::negligible ? 1.0 : tau;
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
    constexpr level::Tolerances tolerances = level::reference_flow;
    auto stepper =
        odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(tolerances.absolute, tolerances.relative);
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
    return x_.states.middleCols(x_.shape.first_node(s_) + j * c, c + 1);
  }

  const HybridSystem& system_;
  int field_;
  const CollocationRule& rule_;
  const Orbit& x_;
  int s_;
  int event_;
};

/// The nodes at the ends of a course's segment, -1 for one that is pinned.
std::array<int, 2> free_ends(const DefiningSystem& system, const Orbit& x, const EventCourse& course) {
  const int s = course.segment;
  const bool is_pinned =
      is_pinned_start(system.system(), system.signature(), x, s, course.event, scale_of(system.system(), x, course));
  const bool is_terminal = system.signature()[static_cast<std::size_t>(s)].event == course.event;
  return {is_pinned ? -1 : 0, is_terminal ? -1 : x.shape.nodes_of(s) - 1};
}

EventCourse course_of(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s, int event) {
  EventCourse course{s, event, {}, {}};
  EventCourseFinder().find(system.system(), system.signature()[static_cast<std::size_t>(s)].field, rule, x, course);
  return course;
}

}  // namespace

double scale_of(const HybridSystem& system, const Orbit& x, const EventCourse& course) {
  return course.scale ? *course.scale : event_scale(system, x, course.event);
}

void EventScales::begin(const HybridSystem& system) {
  known_.assign(static_cast<std::size_t>(system.count(FunctionKind::event)), std::nullopt);
}

double EventScales::of(const HybridSystem& system, const Orbit& x, int event) {
  std::optional<double>& scale = known_[static_cast<std::size_t>(event - 1)];
  if (!scale) scale = event_scale(system, x, event);
  return *scale;
}

bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event) {
  return is_pinned_start(system, signature, x, s, event, event_scale(system, x, event));
}

bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event,
                     double scale) {
  const int before = (s + x.shape.segments - 1) % x.shape.segments;
  const IndexVector& v = signature[static_cast<std::size_t>(before)];
  const double* par = x.par.data();
  if (v.event == no_function) return false;
  if (std::abs(system.event(event, x.start(s), par)) > structural_tolerance * scale) return false;
  const int n = x.shape.dimension;
  double h = 0.0;
  StackVector image(n), gradient(n), terminal(n), composed(n);
  StackMatrix gx(n, n);
  system.first(FunctionKind::jump, v.jump, x.end(before), par, {}, image.data(), gx.data(), nullptr);
  system.first(FunctionKind::event, event, x.start(s), par, {}, &h, gradient.data(), nullptr);
  system.first(FunctionKind::event, v.event, x.end(before), par, {}, &h, terminal.data(), nullptr);
  composed.noalias() = gx.transpose() * gradient;
  // Wherever it comes from, the jump leads to the surface.
  if (composed.norm() <= structural_tolerance * gradient.norm() * std::max(1.0, gx.norm())) return true;
  const double sizes = composed.norm() * terminal.norm();
  return sizes > 0.0 && std::abs(std::abs(composed.dot(terminal)) / sizes - 1.0) < structural_tolerance;
}

/// All in one call; where one point spoils it for others (an exception makes all of them unknown), each on its own.
void EventCourseFinder::find_gradients(const HybridSystem& system, const Orbit& x, EventCourse& course) {
  const int nodes = x.shape.nodes_of(course.segment);
  const int n = x.shape.dimension;
  const double* par = x.par.data();
  course.at_nodes.setConstant(nodes, NAN);
  gradients_.setConstant(n, nodes, NAN);
  system.first_at_points(FunctionKind::event, course.event, nodes, x.node(course.segment, 0), par, {},
                         course.at_nodes.data(), gradients_.data(), nullptr);
  const auto is_finite = [](const double* values, Eigen::Index count) {
    return array_functions().range(values, count).finite;
  };
  if (is_finite(course.at_nodes.data(), nodes) && is_finite(gradients_.data(), gradients_.size())) return;
  for (int k = 0; k < nodes; ++k)
    if (!std::isfinite(course.at_nodes(k)) || !gradients_.col(k).allFinite())
      system.first(FunctionKind::event, course.event, x.node(course.segment, k), par, {}, &course.at_nodes(k),
                   gradients_.col(k).data(), nullptr);
}

void EventCourseFinder::find_slopes(const CollocationRule& rule, const Orbit& x, int s) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_nodes, most_nodes> of_basis(c + 1, c + 1);
  for (int i = 0; i <= c; ++i) {
    std::array<double, most_nodes> slopes{};
    rule.basis(static_cast<double>(i) / c, nullptr, slopes.data());
    for (int k = 0; k <= c; ++k) of_basis(i, k) = slopes[static_cast<std::size_t>(k)];
  }
  const int intervals = x.shape.intervals_of(s);
  const double* const mesh = x.mesh_of(s);
  rates_.resize(n, static_cast<Eigen::Index>(c + 1) * intervals);
  slopes_.resize(c + 1, intervals);
  array_functions().interpolate({of_basis.data(), c + 1, c, n, intervals}, x.node(s, 0), rates_.data(), n);
  with_dimension(n, [&](auto entries) {
    const double* rate = rates_.data();
    for (int j = 0; j < intervals; ++j) {
      const double length = mesh[j + 1] - mesh[j];
      for (int i = 0; i <= c; ++i, rate += entries) {
        const double* gradient = gradients_.col(j * c + i).data();
        double slope = 0.0;
        for (int a = 0; a < entries; ++a) slope += gradient[a] * rate[a];
        slopes_(i, j) = slope / length;
      }
    }
  });
}

void EventCourseFinder::find_dips(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x,
                                  EventCourse& course) const {
  const EventAlongSegment along(system, field, rule, x, course.segment, course.event);
  const int c = x.shape.collocation;
  bool risen = false;
  double before = 0.0;
  for (int j = 0; j < x.shape.intervals_of(course.segment); ++j) {
    for (int i = 0; i <= c; ++i) {
      const double sigma = static_cast<double>(i) / c;
      const double slope = slopes_(i, j);
      if (before < 0.0 && slope >= 0.0) {
        if (course.dips.empty()) course.first_hangs_on_start = !risen;
        double at = sigma;
        if (i > 0 && slope > 0.0) {
          std::uintmax_t iterations = 50;
          const auto bracket = boost::math::tools::toms748_solve(
              [&](double t) { return along.slope(j, t); }, static_cast<double>(i - 1) / c, sigma, before, slope,
              boost::math::tools::eps_tolerance<double>(40), iterations);
          at = 0.5 * (bracket.first + bracket.second);
        }
        course.dips.push_back({j, at, along.value(j, at)});
        course.last_hangs_on_end = true;
      }
      if (slope < 0.0) course.last_hangs_on_end = false;
      risen = risen || slope > 0.0;
      before = slope;
    }
  }
}

void EventCourseFinder::find(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x,
                             EventCourse& course) {
  course.dips.clear();
  course.first_hangs_on_start = course.last_hangs_on_end = false;
  find_gradients(system, x, course);
  if (!(x.duration(course.segment) > 0.0)) return;
  find_slopes(rule, x, course.segment);
  find_dips(system, field, rule, x, course);
}

std::vector<EventCourse> event_courses(const HybridSystem& system, const Signature& signature,
                                       const std::vector<std::vector<int>>& monitored, const CollocationRule& rule,
                                       const Orbit& x) {
  EventCourseFinder finder;
  EventScales scales;
  scales.begin(system);
  std::vector<EventCourse> courses;
  for (int s = 0; s < x.shape.segments; ++s)
    for (const int event : monitored[static_cast<std::size_t>(s)]) {
      courses.push_back({s, event, {}, {}});
      finder.find(system, signature[static_cast<std::size_t>(s)].field, rule, x, courses.back());
      courses.back().scale = scales.of(system, x, event);
    }
  return courses;
}

std::vector<EventMinimum> polished_minima(const HybridSystem& system, const Signature& signature,
                                          const CollocationRule& rule, const Orbit& x, const EventCourse& course,
                                          double below) {
  const int s = course.segment;
  const IndexVector& v = signature[static_cast<std::size_t>(s)];
  const EventAlongSegment along(system, v.field, rule, x, s, course.event);
  std::vector<EventMinimum> minima;
  Vector sizes;
  // The largest values do where no state is rounding of zero, and take no time.
  const auto is_near = [&](const Vector& change) {
    constexpr double elsewhere = 0.1;  // of the sizes
    if (length_in_sizes(change, x.states.cwiseAbs().rowwise().maxCoeff()) < elsewhere) return true;
    if (sizes.size() == 0) sizes = state_sizes(system, signature, x);
    return length_in_sizes(change, sizes) < elsewhere;
  };
  for (std::size_t i = 0; i < course.dips.size(); ++i) {
    const EventDip& dip = course.dips[i];
    if (dip.value >= below) continue;
    if (i == 0 && course.first_hangs_on_start &&
        is_pinned_start(system, signature, x, s, course.event, scale_of(system, x, course)))
      continue;
    if (i + 1 == course.dips.size() && course.last_hangs_on_end && v.event == course.event) continue;
    minima.push_back(along.polished(dip.interval, dip.sigma, is_near));
  }
  return minima;
}

std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           const EventCourse& course) {
  std::vector<EventMinimum> candidates;
  for (const int node : free_ends(system, x, course))
    if (node >= 0)
      candidates.push_back({x.tau(course.segment, node), course.at_nodes(node),
                            Vector::Map(x.node(course.segment, node), x.shape.dimension)});
  for (EventMinimum& minimum : polished_minima(system.system(), system.signature(), rule, x, course))
    candidates.push_back(std::move(minimum));
  return candidates;
}

std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           int s, int event) {
  return least_candidates(system, rule, x, course_of(system, rule, x, s, event));
}

std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        const EventCourse& course) {
  const std::vector<EventMinimum> candidates = least_candidates(system, rule, x, course);
  const auto least = std::min_element(candidates.begin(), candidates.end(),
                                      [](const EventMinimum& a, const EventMinimum& b) { return a.value < b.value; });
  if (least == candidates.end()) return std::nullopt;
  return *least;
}

std::optional<double> least_h(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                              const EventCourse& course) {
  std::optional<double> least;
  const auto add = [&least](double h) { least = least && !(h < *least) ? *least : h; };
  for (const int node : free_ends(system, x, course))
    if (node >= 0) add(course.at_nodes(node));
  if (!course.dips.empty())
    for (const EventMinimum& minimum : polished_minima(system.system(), system.signature(), rule, x, course))
      add(minimum.value);
  return least;
}

std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        int s, int event) {
  return least_value(system, rule, x, course_of(system, rule, x, s, event));
}

}  // namespace tchat
