#include "motion/lyapunov_exponents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "model/function_values.hpp"
#include "model/scales.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/recurrence.hpp"
#include "motion/tangent_flow.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double hardly_transversal = level::double_zero;  // |h_x f-| / (|h_x| |f-|)
constexpr long least_ticks = 256;                          // before ticks become longer
constexpr double least_speed = level::orbit;               // |f|, as a share of its largest: below it the motion rests
constexpr double steps_of_tick = 4.0;                      // at least, of the integrator

/// An event whose saltation waits for the field after it.
struct Saltation {
  MatrixXd gx;
  EventAt at;  // with f-
  VectorXd after;
  bool is_tangential = false;
  std::string without_derivatives;  // which function has none, and where
};

Index most_exponents(const HybridSystem& system, const LyapunovSettings& settings) {
  return settings.section == 0 ? system.dimension() : system.dimension() - 1;
}

/// Found at the start and, as a column may vanish there by chance, at states beside it.
std::vector<Index> states_that_nothing_depends_on(const HybridSystem& system, const VectorXd& x, const VectorXd& par) {
  std::vector<VectorXd> points{x};
  for (int k = 1; k <= 2; ++k) {
    VectorXd beside = x;
    for (Index i = 0; i < x.size(); ++i)
      beside(i) += 1e-3 * (1.0 + std::abs(x(i))) * std::sin(1.0 + 2.3 * static_cast<double>(i) + 4.1 * k);
    points.push_back(beside);
  }
  const std::vector<bool> flags = ignorable_states(system, points, par);
  std::vector<Index> states;
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) states.push_back(static_cast<Index>(i));
  return states;
}

void keep_first(LyapunovSpectrum& spectrum, Index count) {
  if (spectrum.exponents.size() <= count) return;
  spectrum.exponents.conservativeResize(count);
  spectrum.errors.conservativeResize(count);
  std::erase_if(spectrum.structural, [&](Index j) { return j >= count; });
}

Index checked_columns(const HybridSystem& system, const LyapunovSettings& settings) {
  const int events = system.count(FunctionKind::event);
  if (settings.section < 0 || settings.section > events)
    throw UserError(
        fmt::format("section {}: {} has the event functions 1 to {}", settings.section, system.name(), events));
  const Index most = most_exponents(system, settings);
  if (settings.exponents < 0 || settings.exponents > most)
    throw UserError(
        fmt::format("{} Lyapunov exponents: {} has {}{}", settings.exponents, system.name(), most,
                    settings.section == 0 ? ", one for each state" : " on a section, one less than states"));
  if (most == 0) throw UserError(fmt::format("{} has one state, and a section of it no exponent", system.name()));
  return settings.exponents == 0 ? most : settings.exponents;
}

}  // namespace

struct LyapunovAccumulator::Implementation {
  const HybridSystem& system;
  VectorXd par;
  LyapunovSettings settings;
  Index wanted;  // exponents
  OrthonormalFrame frame;
  TangentFlow tangent;
  GrowthSeries by_event, by_time;
  VectorXd growth_of_event, growth_of_tick;  // since the last event (with a section: return), since the last tick
  double duration_of_event = 0.0;

  VectorXd sizes;                // of the states so far; none: it has not begun
  VectorXd units;                // of the states; none: 1
  std::vector<Index> ignorable;  // states that nothing depends on
  bool has_flow = false;         // the direction along the flow is among the known ones
  Index known = -1;              // first columns of the frame, whose directions are known; -1: it has not begun
  double fastest = 0.0;          // |f|
  bool is_resting = false;
  bool has_begun = false;
  bool is_in_segment = false;
  double carried = 0.0;  // of the segment
  std::optional<Saltation> waiting;
  std::optional<EventWatch> watch;  // for the section, where it ends no segments
  bool has_crossed = false;         // the section, once
  long steps = 0;                   // of the integrator
  double tick = 0.0, left_of_tick = 0.0;
  double least_tick = 0.0;
  double time = 0.0;
  std::optional<double> elapsed;  // before the first segment
  double time_of_returns = 0.0, time_since_return = 0.0;
  long events = 0, tangential = 0;
  std::string fault;

  Implementation(const HybridSystem& s, const VectorXd& p, const LyapunovSettings& given)
      : system(s),
        par(p),
        settings(given),
        wanted(checked_columns(s, given)),
        frame(s.dimension(), wanted),
        tangent(system, par, given.flow.relative_tolerance),
        by_event(wanted),
        by_time(wanted) {
    settings.flow.variational = false;
  }

  bool has_section() const { return settings.section != 0; }

  void orthonormalise(bool may_vanish = true) {
    frame.orthonormalise(may_vanish);
    tangent.restart();
  }

  /// What has grown is told to both series.
  void collect() {
    const VectorXd& growth = frame.take_growth();
    growth_of_event += growth;
    growth_of_tick += growth;
  }

  void end_piece_by_event(double duration) {
    by_event.add(growth_of_event, duration);
    growth_of_event.setZero();
  }

  /// The frame begins with the directions that are known: of states that nothing depends on, and of the flow.
  void set_up(int field, const double* start) {
    const Index n = system.dimension();
    const Eigen::Map<const VectorXd> x(start, n);
    ignorable = states_that_nothing_depends_on(system, x, par);
    has_flow = !has_section() && flow_direction(field, start).size() > 0;
    known = static_cast<Index>(ignorable.size()) + (has_flow ? 1 : 0);
    const Index columns = std::min(most_exponents(system, settings), wanted + known);
    known = std::min(known, columns);
    frame = OrthonormalFrame(n, columns);
    use_sizes();
    by_event = by_time = GrowthSeries(columns);
    growth_of_event = growth_of_tick = VectorXd::Zero(columns);
    restore_known(field, start);
    orthonormalise();
    frame.take_growth();
  }

  /// Directions are compared in units of the states, where their sizes are far from 1.
  void use_sizes() {
    tangent.use_sizes(sizes);
    if (are_usual(sizes)) return;
    units = units_of(sizes);
    frame.use_units(units);
  }

  double length(const VectorXd& v) const { return units.size() == 0 ? v.norm() : v.cwiseQuotient(units).norm(); }

  /// |h_x f| is next to nothing against |h_x| |f|.
  bool is_hardly_met(const EventAt& at) const {
    const double gradient = units.size() == 0 ? at.gradient.norm() : at.gradient.transpose().cwiseProduct(units).norm();
    return std::abs(at.rate()) < hardly_transversal * gradient * length(at.f);
  }

  /// f without the states that nothing depends on, of unit length; empty where nothing is left.
  VectorXd flow_direction(int field, const double* x) const {
    VectorXd f(system.dimension());
    system.value(FunctionKind::field, field, x, par.data(), f.data());
    const double whole = length(f);
    for (const Index k : ignorable) f(k) = 0.0;
    const double size = length(f);
    if (!(size > level::negligible * whole) || !(size > least_speed * fastest)) return {};
    return f / size;
  }

  /// Rounding and chaos turn known directions away from where they are.
  void restore_known(int field, const double* x) {
    for (std::size_t k = 0; k < ignorable.size() && static_cast<Index>(k) < known; ++k)
      frame.vectors().col(static_cast<Index>(k)) =
          (units.size() == 0 ? 1.0 : units(ignorable[k])) * VectorXd::Unit(system.dimension(), ignorable[k]);
    if (!has_flow || static_cast<Index>(ignorable.size()) >= known) return;
    const VectorXd f = flow_direction(field, x);
    if (f.size() > 0) frame.vectors().col(static_cast<Index>(ignorable.size())) = f;
  }

  /// Exponents that are zero whatever the motion does. A motion that has come to rest has no direction of flow.
  Index structural() const { return has_flow && is_resting ? known - 1 : known; }

  void begin_segment(int field, const double* start) {
    if (sizes.size() == 0) sizes = sizes_at(system, field, Eigen::Map<const VectorXd>(start, system.dimension()), par);
    if (known < 0) set_up(field, start);
    is_in_segment = true;
    carried = 0.0;
    if (waiting) apply_saltation(field);
    watch.reset();
    if (has_section()) watch.emplace(system, field, std::vector<int>{settings.section}, par, start, settings.flow);
  }

  /// S V with S = g_x + (f+ - g_x f-) h_x / (h_x f-); of an event without velocity g_x alone.
  void apply_saltation(int field) {
    const Saltation event = *std::exchange(waiting, std::nullopt);
    VectorXd difference(system.dimension());
    system.value(FunctionKind::field, field, event.after.data(), par.data(), difference.data());
    difference -= event.gx * event.at.f;
    MatrixXd& v = frame.vectors();
    MatrixXd moved = event.gx * v;
    if (event.at.rate() != 0.0) moved -= difference * change_of_time(event.at.f, event.at.gradient, v);
    if (!moved.allFinite()) {
      fault =
          event.without_derivatives.empty() ? "a field or a jump is not finite at an event" : event.without_derivatives;
      return;
    }
    v = moved;
    tangential += event.is_tangential ? 1 : 0;
    orthonormalise(!event.is_tangential);
    collect();
    restore_known(field, event.after.data());
  }

  void wait_for_field(const SimulatedSegment& segment) {
    const EventAt at = event_at(system, segment.index.event, segment.mode.field(), segment.end.data(), par.data());
    Saltation event{jump_at(system, segment.index.jump, segment.end.data(), par.data()).derivative, at, segment.after,
                    is_hardly_met(at), ""};
    const auto tell = [&](FunctionKind kind, int index) {
      if (!has_finite_derivatives(system, kind, index, segment.end.data(), par.data()))
        event.without_derivatives = no_finite_derivatives(system, kind, index, segment.end);
    };
    if (!event.at.gradient.allFinite()) tell(FunctionKind::event, segment.index.event);
    if (!event.gx.allFinite()) tell(FunctionKind::jump, segment.index.jump);
    waiting = std::move(event);
  }

  void carry(int field, const DenseOutput& state, double from, double to) {
    if (!fault.empty() || !(from < to)) return;
    if (tangent.carry(frame, field, state, from, to)) return;
    const std::string name = system.function_name(FunctionKind::field, field);
    fault = tangent.takes_too_many_steps()
                ? fmt::format("the derivatives of {} are so large that tangent vectors take too many steps", name)
                : fmt::format("{} has no finite derivatives on the way", name);
  }

  void end_tick() {
    orthonormalise();
    collect();
    by_time.add(growth_of_tick, tick);
    growth_of_tick.setZero();
    if (tick < least_tick && by_time.pieces() >= least_ticks && by_time.pieces() % 2 == 0) {
      by_time.double_pieces();
      tick *= 2.0;
    }
    left_of_tick = tick;
  }

  void look_at_speed(int field, const double* x) {
    VectorXd f(system.dimension());
    system.value(FunctionKind::field, field, x, par.data(), f.data());
    for (const Index k : ignorable) f(k) = 0.0;
    fastest = std::max(fastest, length(f));
    is_resting = length(f) <= least_speed * fastest;
  }

  void carry_with_ticks(int field, const DenseOutput& state, double from, double to) {
    if (tick == 0.0) tick = left_of_tick = steps_of_tick * (to - from);
    least_tick = std::max(least_tick, steps_of_tick * (to - from));
    while (to - from >= left_of_tick) {
      const double until = std::min(to, from + left_of_tick);
      carry(field, state, from, until);
      end_tick();
      look_at_speed(field, state(until));
      restore_known(field, state(until));
      from = until;
    }
    carry(field, state, from, to);
    left_of_tick -= to - from;
  }

  void carry_to_section(int field, const DenseOutput& state, double from, double to) {
    double t = from;
    while (const auto fall = watch->look(to, state, nullptr)) {
      carry(field, state, t, fall->time);
      time_since_return += fall->time - t;
      t = fall->time;
      cross_section(field, state(t));
    }
    carry(field, state, t, to);
    time_since_return += to - t;
  }

  void cross_section(int field, const double* x) {
    const EventAt at = event_at(system, settings.section, field, x, par.data());
    const bool is_tangential = is_hardly_met(at);
    MatrixXd& v = frame.vectors();
    const MatrixXd moved = at.project(v);
    if (moved.allFinite()) v = moved;
    tangential += is_tangential ? 1 : 0;
    orthonormalise(!is_tangential);
    collect();
    if (has_crossed) {
      end_piece_by_event(1.0);
      time_of_returns += time_since_return;
    }
    growth_of_event.setZero();
    time_since_return = 0.0;
    has_crossed = true;
  }

  void pass_piece(int field, const DenseOutput& state, double from, double to) {
    if (!has_begun) return;
    if (!is_in_segment) begin_segment(field, state(from));
    ++steps;
    if (has_section())
      carry_to_section(field, state, from, to);
    else
      carry_with_ticks(field, state, from, to);
    carried = to;
  }

  /// What the simulation has not carried.
  void integrate(const SimulatedSegment& segment) {
    CvodesFlow flow(system, segment.mode.field(), segment.start, par, settings.flow);
    flow.on_piece([&](double from, double to) {
      if (from < to) pass_piece(segment.mode.field(), flow.dense_output(), from, to);
      return true;
    });
    if (flow.advance(segment.duration) == Progress::failed) fault = flow.message();
  }

  void pass(const SimulatedSegment& segment) {
    has_begun = true;
    if (!elapsed) elapsed = segment.start_time;
    if (!is_in_segment) begin_segment(segment.mode.field(), segment.start.data());
    if (carried == 0.0 && segment.duration > 0.0) integrate(segment);
    is_in_segment = false;
    sizes = sizes.cwiseMax(segment.low.cwiseAbs()).cwiseMax(segment.high.cwiseAbs());
    use_sizes();
    time += segment.duration;
    duration_of_event += segment.duration;
    if (segment.ended_by == SegmentEnd::event) end_by_event(segment);
  }

  /// The watch may see the fall that ends a segment, or not.
  bool has_just_crossed() const { return has_crossed && time_since_return <= level::orbit * carried; }

  void end_by_event(const SimulatedSegment& segment) {
    ++events;
    const bool is_section = has_section() && segment.index.event == settings.section;
    if (is_section && !has_just_crossed()) cross_section(segment.mode.field(), segment.end.data());
    orthonormalise();
    collect();
    if (!has_section()) end_piece_by_event(std::exchange(duration_of_event, 0.0));
    wait_for_field(segment);
  }

  LyapunovSpectrum spectrum() const {
    const double before = elapsed.value_or(0.0);
    const double returns = time_of_returns > 0.0 ? static_cast<double>(by_event.pieces()) / time_of_returns : 0.0;
    LyapunovSpectrum best = by_event.spectrum(structural(), has_section() ? returns * before : before);
    if (!has_section()) {
      const LyapunovSpectrum timed = by_time.spectrum(structural(), before);
      if (by_event.pieces() == 0 || timed.errors.sum() < best.errors.sum()) best = timed;
    }
    best.time = has_section() ? time_of_returns : time;
    best.events = has_section() ? by_event.pieces() : events;
    best.tangential = tangential;
    best.fault = fault;
    if (!fault.empty()) best.exponents.setConstant(std::nan(""));
    add_integration_error(best);
    keep_first(best, wanted);
    return best;
  }

  /// Each step of the integrator may add its tolerance, and a segment's error is about ten times that.
  void add_integration_error(LyapunovSpectrum& spectrum) const {
    const double unit = has_section() ? static_cast<double>(spectrum.events) : spectrum.time;
    if (!(unit > 0.0)) return;
    const double error = 10.0 * settings.flow.relative_tolerance * static_cast<double>(steps) / unit;
    for (Index j = 0; j < spectrum.errors.size(); ++j)
      if (std::isfinite(spectrum.exponents(j))) spectrum.errors(j) = std::hypot(spectrum.errors(j), error);
  }
};

LyapunovAccumulator::LyapunovAccumulator(const HybridSystem& system, const VectorXd& par,
                                         const LyapunovSettings& settings)
    : p_(std::make_unique<Implementation>(system, par, settings)) {}

LyapunovAccumulator::~LyapunovAccumulator() = default;

void LyapunovAccumulator::attach(SimulationSettings& settings) {
  p_->settings.flow = settings.flow;
  p_->settings.flow.variational = false;
  settings.on_piece = [implementation = p_.get()](int field, const DenseOutput& state, double from, double to) {
    implementation->pass_piece(field, state, from, to);
  };
}

void LyapunovAccumulator::begin() { p_->has_begun = true; }

void LyapunovAccumulator::pass(const SimulatedSegment& segment) { p_->pass(segment); }

LyapunovSpectrum LyapunovAccumulator::spectrum() const { return p_->spectrum(); }

VectorXd LyapunovAccumulator::growing_direction() const {
  const MatrixXd& v = p_->frame.vectors();
  return p_->known >= 0 && p_->known < v.cols() ? VectorXd(v.col(p_->known)) : VectorXd::Zero(v.rows());
}

}  // namespace tchat
