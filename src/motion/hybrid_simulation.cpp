#include "motion/hybrid_simulation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/messages.hpp"
#include "model/events.hpp"
#include "model/function_values.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

void add_once(std::vector<int>& events, int event) {
  if (std::find(events.begin(), events.end(), event) == events.end()) events.push_back(event);
}

std::string one(const IndexVector& v) { return fmt::format("({},{},{})", v.field, v.event, v.jump); }

}  // namespace

std::string state_text(const VectorXd& x) {
  constexpr Eigen::Index most_shown = 12;
  const Eigen::Index shown = std::min(x.size(), most_shown);
  const std::string more = x.size() > shown ? fmt::format(", and {} more", x.size() - shown) : "";
  return fmt::format("({:.6g}{})", fmt::join(x.begin(), x.begin() + shown, ", "), more);
}

std::vector<int> Mode::terminal_events() const {
  std::vector<int> events;
  for (const IndexVector& v : index_vectors) add_once(events, v.event);
  return events;
}

std::vector<int> Mode::all_events() const {
  std::vector<int> events = terminal_events();
  for (const int event : monitored) add_once(events, event);
  return events;
}

const IndexVector& Mode::ended_by(int event) const {
  return *std::find_if(index_vectors.begin(), index_vectors.end(), [&](const auto& v) { return v.event == event; });
}

std::string fault_of(const HybridSystem& system, const std::vector<IndexVector>& index_vectors) {
  if (index_vectors.empty()) return "no index vector at all";
  const auto limit = [&](const char* what, int index, FunctionKind kind, const IndexVector& v) -> std::string {
    if (index >= 1 && index <= system.count(kind)) return "";
    return fmt::format("{}: {} {} does not exist, {} has 1..{}", one(v), what, index, system.name(),
                       system.count(kind));
  };
  for (const IndexVector& v : index_vectors) {
    for (const std::string& fault :
         {limit("field", v.field, FunctionKind::field, v), limit("event function", v.event, FunctionKind::event, v),
          limit("jump", v.jump, FunctionKind::jump, v)})
      if (!fault.empty()) return fault;
    if (v.field != index_vectors.front().field)
      return fmt::format("{} and {}: index vectors watched together must have the same field",
                         one(index_vectors.front()), one(v));
  }
  return "";
}

Mode ModeRule::of_cycle(const IndexVector& from, const VectorXd& x, const VectorXd& par) const {
  Mode mode = cycle_[position_];
  if (monitor_ == Monitor::as_given) return mode;
  const auto following = system_.successors(from, x.data(), par.data()).value_or(std::vector<IndexVector>{});
  const bool goes_on =
      std::any_of(following.begin(), following.end(), [&](const IndexVector& v) { return v.field == mode.field(); });
  if (!goes_on) return mode;
  mode.monitored = relevant_events(system_, following, mode.field(), x.data(), par.data());
  std::erase(mode.monitored, mode.index_vectors.front().event);
  return mode;
}

Mode ModeRule::first(const VectorXd& x, const VectorXd& par) {
  position_ = 0;
  if (is_cyclic()) return of_cycle(cycle_.back().index_vectors.front(), x, par);
  if (start_) return *start_;
  const auto start = system_.successors({0, 0, 0}, x.data(), par.data());
  if (!start || start->empty())
    throw UserError(
        fmt::format("{} does not say in which mode a simulation starts (its successors of (0,0,0) at the start); say "
                    "which index vectors to watch, as in --mode 1,2,1 or --mode '1,2,1;1,3,2'",
                    system_.name()));
  if (const std::string fault = fault_of(system_, *start); !fault.empty())
    throw UserError(
        fmt::format("the successors that {} gives for a start, (0,0,0), cannot be watched: {}", system_.name(), fault));
  return {*start, {}};
}

Mode ModeRule::next(const IndexVector& from, const VectorXd& x, const VectorXd& par) {
  if (is_cyclic()) {
    position_ = (position_ + 1) % cycle_.size();
    return of_cycle(from, x, par);
  }
  const auto next = system_.successors(from, x.data(), par.data());
  const std::string fault = next ? fault_of(system_, *next) : "it cannot be evaluated";
  if (fault.empty()) return {*next, {}};
  fault_ = fmt::format("the index jump function (successors) of {} at the end of {}, x = {}: {}", system_.name(),
                       one(from), state_text(x), fault);
  return {};
}

namespace {

VectorXd image_of(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par) {
  VectorXd image(x.size());
  system.value(FunctionKind::jump, index.jump, x.data(), par.data(), image.data());
  return image;
}

/// |h| up to which x counts as on the surface of a start.
double widest_on_surface(const EventAt& at, const VectorXd& x, const StateAccuracy& known) {
  const double typed = start_tolerance * at.gradient.cwiseProduct(x).cwiseAbs().sum();
  return std::max(typed, known.share * at.scale(x.data(), known.sizes));
}

/// Does the jump send x to a point of the same surface where h falls again, in a mode that watches the event?
bool falls_again(ModeRule rule, const IndexVector& index, const VectorXd& x, const VectorXd& par,
                 const StateAccuracy& known) {
  const HybridSystem& system = rule.system();
  const Mode next = rule.next(index, x, par);
  if (next.index_vectors.empty()) return false;
  const std::vector<int> events = next.terminal_events();
  if (std::find(events.begin(), events.end(), index.event) == events.end()) return false;
  const VectorXd image = image_of(system, index, x, par);
  if (!image.allFinite()) return false;
  const EventAt at = event_at(system, index.event, next.field(), image.data(), par.data());
  return std::abs(at.h) <= widest_on_surface(at, image, known) && at.rate() < 0.0;
}

bool changes_field(ModeRule rule, const IndexVector& index, const VectorXd& x, const VectorXd& par) {
  const Mode next = rule.next(index, x, par);
  return !next.index_vectors.empty() && next.field() != index.field;
}

/// Nothing where the event needs no decision: the start is away from its surface, or the jump changes nothing and no
/// other field follows a start that is said to be before the event.
std::optional<SurfaceStart> judge(const ModeRule& rule, const IndexVector& index, const VectorXd& x,
                                  const VectorXd& par, const StartSide& side, const StateAccuracy& known) {
  const HybridSystem& system = rule.system();
  const EventAt at = event_at(system, index.event, index.field, x.data(), par.data());
  if (!(at.rate() < 0.0) || std::abs(at.h) > widest_on_surface(at, x, known)) return std::nullopt;
  const bool is_on = std::abs(at.h) <= known.share * at.scale(x.data(), known.sizes);
  const bool is_wall = reverses_flow(system, index, x, par);
  SurfaceStart start{index, at.h, false, false};
  if (side.given == StartSide::Given::after && (side.event == index.event || (side.event == 0 && !is_wall))) {
    start.is_after = true;
    return start;
  }
  if (side.given != StartSide::Given::before && is_wall) return is_on ? std::optional(start) : std::nullopt;
  const bool is_before = side.given == StartSide::Given::before;
  if (is_before && changes_field(rule, index, x, par)) return start;
  if (!is_wall && !moves_state(system, index, x, par, known)) return std::nullopt;
  if (is_before) return start;
  start.is_undecided = true;
  start.is_after = (is_on || at.h < 0.0) && falls_again(rule, index, x, par, known);
  return is_on || start.is_after ? std::optional(start) : std::nullopt;
}

}  // namespace

bool reverses_flow(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par) {
  const VectorXd image = image_of(system, index, x, par);
  const double before = event_at(system, index.event, index.field, x.data(), par.data()).rate();
  const double after = event_at(system, index.event, index.field, image.data(), par.data()).rate();
  return before * after < 0.0;
}

bool moves_state(const HybridSystem& system, const IndexVector& index, const VectorXd& x, const VectorXd& par,
                 const StateAccuracy& known) {
  const VectorXd change = (image_of(system, index, x, par) - x).cwiseAbs();
  return (change.array() > known.share * x.cwiseAbs().cwiseMax(known.sizes).array()).any();
}

std::vector<SurfaceStart> surface_starts(const ModeRule& rule, const Mode& mode, const VectorXd& x, const VectorXd& par,
                                         const StartSide& side, const StateAccuracy& known) {
  std::vector<SurfaceStart> starts;
  for (const IndexVector& index : mode.index_vectors) {
    const bool is_known = std::any_of(starts.begin(), starts.end(),
                                      [&](const SurfaceStart& start) { return start.index.event == index.event; });
    if (is_known) continue;
    if (const auto start = judge(rule, index, x, par, side, known)) starts.push_back(*start);
  }
  return starts;
}

namespace {

using Eigen::RowVectorXd;

constexpr int points_of_piece = 4;  // looked at in each integration step; kept, before thinning

bool contains(const std::vector<int>& events, int event) {
  return std::find(events.begin(), events.end(), event) != events.end();
}

/// Every second sample, first and last included.
void halve(std::vector<Sample>& samples) {
  const std::size_t last = samples.size() - 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < last; i += 2) samples[kept++] = std::move(samples[i]);
  samples[kept++] = std::move(samples[last]);
  samples.resize(kept);
}

/// At most `count` samples, first and last included: half of their density follows time, half the integrator's steps.
void thin(std::vector<Sample>& samples, std::size_t count) {
  if (samples.size() <= count || count < 2) return;
  const std::size_t last = samples.size() - 1;
  const double begin = samples.front().time;
  const double span = samples.back().time - begin;
  const auto weight = [&](std::size_t i) {
    return 0.5 * (samples[i].time - begin) / span + 0.5 * static_cast<double>(i) / static_cast<double>(last);
  };
  std::vector<Sample> kept;
  std::size_t i = 0;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double target = static_cast<double>(k) / static_cast<double>(count - 1);
    while (i < last && weight(i) < target) ++i;
    if (i < last) kept.push_back(std::move(samples[i++]));
  }
  kept.push_back(std::move(samples[last]));
  samples = std::move(kept);
}

void require_state(const HybridSystem& system, const VectorXd& x) {
  if (x.size() != system.dimension())
    throw UserError(fmt::format("the start has {} states, {} has {}", x.size(), system.name(), system.dimension()));
  if (!x.allFinite()) throw UserError(fmt::format("the start {} is not finite", state_text(x)));
}

}  // namespace

HybridSimulation::HybridSimulation(ModeRule rule, const VectorXd& x0, const VectorXd& par, SimulationSettings settings)
    : rule_(std::move(rule)), system_(rule_.system()), par_(par), settings_(std::move(settings)), x_(x0) {
  require_state(system_, x0);
  settings_.flow.variational = false;
  mode_ = rule_.first(x0, par_);
  clear_absent(system_, mode_.field(), x_);
  if (settings_.flow.sizes.size() != x_.size()) settings_.flow.sizes = first_sizes();
  leave_contact();
  surface_starts_ = tchat::surface_starts(rule_, mode_, x_, par_, settings_.side, accuracy());
}

/// In contact also those of the field that comes after it: the velocity that contact keeps at zero has none of its own.
VectorXd HybridSimulation::first_sizes() const {
  if (mode_.index_vectors.empty()) return x_.cwiseAbs();
  const VectorXd sizes = sizes_at(system_, mode_.field(), x_, par_);
  const tchat_chatter* const chatter = system_.chatter_in_contact(mode_.field());
  return chatter == nullptr ? sizes : sizes.cwiseMax(sizes_at(system_, chatter->field, x_, par_));
}

/// A start in contact behind its release leaves it at once. Not by the jump, which puts states on the release.
void HybridSimulation::leave_contact() {
  const tchat_chatter* const chatter =
      mode_.index_vectors.empty() || is_cyclic() ? nullptr : system_.chatter_in_contact(mode_.field());
  if (chatter == nullptr) return;
  const Surface release = surface(chatter->contact, chatter->release, x_);
  if (release.is_near || !(release.h < 0.0)) return;
  Mode free = rule_.next({chatter->contact, chatter->release, chatter->leave}, x_, par_);
  if (free.index_vectors.empty()) return;
  mode_ = std::move(free);
  released_ = chatter->release;
}

HybridSimulation::HybridSimulation(const HybridSimulation& at, const VectorXd& end, SimulationSettings settings)
    : HybridSimulation(at) {
  settings_ = std::move(settings);
  settings_.flow.sizes = at.sizes();
  settings_.flow.variational = false;
  before_jump_ = end;
  system_.value(FunctionKind::jump, last_.jump, end.data(), par_.data(), x_.data());
}

HybridSimulation::Surface HybridSimulation::surface(int field, int event, const VectorXd& x) const {
  const EventAt at = event_at(system_, event, field, x.data(), par_.data());
  const bool is_at_rest = std::abs(at.rate()) <= level::rounding_of_sums * at.rate_scale(sizes());
  return {at.h, is_at_rest ? 0.0 : at.rate(),
          std::abs(at.h) <= settings_.flow.surface_tolerance * at.scale(x.data(), sizes())};
}

/// Does the jump send the flow back from the surface, as an impact does?
bool HybridSimulation::is_wall(const IndexVector& index, const VectorXd& x) const {
  return walls_.contains(index.event) || reverses_flow(system_, index, x, par_);
}

bool HybridSimulation::leaves_downwards(const IndexVector& index) const {
  const Surface at = surface(index.field, index.event, x_);
  return at.is_near && at.rate < 0.0 && !is_wall(index, x_) && !moves_state(system_, index, x_, par_, accuracy());
}

SimulatedSegment HybridSimulation::next(double end_time) {
  SimulatedSegment segment = begin_segment();
  if (segment.ended_by != SegmentEnd::event) return segment;
  if (sticks_at_start(segment)) return segment;
  for (const int event : walls_behind()) {
    const Surface at = surface(mode_.field(), event, x_);
    segment.marks.push_back({SegmentMark::Kind::beyond, event, time_, at.h, at.rate, x_});
  }
  if (const std::vector<int> due = due_at_start(segment); !due.empty())
    end_by(segment, due);
  else
    integrate(segment, end_time);
  return segment;
}

SimulatedSegment HybridSimulation::begin_segment() {
  SimulatedSegment segment;
  segment.number = ++segments_;
  segment.start_time = time_;
  segment.start = segment.end = segment.low = segment.high = x_;
  if (last_.field != 0 && !is_cut_) mode_ = rule_.next(last_, std::exchange(before_jump_, {}), par_);
  is_cut_ = true;
  segment.mode = mode_;
  if (mode_.index_vectors.empty())
    stop(segment, SegmentEnd::failed, rule_.fault());
  else if (const std::string fault = last_.field != 0 ? mode_fault(system_, last_, mode_.field()) : ""; !fault.empty())
    stop(segment, SegmentEnd::failed, fault);
  if (settings_.samples > 0) segment.samples.push_back({time_, x_});
  return segment;
}

void HybridSimulation::stop(SimulatedSegment& segment, SegmentEnd why, std::string message) const {
  segment.ended_by = why;
  segment.message = std::move(message);
}

/// The event that has just ended a segment with an impact, and now the flow goes into h < 0 all the same.
bool HybridSimulation::sticks_at_start(SimulatedSegment& segment) const {
  if (!contains(mode_.terminal_events(), last_.event) || contains(pending_, last_.event)) return false;
  const Surface at = surface(mode_.field(), last_.event, x_);
  const bool is_thrown_back_to_rest = last_rate_ < 0.0 && at.rate >= 1e-3 * last_rate_;
  const bool is_of_chatter = system_.chatter_of_impact(last_) != nullptr && last_rate_ < 0.0;
  if (!at.is_near || at.rate > 0.0 || !(walls_.contains(last_.event) || is_thrown_back_to_rest || is_of_chatter))
    return false;
  if (is_of_chatter) {
    stop(segment, SegmentEnd::sticks,
         fmt::format(
             "after jump {} ({}) the flow goes on through {} at once, at x = {}: restitution {:.3g}, and impacts "
             "accumulate where that is between 0 and 1: change the jump, or let another mode follow it",
             last_.jump, system_.function_name(FunctionKind::jump, last_.jump),
             system_.function_name(FunctionKind::event, last_.event), state_text(x_), -at.rate / last_rate_));
    return true;
  }
  stop(segment, SegmentEnd::sticks,
       fmt::format("after the jump the flow goes on through {} at once, at x = {}: the contact lasts, and the problem "
                   "has no mode for that",
                   system_.function_name(FunctionKind::event, last_.event), state_text(x_)));
  return true;
}

std::vector<int> HybridSimulation::walls_behind() const {
  std::vector<int> events;
  for (const IndexVector& index : mode_.index_vectors)
    if (const Surface at = surface(index.field, index.event, x_); at.h < 0.0 && !at.is_near && is_wall(index, x_))
      events.push_back(index.event);
  return events;
}

/// Events that happen at the very start: those of surface_starts() where the simulation begins; else they came together
/// with the last one, or the segment starts on a wall and moves into it.
std::vector<int> HybridSimulation::due_at_start(const SimulatedSegment& segment) const {
  std::vector<int> due;
  if (begins()) {
    for (const SurfaceStart& start : surface_starts_)
      if (!start.is_after) due.push_back(start.index.event);
    return due;
  }
  for (const IndexVector& index : segment.mode.index_vectors) {
    const bool is_pending = contains(pending_, index.event);
    if ((!is_pending && index.event == last_.event) || contains(due, index.event)) continue;
    const Surface at = surface(index.field, index.event, x_);
    if (at.is_near && at.rate < 0.0 && (is_pending || is_wall(index, x_))) due.push_back(index.event);
  }
  return due;
}

bool HybridSimulation::pass_piece(SimulatedSegment& segment, const WatchedFlow& flow, double from, double to) {
  const VectorXd x = flow.state_at(to);
  for (const int event : watched_) {
    double& largest = largest_[event];
    largest = std::max(largest, system_.event(event, x.data(), par_.data()));
  }
  const DenseOutput& inside = flow.dense_output();
  const auto note = [&](double t, const Eigen::Map<const VectorXd>& state) {
    segment.low = segment.low.cwiseMin(state);
    segment.high = segment.high.cwiseMax(state);
    if (settings_.samples > 0) segment.samples.push_back({segment.start_time + t, state});
  };
  for (int k = 1; k < points_of_piece; ++k) {
    const double t = from + (to - from) * k / points_of_piece;
    note(t, Eigen::Map<const VectorXd>(inside(t), x.size()));
  }
  note(to, Eigen::Map<const VectorXd>(x.data(), x.size()));
  if (settings_.samples > 0 && segment.samples.size() > 50 * settings_.samples) halve(segment.samples);
  if (settings_.on_piece && from < to) settings_.on_piece(segment.mode.field(), inside, from, to);
  return !(settings_.interrupted && settings_.interrupted());
}

void HybridSimulation::note_contacts(SimulatedSegment& segment, WatchedFlow& flow) const {
  for (const EventWatch::Contact& contact : flow.take_contacts()) {
    const auto largest = largest_.find(contact.event);
    if (largest == largest_.end() || contact.h > settings_.contact * largest->second) continue;
    segment.marks.push_back(
        {SegmentMark::Kind::contact, contact.event, segment.start_time + contact.time, contact.h, 0.0, contact.state});
  }
}

std::vector<int> HybridSimulation::watched_events() const {
  std::vector<int> events = mode_.all_events();
  for (const int section : settings_.sections)
    if (!contains(events, section)) events.push_back(section);
  return events;
}

/// Events after which the simulation begins, in its first segment.
std::vector<int> HybridSimulation::events_begun_after() const {
  std::vector<int> events;
  if (!begins()) return events;
  for (const SurfaceStart& start : surface_starts_)
    if (start.is_after) events.push_back(start.index.event);
  return events;
}

void HybridSimulation::integrate(SimulatedSegment& segment, double end_time) {
  const std::unique_ptr<WatchedFlow> integrated = make_flow(system_, mode_.field(), x_, par_, settings_.flow);
  WatchedFlow& flow = *integrated;
  watched_ = watched_events();
  flow.watch(watched_, events_begun_after());
  long steps = 0;
  flow.on_piece([&](double from, double to) {
    return pass_piece(segment, flow, from, to) && ++steps < settings_.steps_without_event;
  });
  const std::vector<int> terminal = mode_.terminal_events();
  const double left = end_time - time_;
  const double until = std::min(left, settings_.flow.max_duration);
  Progress progress = until > 0.0 ? flow.advance(until) : Progress::end_time;
  while (progress == Progress::root && !contains(terminal, flow.fallen())) {
    const VectorXd x = flow.state();
    const Surface at = surface(mode_.field(), flow.fallen(), x);
    const bool is_violation = contains(mode_.monitored, flow.fallen());
    segment.marks.push_back({is_violation ? SegmentMark::Kind::violation : SegmentMark::Kind::section, flow.fallen(),
                             time_ + flow.time(), at.h, at.rate, x});
    progress = flow.advance(until);
  }
  segment.duration = flow.time();
  segment.end = flow.state();
  settings_.flow.sizes = sizes().cwiseMax(segment.low.cwiseAbs()).cwiseMax(segment.high.cwiseAbs());
  note_contacts(segment, flow);
  if (settings_.samples > 0) thin(segment.samples, settings_.samples);
  std::sort(segment.marks.begin(), segment.marks.end(), [](const auto& a, const auto& b) { return a.time < b.time; });

  if (progress == Progress::stopped && steps >= settings_.steps_without_event)
    return stop(segment, SegmentEnd::no_event,
                fmt::format("no event within {} integration steps after t = {:.10g}, up to t = {:.10g}", steps, time_,
                            time_ + segment.duration));
  if (progress == Progress::stopped) return stop(segment, SegmentEnd::interrupted, "interrupted");
  if (progress == Progress::failed) return stop(segment, SegmentEnd::failed, flow.message());
  if (progress == Progress::end_time && left <= settings_.flow.max_duration)
    return stop(segment, SegmentEnd::end_time, "");
  if (progress == Progress::end_time)
    return stop(segment, SegmentEnd::no_event,
                fmt::format("no event within {:g} time units after t = {:.10g}", settings_.flow.max_duration, time_));

  std::vector<int> together{flow.fallen()};
  for (const int event : terminal) {
    if (event == flow.fallen() || !flow.is_armed(event)) continue;
    const Surface at = surface(mode_.field(), event, segment.end);
    if (at.is_near && at.rate < 0.0) together.push_back(event);
  }
  end_by(segment, together);
}

double HybridSimulation::time_uncertainty(const SimulatedSegment& ended) const {
  const EventAt at = event_at(system_, ended.index.event, ended.end.data(), par_.data());
  return settings_.flow.relative_tolerance * at.scale(ended.end.data(), sizes()) / std::abs(ended.event_velocity);
}

void HybridSimulation::end_by(SimulatedSegment& segment, const std::vector<int>& together) {
  // The first in the mode's order has priority.
  for (const IndexVector& index : mode_.index_vectors) {
    if (!contains(together, index.event)) continue;
    if (segment.index.field == 0)
      segment.index = index;
    else if (index.event != segment.index.event)
      segment.simultaneous.push_back(index);
  }
  segment.after.resize(segment.end.size());
  system_.value(FunctionKind::jump, segment.index.jump, segment.end.data(), par_.data(), segment.after.data());
  const int ended = segment.index.event;
  segment.event_velocity = surface(mode_.field(), ended, segment.end).rate;
  if (!segment.after.allFinite())
    return stop(segment, SegmentEnd::failed,
                undefined_value(system_, FunctionKind::jump, segment.index.jump, segment.end.data()));
  if (segment.event_velocity < 0.0 && surface(mode_.field(), ended, segment.after).rate > 0.0) walls_.insert(ended);
  pending_.clear();
  for (const IndexVector& other : segment.simultaneous) pending_.push_back(other.event);
  last_ = segment.index;
  last_rate_ = segment.event_velocity;
  before_jump_ = segment.end;
  is_cut_ = false;
  x_ = segment.after;
  time_ = segment.end_time();
}

}  // namespace tchat
