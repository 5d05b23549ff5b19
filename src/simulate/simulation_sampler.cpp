#include "simulate/simulation_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "motion/attractor_search.hpp"
#include "motion/chaos_evidence.hpp"
#include "motion/growth_series.hpp"
#include "motion/lyapunov_exponents.hpp"
#include "motion/settle.hpp"
#include "motion/watched_flow.hpp"
#include "simulate/attractor_numbering.hpp"
#include "simulate/recorded_states.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double never = 1e300;
constexpr double every_minimum = 1e300;        // as a share of the largest value: all contacts are noted
constexpr std::size_t samples_following = 12;  // of a segment, among which the hand-over is chosen
constexpr long first_decision = 64;            // events after which exponents may tell the kind of a motion
constexpr long last_decision = 4096;
constexpr long events_of_volumes = 64;
constexpr long events_of_exponents = 512;     // of an attractor whose kind is known
constexpr double same_time = level::located;  // as a share of the longest segment
constexpr std::size_t identity_points = 400;  // of a motion that does not repeat itself

/// A recorded state.
using Dot = TimedState;

/// Collects columns of states.
MatrixXd columns_of(const std::vector<Dot>& dots, Eigen::Index n) {
  MatrixXd states(n, static_cast<Eigen::Index>(dots.size()));
  for (std::size_t k = 0; k < dots.size(); ++k) states.col(static_cast<Eigen::Index>(k)) = dots[k].state;
  return states;
}

/// One value: simulates and gathers.
class SampleRun {
 public:
  SampleRun(const SamplerSetup& setup, const HybridSystem& system, const SweepPoint& point,
            const std::function<bool()>& interrupted)
      : setup_(setup),
        system_(system),
        point_(point),
        interrupted_(interrupted),
        search_(setup.request.plan.max_period, setup.request.plan.recognition, settings()),
        capture_(setup.known) {
    SampleStart start = sample_start(setup, point);
    par_ = std::move(start.par);
    start_ = std::move(start.state);
    side_ = start.side;
  }

  /// At the end it stays where it is, at an equilibrium that does not attract.
  bool has_stayed() const { return has_stayed_; }

  AttractorSample run() {
    SimulationRequest request = setup_.request;
    if (point_.at && !point_.at->watched.empty()) request.modes = modes_text(point_.at->watched);
    SimulationSettings with_exponents = settings();
    with_exponents.side = side_;
    LyapunovAccumulator exponents(system_, par_, lyapunov_settings(with_exponents.flow));
    exponents.attach(with_exponents);
    HybridSimulation simulation(simulation_rule(request, setup_.constants, system_, start_, par_), start_, par_,
                                with_exponents);
    judge_.emplace(simulation, search_, MotionJudge::Settings{true, true});
    approach(simulation);
    sample_.events = events_;
    if (sample_.known > 0) return std::move(sample_);
    if (is_open_) tell_kind(simulation, exponents);
    sample_.events = events_;
    if (repeats(sample_.kind) && setup_.recording.exponents > 0) {
      const auto turns = 1 + events_of_exponents / static_cast<long>(kept_.size());
      HybridSimulation on_orbit(simulation, search_.orbit()->end, with_exponents);
      go_on(on_orbit, exponents, turns * static_cast<long>(kept_.size()));
      keep_exponents(exponents.spectrum());
    }
    finish(simulation);
    if (setup_.recording.largest) measure_largest(simulation);
    return std::move(sample_);
  }

 private:
  SimulationSettings plain_settings() const {
    SimulationSettings settings = simulation_settings(setup_.request, interrupted_);
    if (!setup_.request.stiff) settings.flow.method = IntegrationMethod::runge_kutta;
    return settings;
  }

  SimulationSettings settings() const {
    SimulationSettings settings = plain_settings();
    settings.samples = setup_.follows ? samples_following : 0;
    const Recording& recording = setup_.recording;
    if (recording.states == Recording::States::section) settings.sections.push_back(recording.section);
    if (recording.penetration > 0) {
      settings.sections.push_back(recording.penetration);
      settings.contact = every_minimum;
    }
    return settings;
  }

  LyapunovSettings lyapunov_settings(const FlowOptions& flow) const {
    LyapunovSettings settings;
    settings.exponents = std::min(system_.dimension(), std::max(2, setup_.recording.exponents));
    settings.flow = flow;
    return settings;
  }

  /// Carries the frame of the exponents on over so many events. False when the motion ends.
  bool go_on(HybridSimulation& simulation, LyapunovAccumulator& exponents, long events) {
    exponents.begin();
    const auto pass = [&](const SimulatedSegment& segment, bool) {
      if (segment.ended_by == SegmentEnd::interrupted) throw SampleInterrupted();
      exponents.pass(segment);
      return false;
    };
    return !settle(simulation, plan_of_events(events), pass).has_ended;
  }

  /// Of a motion that has not settled yet: goes on until it does, or the exponents tell.
  void tell_kind(HybridSimulation& simulation, LyapunovAccumulator& exponents) {
    exponents.begin();
    VectorXd end;
    const auto pass = [&](const SimulatedSegment& segment, bool) {
      exponents.pass(segment);
      end = segment.end;
      return is_judged(simulation, segment, false);
    };
    long done = 0;
    for (long decision = first_decision;; decision *= 2) {
      const Course course = settle(simulation, plan_of_events(decision - done), pass);
      events_ += course.events;
      if (course.is_stopped) return;
      done = decision;
      const LyapunovSpectrum spectrum = exponents.spectrum();
      const AttractorKind kind = kind_by_exponents(spectrum);
      const bool tells = kind == AttractorKind::chaotic || kind == AttractorKind::quasi_periodic;
      if (!tells && decision < last_decision) continue;
      if (search_.conclude(simulation)) {
        rest_ = search_.equilibrium();
        sample_.kind = settled_kind();
        return;
      }
      std::string doubt = search_.doubt();
      if (doubt.empty()) doubt = search_.unbounded(system_);
      if (doubt.empty() && kind == AttractorKind::quasi_periodic) doubt = search_.unsettled(system_);
      bool is_told = tells && doubt.empty() && !search_.is_near_unstable_orbit();
      if (is_told && kind == AttractorKind::chaotic) {
        doubt = doubt_of_chaos(simulation, end, exponents, spectrum);
        is_told = doubt.empty();
      }
      if (!is_told && decision < last_decision) continue;
      keep_exponents(spectrum);
      if (are_volumes_kept(simulation, end)) {
        sample_.message = volumes_text(is_told ? kind : AttractorKind::none);
        return;
      }
      sample_.kind = is_told ? kind : AttractorKind::none;
      if (!is_told) sample_.message = undecided_text(spectrum, kind, doubt);
      return;
    }
  }

  static std::string volumes_text(AttractorKind kind) {
    const char* const motion = kind == AttractorKind::chaotic          ? "chaotic motion"
                               : kind == AttractorKind::quasi_periodic ? "regular motion that does not repeat itself"
                                                                       : "motion that does not repeat itself";
    return fmt::format("{}, and volumes are kept", motion);
  }

  bool are_volumes_kept(const HybridSimulation& simulation, const VectorXd& end) {
    SimulationSettings settings = plain_settings();
    LyapunovAccumulator all(system_, par_, {system_.dimension(), 0, settings.flow});
    all.attach(settings);
    HybridSimulation going_on(simulation, end, settings);
    return go_on(going_on, all, events_of_volumes) && keeps_volumes(all.spectrum(), system_.dimension());
  }

  /// "" where a positive exponent is that of chaos.
  std::string doubt_of_chaos(const HybridSimulation& simulation, const VectorXd& end,
                             const LyapunovAccumulator& exponents, const LyapunovSpectrum& spectrum) {
    const ChaosEvidence evidence =
        chaos_evidence(simulation, end, exponents.growing_direction(), spectrum.exponents.maxCoeff(), plain_settings());
    if (evidence.was_interrupted) throw SampleInterrupted();
    events_ += evidence.is_chaotic ? evidence.events : 0;
    return evidence.doubt;
  }

  std::string undecided_text(const LyapunovSpectrum& spectrum, AttractorKind kind, const std::string& doubt) const {
    std::string text = "undecided: " + largest_exponents_text(spectrum) + " are the largest exponents";
    if (!doubt.empty()) return text + "; " + doubt;
    if (kind == AttractorKind::periodic)
      text += fmt::format(", as of a periodic orbit, and none of 1 to {} events is approached",
                          setup_.request.plan.max_period);
    return text + fmt::format("; try more --transient-events, or --max-period {}", 4 * setup_.request.plan.max_period);
  }

  void keep_exponents(const LyapunovSpectrum& spectrum) {
    const Eigen::Index count = std::min<Eigen::Index>(setup_.recording.exponents, spectrum.exponents.size());
    sample_.exponents = spectrum.exponents.head(count);
    sample_.errors = spectrum.errors.head(count);
  }

  /// Up to the attractor, and so many events of it as are wanted where it does not repeat itself.
  void approach(HybridSimulation& simulation) {
    SimulationPlan plan = setup_.request.plan;
    if (!plan.time) plan.events = plan.events.value_or(100);
    bool was_transient = true;
    const Course course = settle(simulation, plan, [&](const SimulatedSegment& segment, bool is_transient) {
      if (was_transient && !is_transient) kept_.clear();
      was_transient = is_transient;
      if (segment.ended_by == SegmentEnd::end_time) return false;
      keep(segment, is_transient);
      if (goes_on(segment) && !setup_.known.empty()) sample_.known = capture_.look(segment.index, segment.after);
      return sample_.known > 0 || is_judged(simulation, segment, is_transient);
    });
    events_ = course.events;
    is_open_ = !course.is_stopped;
  }

  /// What the motion has come to with this segment: true where its kind, or why it has none, is known.
  bool is_judged(const HybridSimulation& simulation, const SimulatedSegment& segment, bool is_transient) {
    const MotionEnd end = judge_->look(simulation, segment, is_transient);
    if (end == MotionEnd::open) return false;
    if (end == MotionEnd::interrupted) throw SampleInterrupted();
    if (!goes_on(segment)) kept_.assign(1, segment);
    rest_ = judge_->equilibrium();
    sample_.kind = kind_of(end);
    if (end == MotionEnd::no_event) has_stayed_ = true;
    if (end == MotionEnd::escapes)
      sample_.message = fmt::format("it escapes: at t = {:.6g} it is far beyond where it has been", segment.end_time());
    else if (end == MotionEnd::accumulates && judge_->accumulation())
      sample_.message = fmt::format("events accumulate at t = {:.6g}", segment.end_time());
    else if (!goes_on(segment))
      sample_.message = segment.message;
    return true;
  }

  AttractorKind kind_of(MotionEnd end) {
    switch (end) {
      case MotionEnd::settled:
        return settled_kind();
      case MotionEnd::accumulates:
        return AttractorKind::chattering;
      case MotionEnd::dies_out:
        return AttractorKind::rest;
      case MotionEnd::escapes:
        return AttractorKind::escape;
      default:
        return AttractorKind::none;
    }
  }

  /// Dots are those of the orbit itself. A motion that keeps to an unstable one has no attractor.
  AttractorKind settled_kind() {
    if (rest_) return AttractorKind::rest;
    const std::vector<SimulatedSegment>& turn = search_.orbit()->turn;
    kept_.assign(turn.begin(), turn.end());
    const SettledOrbit& orbit = *search_.orbit();
    if (orbit.stability == OrbitStability::neutral && (orbit.is_corrected || orbit.is_of_family)) {
      sample_.message =
          orbit.is_of_family
              ? "a periodic orbit of a family: those beside it are closed as well"
              : fmt::format("a neutral periodic orbit: its largest multiplier has the modulus 1 within {:.1g}",
                            orbit.uncertainty);
      return AttractorKind::neutral;
    }
    if (orbit.stability != OrbitStability::unstable) return AttractorKind::periodic;
    sample_.message = "undecided: " + search_.doubt() + "; start beside it (--state)";
    return AttractorKind::none;
  }

  /// Segments of which dots are made: of the transient only what may turn out to be a period.
  void keep(const SimulatedSegment& segment, bool is_transient) {
    kept_.push_back(segment);
    const auto most = static_cast<std::size_t>(setup_.request.plan.max_period);
    while (is_transient && kept_.size() > most) kept_.pop_front();
  }

  void finish(const HybridSimulation& simulation) {
    if (kept_.empty()) return;
    if (repeats(sample_.kind)) rotate_to_smallest(kept_);
    measure_sizes(simulation);
    if (repeats(sample_.kind)) describe_period();
    describe_identity();
    describe_states();
    choose_hand_over();
  }

  /// The turn begins where its sequence of index vectors is least; among equal ones where the state is.
  template <class Turn>
  static void rotate_to_smallest(Turn& turn) {
    const auto m = turn.size();
    const auto is_less = [&](std::size_t a, std::size_t b) {
      for (std::size_t s = 0; s < m; ++s) {
        const IndexVector& u = turn[(a + s) % m].index;
        const IndexVector& v = turn[(b + s) % m].index;
        if (u != v) return u < v;
      }
      const VectorXd& x = turn[a].after;
      const VectorXd& y = turn[b].after;
      return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
    };
    std::size_t least = 0;
    for (std::size_t s = 1; s < m; ++s)
      if (is_less(s, least)) least = s;
    std::rotate(turn.begin(), turn.begin() + static_cast<std::ptrdiff_t>(least), turn.end());
  }

  void measure_sizes(const HybridSimulation& simulation) {
    if (sample_.kind == AttractorKind::rest) {
      sample_.sizes = simulation.sizes().cwiseMax(sizes_in(system_, {&kept_.back(), 1}, par_).sizes());
      return;
    }
    VectorXd low = kept_.front().low;
    VectorXd high = kept_.front().high;
    for (const SimulatedSegment& segment : kept_) {
      low = low.cwiseMin(segment.low);
      high = high.cwiseMax(segment.high);
    }
    sample_.sizes = sizes_of_differences(low, high, search_.rounding());
  }

  void measure_largest(const HybridSimulation& simulation) {
    if (!is_attractor(sample_.kind) || kept_.empty()) return;
    const Eigen::Index dots = std::max<Eigen::Index>(1, sample_.sections.cols());
    if (sample_.kind == AttractorKind::periodic)
      sample_.largest = largest_of_period(simulation).replicate(1, dots);
    else if (sample_.kind == AttractorKind::rest)
      sample_.largest = (rest_ ? *rest_ : kept_.back().end).replicate(1, dots);
    else
      sample_.largest = largest_between_events();
    for (const Eigen::Index k : search_.ignorable()) sample_.largest.row(k).setConstant(NAN);
  }

  /// One turn is simulated once more.
  VectorXd largest_of_period(const HybridSimulation& simulation) const {
    LargestValues largest(system_, par_);
    SimulationSettings settings = plain_settings();
    settings.samples = 0;
    settings.on_piece = [&largest](int field, const DenseOutput& state, double from, double to) {
      largest.add_piece(field, state, from, to);
    };
    HybridSimulation on_orbit(simulation, search_.orbit()->end, settings);
    for (std::size_t s = 0; s < kept_.size(); ++s)
      if (on_orbit.next(never).ended_by == SegmentEnd::interrupted) throw SampleInterrupted();
    return largest.values();
  }

  /// For each event up to the next of the same event function; of states recorded elsewhere, over all that is kept.
  MatrixXd largest_between_events() const {
    const Eigen::Index dots = std::max<Eigen::Index>(1, sample_.sections.cols());
    VectorXd all = kept_.front().high;
    for (const SimulatedSegment& segment : kept_) all = all.cwiseMax(segment.high);
    if (setup_.recording.states != Recording::States::all_events || dots != std::ssize(kept_))
      return all.replicate(1, dots);
    MatrixXd largest = MatrixXd::Constant(system_.dimension(), dots, NAN);
    std::map<int, VectorXd> since_event;  // behind the segment looked at, which goes backwards
    for (Eigen::Index s = dots - 1; s >= 0; --s) {
      const SimulatedSegment& segment = kept_[static_cast<std::size_t>(s)];
      if (const auto next = since_event.find(segment.index.event); next != since_event.end())
        largest.col(s) = next->second;
      since_event[segment.index.event] = VectorXd::Constant(system_.dimension(), -never);
      for (auto& [event, high] : since_event) high = high.cwiseMax(segment.high);
    }
    return largest;
  }

  void describe_period() {
    sample_.period = 0.0;
    sample_.impacts = 0;
    for (const SimulatedSegment& segment : kept_) {
      sample_.signature.push_back(segment.index);
      sample_.period += segment.duration;
      if (!is_identity_jump(system_, segment.index)) ++sample_.impacts;
    }
  }

  void describe_identity() {
    std::vector<SimulatedSegment> segments(kept_.begin(), kept_.end());
    if (const auto left = system_.without_chatter(sample_.signature); left.size() < sample_.signature.size()) {
      segments.clear();
      for (const std::size_t s : left) segments.push_back(kept_[s]);
      rotate_to_smallest(segments);
      for (const SimulatedSegment& segment : segments) sample_.without_chatter.push_back(segment.index);
    }
    std::vector<Dot> ends;
    for (const SimulatedSegment& segment : segments)
      if (segment.ended_by == SegmentEnd::event && ends.size() < identity_points)
        ends.push_back({segment.end_time(), segment.index.event, segment.after});
    sample_.identity = columns_of(ends, system_.dimension());
    if (sample_.kind == AttractorKind::rest) sample_.identity = rest_ ? *rest_ : kept_.back().end;
    // Attractors are not told apart by states that nothing depends on.
    for (const Eigen::Index k : search_.ignorable()) sample_.identity.row(k).setZero();
  }

  void describe_states() {
    const Eigen::Index n = system_.dimension();
    std::vector<Dot> dots, contacts;
    for (const SimulatedSegment& segment : kept_) {
      add_dots(segment, dots);
      if (setup_.recording.penetration > 0) add_contacts(segment, contacts);
    }
    if (setup_.recording.penetration > 0) {
      leave_out_doubles(contacts);
      describe_contacts(contacts);
    }
    if (setup_.recording.has_incoming_states()) take_incoming(contacts, dots);
    if (setup_.recording.states == Recording::States::contact) dots = std::move(contacts);
    if (setup_.recording.states == Recording::States::none) return;
    if (rest_) dots = {{0.0, no_function, *rest_}};
    sample_.sections = columns_of(dots, n);
    if (setup_.recording.states == Recording::States::all_events)
      for (const Dot& dot : dots) sample_.section_events.push_back(dot.event);
  }

  void add_dots(const SimulatedSegment& segment, std::vector<Dot>& dots) const {
    const Recording& recording = setup_.recording;
    if (recording.states == Recording::States::section)
      for (const SegmentMark& mark : segment.marks)
        if (mark.event == recording.section &&
            (mark.kind == SegmentMark::Kind::section || mark.kind == SegmentMark::Kind::violation))
          dots.push_back({mark.time, mark.event, mark.state});
    if (segment.ended_by != SegmentEnd::event) return;
    const bool ends_in_it = segment.index.event == recording.section ||
                            std::any_of(segment.simultaneous.begin(), segment.simultaneous.end(),
                                        [&](const IndexVector& other) { return other.event == recording.section; });
    if (recording.states == Recording::States::all_events ||
        (recording.states == Recording::States::section && ends_in_it))
      dots.push_back({segment.end_time(), segment.index.event, segment.end});
  }

  /// Least values of h on the smooth flow: those above zero have been seen on the way; where it fell through zero the
  /// flow is followed on to the least one.
  void add_contacts(const SimulatedSegment& segment, std::vector<Dot>& contacts) const {
    const int event = setup_.recording.penetration;
    for (const SegmentMark& mark : segment.marks) {
      if (mark.event != event) continue;
      if (mark.kind == SegmentMark::Kind::contact)
        contacts.push_back({mark.time, event, mark.state});
      else if (mark.kind != SegmentMark::Kind::beyond)
        add_least(segment.mode.field(), mark.state, mark.time, contacts);
    }
    if (segment.ended_by == SegmentEnd::event && segment.index.event == event)
      add_least(segment.mode.field(), segment.end, segment.end_time(), contacts);
  }

  void add_least(int field, const VectorXd& from, double time, std::vector<Dot>& contacts) const {
    const int event = setup_.recording.penetration;
    const auto rises = [&](const VectorXd& x) {
      return event_at(system_, event, field, x.data(), par_.data()).rate() >= 0.0;
    };
    if (rises(from)) {
      contacts.push_back({time, event, from});
      return;
    }
    if (std::optional<Dot> least = follow_smooth_flow(field, from, plain_settings().flow.max_duration, rises))
      contacts.push_back({time, event, std::move(least->state)});
  }

  /// The first state, with its time from now, of which this is so, as if there were no wall; nothing within so long.
  std::optional<Dot> follow_smooth_flow(int field, const VectorXd& from, double within,
                                        const std::function<bool(const VectorXd&)>& is_so) const {
    const std::unique_ptr<WatchedFlow> flow = make_flow(system_, field, from, par_, plain_settings().flow);
    std::optional<Dot> found;
    flow->on_piece([&](double a, double b) {
      if (!is_so(flow->state_at(b))) return true;
      for (int halving = 0; halving < 60 && a < b; ++halving) {
        const double middle = 0.5 * (a + b);
        (is_so(flow->state_at(middle)) ? b : a) = middle;
      }
      found = Dot{b, 0, flow->state_at(b)};
      return false;
    });
    flow->advance(within);
    return found;
  }

  /// Where the event function of the section, of the flow that comes in at this impact, falls through zero.
  std::optional<Dot> incoming_state(const SimulatedSegment& impact, double within) const {
    const int section = setup_.recording.section;
    bool has_been_above = system_.event(section, impact.end.data(), par_.data()) > 0.0;
    std::optional<Dot> dot = follow_smooth_flow(impact.mode.field(), impact.end, within, [&](const VectorXd& x) {
      const bool is_above = system_.event(section, x.data(), par_.data()) > 0.0;
      const bool falls = has_been_above && !is_above;
      has_been_above = has_been_above || is_above;
      return falls;
    });
    if (!dot) return dot;
    dot->time += impact.end_time();
    dot->event = section;
    return dot;
  }

  /// A least value at which an event ends the segment is seen by that segment and by the next one.
  void leave_out_doubles(std::vector<Dot>& contacts) const {
    const TimeSpan span = time_span();
    const double apart = same_time * longest_segment();
    const auto is_double = [&](const Dot& a, const Dot& b) {
      return std::min(span.from_to(a.time, b.time), span.from_to(b.time, a.time)) <= apart;
    };
    contacts.erase(std::unique(contacts.begin(), contacts.end(), is_double), contacts.end());
    if (span.period && contacts.size() > 1 && is_double(contacts.back(), contacts.front())) contacts.pop_back();
  }

  double longest_segment() const {
    double longest = 0.0;
    for (const SimulatedSegment& segment : kept_) longest = std::max(longest, segment.duration);
    return longest;
  }

  TimeSpan time_span() const {
    TimeSpan span{kept_.front().start_time, {}};
    if (repeats(sample_.kind)) span.period = sample_.period;
    return span;
  }

  /// Of states on a section those of the flow that comes in, each with the penetration of the contact beside it.
  void take_incoming(const std::vector<Dot>& contacts, std::vector<Dot>& dots) {
    const TimeSpan span = time_span();
    std::vector<const SimulatedSegment*> impacts;
    std::vector<double> times;
    for (const SimulatedSegment& segment : kept_) {
      if (segment.ended_by != SegmentEnd::event || segment.index.event != setup_.recording.penetration) continue;
      impacts.push_back(&segment);
      times.push_back(segment.end_time());
    }
    dots = incoming_states(dots, times, span,
                           [&](std::size_t k, double within) { return incoming_state(*impacts[k], within); });
    const std::vector<int> nearest = nearest_contacts(dots, contacts, span);
    sample_.section_penetrations = VectorXd::Constant(static_cast<Eigen::Index>(dots.size()), NAN);
    for (std::size_t k = 0; k < dots.size(); ++k)
      if (nearest[k] >= 0)
        sample_.section_penetrations(static_cast<Eigen::Index>(k)) = -system_.event(
            setup_.recording.penetration, contacts[static_cast<std::size_t>(nearest[k])].state.data(), par_.data());
  }

  void describe_contacts(const std::vector<Dot>& contacts) {
    VectorXd penetrations(static_cast<Eigen::Index>(contacts.size()));
    for (std::size_t k = 0; k < contacts.size(); ++k)
      penetrations(static_cast<Eigen::Index>(k)) =
          -system_.event(setup_.recording.penetration, contacts[k].state.data(), par_.data());
    if (penetrations.size() > 0) sample_.penetration = penetrations.maxCoeff();
    if (setup_.recording.states == Recording::States::contact) sample_.section_penetrations = penetrations;
  }

  /// Where a neighbouring value goes on: far from all walls, which may be elsewhere there. Otherwise after the last
  /// event.
  void choose_hand_over() {
    const SimulatedSegment& last = kept_.back();
    if (last.ended_by != SegmentEnd::event) {
      sample_.last = {last.end, last.mode.index_vectors};
      return;
    }
    if (sample_.kind == AttractorKind::periodic || !setup_.follows) {
      const SimulatedSegment& first = kept_.front();
      sample_.last = {last.after,
                      sample_.kind == AttractorKind::periodic ? first.mode.index_vectors : std::vector<IndexVector>{}};
    }
    if (!setup_.follows) return;
    double widest = -never;
    const auto most = static_cast<std::size_t>(setup_.request.plan.max_period);
    for (std::size_t s = kept_.size() - std::min(kept_.size(), most); s < kept_.size(); ++s)
      for (const Sample& at : kept_[s].samples) {
        const double room = distance_to_walls(kept_[s].mode, at.state);
        if (room <= widest) continue;
        widest = room;
        sample_.last = {at.state, kept_[s].mode.index_vectors};
      }
  }

  /// What is watched after a segment, where the problem says it.
  std::vector<IndexVector> following(const SimulatedSegment& last) const {
    if (setup_.request.signature || setup_.request.follow_signature) return {};
    return system_.successors(last.index, last.end.data(), par_.data()).value_or(std::vector<IndexVector>{});
  }

  double distance_to_walls(const Mode& mode, const VectorXd& x) const {
    double least = never;
    for (const IndexVector& v : mode.index_vectors)
      if (!is_identity_jump(system_, v)) least = std::min(least, system_.event(v.event, x.data(), par_.data()));
    return least;
  }

  const SamplerSetup& setup_;
  const HybridSystem& system_;
  const SweepPoint& point_;
  const std::function<bool()>& interrupted_;
  VectorXd par_, start_;
  StartSide side_;
  AttractorSearch search_;
  std::optional<MotionJudge> judge_;
  Capture capture_;
  long events_ = 0;
  std::optional<VectorXd> rest_;  // the equilibrium that the motion comes to
  bool has_stayed_ = false;
  bool is_open_ = false;  // it has been simulated as long as wanted, and has not repeated itself
  std::deque<SimulatedSegment> kept_;
  AttractorSample sample_;
};

}  // namespace

SampleStart sample_start(const SamplerSetup& setup, const SweepPoint& point) {
  const auto number = static_cast<std::size_t>(point.start) - 1;
  SampleStart start{setup.starts[number], setup.par, setup.sides[number]};
  set_swept_values(setup.over, point.values, start.state, start.par);
  for (const SweepTarget& target : setup.over)
    if (target.quantity.is_state) start.side = setup.request.side;  // no longer the start of an orbit
  if (point.at) start = {point.at->x, start.par, {StartSide::Given::after, 0}};
  return start;
}

AttractorSample SimulationSampler::operator()(const SweepPoint& point, const std::function<bool()>& interrupted) const {
  SampleRun run(setup_, system_, point, interrupted);
  AttractorSample sample = run.run();
  if (!run.has_stayed() || !point.at) return sample;
  // What the neighbouring value has handed over has lost its stability: the motion begins at its start instead.
  SweepPoint own = point;
  own.at.reset();
  return SampleRun(setup_, system_, own, interrupted).run();
}

}  // namespace tchat
