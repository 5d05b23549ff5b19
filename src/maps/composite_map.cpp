#include "maps/composite_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "maps/invariant_curve.hpp"
#include "motion/chaos_evidence.hpp"
#include "motion/growth_series.hpp"
#include "motion/recurrence.hpp"
#include "motion/settle.hpp"

namespace tchat {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double event_range(const GrazingPoint& point, const VectorXd& extent) {
  return point.event_gradient.cwiseAbs().dot(extent);
}

LocalContact::LocalContact(std::shared_ptr<const SmoothMap> smooth, std::shared_ptr<const DiscontinuityMap> map,
                           MapOrder order, double neighbourhood)
    : smooth_(std::move(smooth)),
      map_(std::move(map)),
      order_(order),
      neighbourhood_(neighbourhood),
      range_(event_range(map_->point(), smooth_->extent())) {}

double LocalContact::distance(const VectorXd& x) const {
  return smooth_->difference(x, map_->point().x).cwiseQuotient(smooth_->extent()).cwiseAbs().maxCoeff();
}

VectorXd LocalContact::beside(const VectorXd& x) const {
  return map_->point().x + smooth_->difference(x, map_->point().x);
}

LocalContact::Result LocalContact::apply(const VectorXd& x, const ParameterVector& par) const {
  const bool near = distance(x) <= neighbourhood_;
  // On P h_D itself tells of contact anywhere; on P' only where the flow to P is short.
  const double penetration = near || !map_->section() ? map_->penetration(beside(x), par) : NAN;
  const bool contact = near && penetration > 0.0;
  const bool missed = !near && penetration > 0.0;
  return {contact ? map_->apply(beside(x), par, order_) : x, penetration, contact, missed,
          contact ? penetration / range_ : 0.0};
}

MatrixXd LocalContact::derivative(const VectorXd& x, const ParameterVector& par) const {
  if (!(distance(x) <= neighbourhood_)) return MatrixXd::Identity(x.size(), x.size());
  return map_->derivative(beside(x), par, order_);
}

Iterate CompositeMap::step(const VectorXd& x, const ParameterVector& par) const {
  const LocalContact::Result after = contact_.apply(x, par);
  Iterate iterate{{}, after.penetration, after.contact, after.missed, smooth().time(after.x), after.depth};
  iterate.image = smooth().image(after.x, par);
  return iterate;
}

MatrixXd CompositeMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const LocalContact::Result after = contact_.apply(x, par);
  const MatrixXd smooth_part = smooth().derivative(after.x, par);
  return after.contact ? MatrixXd(smooth_part * contact_.derivative(x, par)) : smooth_part;
}

Iterate ReducedMap::step(const VectorXd& x, const ParameterVector& par) const {
  const InvariantCurve& curve = smooth_->curve();
  const VectorXd on_curve = smooth_->on_curve(smooth_->projection().phase(x));
  const LocalContact::Result after = contact_.apply(on_curve, par);
  const double phi = smooth_->projection().phase(after.x);
  return {smooth_->on_curve(phi + curve.rotation()),
          after.penetration,
          after.contact,
          after.missed,
          smooth_->time(after.x),
          after.depth};
}

MatrixXd ReducedMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const CurveProjection& projection = smooth_->projection();
  const double phi = projection.phase(x);
  const VectorXd on_curve = smooth_->on_curve(phi);
  const LocalContact::Result after = contact_.apply(on_curve, par);
  if (!after.contact) return MatrixXd::Ones(1, 1);
  return projection.gradient(after.x, projection.phase(after.x)) * contact_.derivative(on_curve, par) *
         smooth_->curve().derivative(phi);
}

EllipseMap::EllipseMap(std::shared_ptr<const TorusReturn> smooth, std::shared_ptr<const DiscontinuityMap> map,
                       double phase)
    : smooth_(std::move(smooth)), map_(std::move(map)), phase_(phase) {
  const ParameterVector& par = map_->point().par;
  const VectorXd at = map_->point().x;
  // By differences of fourth order: P' is reached by the flow.
  const auto depth = [&](double t) {
    const VectorXd x = at + smooth_->curve().difference(smooth_->on_curve(phase_ + t), smooth_->on_curve(phase_));
    return map_->penetration(x, par);
  };
  const double t = 2e-3;
  const double first = depth(t) + depth(-t) - 2.0 * depth(0.0);
  const double second = depth(2.0 * t) + depth(-2.0 * t) - 2.0 * depth(0.0);
  curvature_ = -(16.0 * first - second) / (12.0 * t * t);
  if (!(curvature_ > 0.0))
    throw UserError(
        "the torus touches the wall along more than a point, or from behind: h_D has no minimum along the "
        "invariant curve at the grazing point");
  const CurveProjection& projection = smooth_->projection();
  shift_ = projection.gradient(at, projection.phase(at)).dot(map_->expansion().y);
}

ContactEllipse EllipseMap::ellipse(const ParameterVector& par) const {
  ContactEllipse ellipse{phase_, 0.0, 0.0, map_->penetration(map_->point().x, par)};
  if (!(ellipse.depth > 0.0)) return ellipse;
  ellipse.height = -shift_ * std::sqrt(ellipse.depth);
  ellipse.width = std::sqrt(2.0 * ellipse.depth / curvature_);
  return ellipse;
}

Iterate EllipseMap::step(const VectorXd& x, const ParameterVector& par) const {
  const double phi = smooth_->projection().phase(x);
  const ContactEllipse contact = ellipse(par);
  const double off = nearest_phase(phi - phase_);
  const double penetration = contact.depth - 0.5 * curvature_ * off * off;
  const bool touches = penetration > 0.0;
  const double moved = touches ? phi + shift_ * std::sqrt(penetration) : phi;
  return {smooth_->on_curve(moved + smooth_->curve().rotation()),
          penetration,
          touches,
          false,
          smooth_->time(smooth_->on_curve(moved)),
          touches ? penetration / event_range(map_->point(), smooth_->extent()) : 0.0};
}

MatrixXd EllipseMap::tangent(const VectorXd& x, const ParameterVector& par) const {
  const double phi = smooth_->projection().phase(x);
  const ContactEllipse contact = ellipse(par);
  const double off = nearest_phase(phi - phase_);
  const double penetration = contact.depth - 0.5 * curvature_ * off * off;
  if (!(penetration > 0.0)) return MatrixXd::Ones(1, 1);
  return MatrixXd::Constant(1, 1, 1.0 - shift_ * 0.5 * curvature_ * off / std::sqrt(penetration));
}

namespace {

using Eigen::Index;

/// Exponents that are told from zero by so many error bars, and by this much per return.
constexpr double bars = 3.0;
constexpr double least_growth = level::visible;
constexpr double least_range = 1e-3;   // of a motion, in extents
constexpr long looked_at = 64;         // returns between two looks for a period
constexpr long first_decision = 2000;  // returns of which exponents are made

/// Why iterates cannot go on; "" when they can.
std::string trouble(const IteratedMap& map, const Iterate& iterate, const VectorXd& x, const MapIteration& settings) {
  if (iterate.missed)
    return fmt::format(
        "contact at x = {}, outside the neighbourhood of the grazing point that the discontinuity map is "
        "applied in",
        state_text(x));
  if (!iterate.image.allFinite())
    return fmt::format("the map has no value at x = {}: it is too far from grazing", state_text(x));
  if (iterate.depth > settings.escape)
    return fmt::format(
        "a penetration of {:.6g} at x = {}, which is more than the motion extends over: the parameters are "
        "too far from grazing",
        iterate.penetration, state_text(x));
  const double distance = map.smooth().distance(iterate.image);
  if (!(distance <= settings.escape))
    return fmt::format(
        "the iterates leave the neighbourhood of the grazing motion, for x = {}: there the map says "
        "nothing of the flow",
        state_text(iterate.image));
  return "";
}

/// One return of a map: from which state, and why there is none after it.
struct MapReturn {
  VectorXd x;
  Iterate iterate;
  std::string trouble;
};

bool goes_on(const MapReturn& step) { return step.trouble.empty(); }

/// A motion of returns, for settle().
class MapMotion {
 public:
  MapMotion(const IteratedMap& map, VectorXd x, const ParameterVector& par, const MapIteration& settings)
      : map_(map), par_(par), settings_(settings), x_(std::move(x)) {}

  MapReturn next(double) {
    if (settings_.interrupted && ++steps_ % 1024 == 0 && settings_.interrupted()) throw ComputationError("interrupted");
    MapReturn step{x_, map_.step(x_, par_), ""};
    step.trouble = trouble(map_, step.iterate, x_, settings_);
    if (!step.trouble.empty()) return step;
    time_ += step.iterate.time;
    x_ = step.iterate.image;
    return step;
  }
  double time() const { return time_; }
  const VectorXd& x() const { return x_; }

 private:
  const IteratedMap& map_;
  const ParameterVector& par_;
  const MapIteration& settings_;
  VectorXd x_;
  double time_ = 0.0;
  long steps_ = 0;
};

/// Iterates from a point beside another one.
class IteratesBeside : public MotionBeside {
 public:
  IteratesBeside(const IteratedMap& map, VectorXd x, const ParameterVector& par, const MapIteration& settings)
      : map_(map), par_(par), motion_(map, std::move(x), par, settings) {}

  bool pass(long returns, LyapunovSpectrum* spectrum) override {
    QrAccumulator exponents(map_.coordinates(), map_.exponents());
    low_ = high_ = motion_.x();
    const auto add = [&](const MapReturn& step, bool) {
      message_ = step.trouble;
      low_ = low_.cwiseMin(step.x);
      high_ = high_.cwiseMax(step.x);
      if (goes_on(step) && spectrum != nullptr) exponents.pass(map_.tangent(step.x, par_), step.iterate.time);
      return false;
    };
    const Course course = settle(motion_, plan_of_events(returns), add);
    if (spectrum != nullptr) *spectrum = exponents.spectrum();
    return !course.has_ended;
  }
  VectorXd units() const override { return VectorXd::Ones(low_.size()); }
  VectorXd range() const override { return high_ - low_; }
  double time() const override { return motion_.time(); }
  std::string why_ended() const override { return message_; }

 private:
  const IteratedMap& map_;
  const ParameterVector& par_;
  MapMotion motion_;
  VectorXd low_, high_;
  std::string message_;
};

class Iteration {
 public:
  Iteration(const IteratedMap& map, const VectorXd& x0, const ParameterVector& par, const MapIteration& settings)
      : map_(map),
        par_(par),
        settings_(settings),
        motion_(map, x0, par, settings),
        recurrence_(settings.max_period, settings.recognition) {
    const VectorXd& extent = map.smooth().extent();
    recurrence_.measure([&map](const VectorXd& x, const VectorXd& y) { return map.smooth().difference(x, y); },
                        least_range * extent);
  }

  MapAttractor run() {
    SimulationPlan plan;
    plan.transient_events = settings_.transient;
    plan.events = settings_.returns;
    const Course course = settle(motion_, plan, [&](const MapReturn& step, bool is_transient) {
      if (!goes_on(step)) {
        found_.kind = AttractorKind::escape;
        found_.message = step.trouble;
        found_.time = NAN;
        return true;
      }
      add(step, is_transient);
      return found_.period > 0;
    });
    found_.last = motion_.x();
    if (course.has_ended) return found_;
    if (found_.period == 0) found_.period = recurrence_.period().value_or(0);
    const std::size_t kept = found_.period > 0 ? static_cast<std::size_t>(found_.period) : points_.size();
    keep(points_.size() - kept);
    if (found_.period > 0)
      describe_period();
    else
      tell_kind();
    return found_;
  }

 private:
  void add(const MapReturn& step, bool is_transient) {
    if (was_transient_ && !is_transient) forget();
    was_transient_ = is_transient;
    const Iterate& iterate = step.iterate;
    points_.push_back(step.x);
    penetrations_.push_back(iterate.penetration);
    contacts_.push_back(iterate.contact);
    times_.push_back(iterate.time);
    // A motion that does not repeat itself covers a range; one that does may lie in a point: then the extents decide.
    recurrence_.add({1, iterate.contact ? 1 : 2, 1}, iterate.image, step.x, step.x);
    if (++returns_ % looked_at != 0) return;
    // Near a multiplier of -1 it repeats itself best after two turns, at first.
    const int period = recurrence_.period().value_or(0);
    found_.period = period == std::exchange(seen_, period) ? period : 0;
  }

  /// Of the transient only what may turn out to be a period.
  void forget() {
    const auto most = static_cast<std::size_t>(3 * settings_.max_period);
    if (points_.size() <= most) return;
    const auto gone = static_cast<std::ptrdiff_t>(points_.size() - most);
    points_.erase(points_.begin(), points_.begin() + gone);
    penetrations_.erase(penetrations_.begin(), penetrations_.begin() + gone);
    contacts_.erase(contacts_.begin(), contacts_.begin() + gone);
    times_.erase(times_.begin(), times_.begin() + gone);
  }

  void keep(std::size_t from) {
    const auto first = std::max(from, points_.size() - std::min<std::size_t>(points_.size(), wanted()));
    const auto count = static_cast<Index>(points_.size() - first);
    found_.points.resize(motion_.x().size(), count);
    found_.penetrations.resize(count);
    found_.time = found_.period > 0 ? 0.0 : NAN;
    for (Index k = 0; k < count; ++k) {
      const std::size_t i = first + static_cast<std::size_t>(k);
      found_.points.col(k) = points_[i];
      found_.penetrations(k) = penetrations_[i];
      if (found_.period > 0) found_.time += times_[i];
    }
    found_.contacts.assign(contacts_.begin() + static_cast<std::ptrdiff_t>(first), contacts_.end());
  }

  std::size_t wanted() const {
    return found_.period > 0 ? static_cast<std::size_t>(found_.period) : static_cast<std::size_t>(settings_.returns);
  }

  void describe_period() {
    const VectorXd logarithms = logarithms_of_multipliers();
    if (settings_.exponents > 0) add_multipliers(logarithms);
    if (!(logarithms(0) > least_growth * found_.period)) {
      found_.kind = AttractorKind::periodic;
      return;
    }
    found_.message = fmt::format(
        "undecided: the iterates keep to an unstable orbit of {} returns, with a multiplier of modulus {:.6g}; start "
        "beside it (--state)",
        found_.period, std::exp(logarithms(0)));
    found_.period = 0;
    found_.time = NAN;
  }

  /// ln |mu| of the multipliers of the period, descending; NaN where the map has no derivative.
  VectorXd logarithms_of_multipliers() const {
    MatrixXd product = MatrixXd::Identity(map_.coordinates(), map_.coordinates());
    for (Index k = 0; k < found_.points.cols(); ++k) product = map_.tangent(found_.points.col(k), par_) * product;
    if (!product.allFinite()) return VectorXd::Constant(map_.coordinates(), NAN);
    VectorXd moduli = eigenvalues(product).cwiseAbs();
    std::sort(moduli.begin(), moduli.end(), std::greater<>());
    return moduli.array().log();
  }

  void add_multipliers(const VectorXd& logarithms) {
    const Index count = std::min<Index>(settings_.exponents, map_.exponents());
    LyapunovSpectrum spectrum;
    spectrum.exponents = logarithms.head(count) / found_.time;
    spectrum.errors = VectorXd::Zero(count);
    spectrum.time = found_.time;
    spectrum.events = found_.period;
    found_.spectrum = spectrum;
  }

  /// Going on from the end until the largest one is told from zero or its bar is small.
  void measure_exponents() {
    const Index count = std::min<Index>(std::max(1, settings_.exponents), map_.exponents());
    QrAccumulator accumulator(map_.coordinates(), count);
    long done = 0;
    for (long decision = std::min(settings_.most_returns, first_decision);;
         decision = std::min(2 * decision, settings_.most_returns)) {
      const Course course = settle(motion_, plan_of_events(decision - done), [&](const MapReturn& step, bool) {
        if (goes_on(step)) accumulator.pass(map_.tangent(step.x, par_), step.iterate.time);
        return false;
      });
      done += course.events;
      found_.spectrum = accumulator.spectrum();
      if (decision >= settings_.most_returns || done < decision || is_decided(done)) break;
    }
    growing_ = VectorXd::Zero(motion_.x().size());  // unknown of a reduced map, whose coordinate is no state
    if (map_.coordinates() == growing_.size()) growing_ = accumulator.growing_direction();
  }

  double bar(long returns) const {
    const double mean_time = found_.spectrum->time / static_cast<double>(returns);
    return std::max(bars * found_.spectrum->errors(0), least_growth / mean_time);
  }

  bool is_decided(long returns) const {
    const double mean_time = found_.spectrum->time / static_cast<double>(returns);
    return found_.spectrum->exponents(0) > bar(returns) || bars * found_.spectrum->errors(0) < least_growth / mean_time;
  }

  void tell_kind() {
    measure_exponents();
    const double zero = bar(std::max<long>(1, found_.spectrum->events));
    const double largest = found_.spectrum->exponents(0);
    if (largest > zero)
      judge_chaos(largest);
    else if (largest >= -zero)
      found_.kind = AttractorKind::quasi_periodic;
    else
      found_.message = fmt::format(
          "the iterates approach a periodic orbit that is longer than {} returns, or slowly: try --max-period {}, or "
          "more --transient-events",
          settings_.max_period, 4 * settings_.max_period);
  }

  /// Chaotic, unless the exponent is that of something unstable near which the iterates are.
  void judge_chaos(double exponent) {
    const auto begin_beside = [&](const VectorXd& change) -> std::unique_ptr<MotionBeside> {
      return std::make_unique<IteratesBeside>(map_, motion_.x() + change, par_, settings_);
    };
    const ChaosEvidence evidence = chaos_evidence(begin_beside, growing_, exponent);
    if (evidence.is_chaotic)
      found_.kind = AttractorKind::chaotic;
    else
      found_.message = fmt::format("undecided: {} are the largest exponents; {}",
                                   largest_exponents_text(*found_.spectrum), evidence.doubt);
  }

  const IteratedMap& map_;
  const ParameterVector& par_;
  const MapIteration& settings_;
  MapMotion motion_;
  Recurrence recurrence_;
  bool was_transient_ = true;
  long returns_ = 0;
  int seen_ = 0;  // period at the last look
  VectorXd growing_;
  MapAttractor found_;
  std::vector<VectorXd> points_;
  std::vector<double> penetrations_, times_;
  std::vector<bool> contacts_;
};

}  // namespace

MapAttractor iterate_to_attractor(const IteratedMap& map, const VectorXd& x0, const ParameterVector& par,
                                  const MapIteration& settings) {
  return Iteration(map, x0, par, settings).run();
}

}  // namespace tchat
