#include "motion/attractor_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t points_looked_at = 6;
constexpr long first_nearby = 48;  // events
constexpr std::size_t most_passed = 8192;
constexpr long first_gap = 8;             // events between two tries where the motion repeats itself
constexpr double near = 0.05;             // states one period apart, in ranges
constexpr int most_nearby = 3;            // candidates of one try
constexpr double longest_segment = 10.0;  // of an orbit nearby, in durations of the motion's turn
constexpr long held_events = 64;          // for so long a motion that cannot be corrected repeats itself
constexpr double held_movement = 10.0;    // recognitions

/// "a multiplier of modulus 1.0123 (+- 1e-08)"
std::string modulus_text(const CorrectedOrbit& orbit) {
  return fmt::format("a multiplier of modulus {:.8g} (+- {:.1g})",
                     orbit.multipliers.empty() ? 0.0 : std::abs(orbit.multipliers.front()), orbit.uncertainty);
}

}  // namespace

AttractorSearch::AttractorSearch(int max_period, double recognition, SimulationSettings settings)
    : max_period_(max_period),
      recognition_(recognition),
      settings_(std::move(settings)),
      recurrence_(max_period, recognition),
      next_nearby_(first_nearby),
      gap_(first_gap) {
  settings_.on_piece = {};
}

void AttractorSearch::find_ignorable(const HybridSimulation& motion, const SimulatedSegment& segment) {
  points_.push_back(segment.start);
  points_.push_back(segment.end);
  const std::vector<bool> flags = ignorable_states(motion.system(), points_, motion.parameters());
  recurrence_.ignore(flags);
  ignorable_.clear();
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) ignorable_.push_back(static_cast<Index>(i));
}

namespace {

/// Which of the tiny states are nothing but rounding of zero?
std::vector<bool> rounding_among(std::vector<bool> tiny, const HybridSimulation& motion,
                                 const SimulatedSegment& segment) {
  if (std::find(tiny.begin(), tiny.end(), true) == tiny.end()) return {};
  const std::vector<bool> known = sizes_in(motion.system(), {&segment, 1}, motion.parameters()).known();
  for (std::size_t i = 0; i < tiny.size(); ++i) tiny[i] = tiny[i] && !known[i];
  return tiny;
}

}  // namespace

void AttractorSearch::add(const HybridSimulation& motion, const SimulatedSegment& segment) {
  if (points_.size() < points_looked_at) find_ignorable(motion, segment);
  recurrence_.add(segment);
  range_.add(segment);
  event_ranges_.add(segment);
  rounding_ = rounding_among(recurrence_.tiny_states(), motion, segment);
  recurrence_.take_for_rounding(rounding_);
  last_.push_back(segment);
  if (last_.size() > static_cast<std::size_t>(max_period_)) last_.pop_front();
  passed_.push_back({segment.index, segment.end});
  if (passed_.size() > most_passed) passed_.pop_front();
  ++events_;
}

/// States whose range says nothing.
std::vector<bool> AttractorSearch::left_out() const {
  std::vector<bool> states = rounding_;
  if (!last_.empty()) states.resize(static_cast<std::size_t>(last_.back().end.size()), false);
  for (const Index k : ignorable_) states[static_cast<std::size_t>(k)] = true;
  return states;
}

std::string AttractorSearch::unsettled(const HybridSystem& system) const {
  const std::optional<EventRanges::Change> change = event_ranges_.changing(left_out());
  if (!change) return "";
  const std::string what =
      change->shift > std::abs(1.0 - change->range)
          ? fmt::format("it has moved by {:.2g} of the range that it covered before", change->shift)
          : fmt::format("it covers {:.2g} of the range that it did before", change->range);
  return fmt::format("{} at {} still changes: {}", system.state_name(static_cast<int>(change->state) + 1),
                     system.function_name(FunctionKind::event, change->index.event), what);
}

std::string AttractorSearch::unbounded(const HybridSystem& system) const {
  const std::optional<Index> state = range_.growing(left_out());
  if (!state) return "";
  const double growth = range_.growth(*state);
  return fmt::format("the range of {} still grows{}", system.state_name(static_cast<int>(*state) + 1),
                     std::isfinite(growth) ? fmt::format(", {:.3g}-fold since half of the events", growth) : "");
}

/// States of the last event and of those a whole number of periods before it, as long as the events repeat themselves.
std::vector<VectorXd> AttractorSearch::passed(std::size_t period) const {
  std::vector<VectorXd> states;
  for (std::size_t back = 1; back <= passed_.size(); ++back) {
    const Passed& at = passed_[passed_.size() - back];
    if (back > period && at.index != passed_[passed_.size() - back + period].index) break;
    if ((back - 1) % period == 0) states.push_back(at.end);
  }
  std::reverse(states.begin(), states.end());
  return states;
}

bool AttractorSearch::has_settled(const HybridSimulation& motion, const SimulatedSegment& segment) {
  add(motion, segment);
  const std::optional<int> period = recurrence_.period();
  if (!period) held_.reset();
  if (period && held_ && keeps_repeating(motion, *period)) return true;
  if (period && events_ >= next_recurrence_) {
    if (try_recurrence(motion, *period)) return true;
    next_recurrence_ = events_ + gap_;
    gap_ *= 2;
  }
  if (events_ < next_nearby_) return false;
  next_nearby_ = 2 * events_;
  return try_nearby(motion) || try_rest(motion);
}

bool AttractorSearch::conclude(const HybridSimulation& motion) {
  const std::optional<int> period = recurrence_.period();
  if (period ? try_recurrence(motion, *period) : try_nearby(motion)) return true;
  if (period) orbit_ = kept_to_;
  return orbit_.has_value() || try_rest(motion);
}

bool AttractorSearch::try_rest(const HybridSimulation& motion) {
  if (last_.empty()) return false;
  const IndexVector& index = last_.back().index;
  const auto is_alike = [&index](const auto& event) { return event.index == index; };
  const auto least = static_cast<std::size_t>(std::count_if(last_.begin(), last_.end(), is_alike));
  std::vector<VectorXd> states;  // the newest first
  for (std::size_t back = 1; back <= passed_.size() && (2 * back <= passed_.size() || states.size() < least); ++back)
    if (const Passed& at = passed_[passed_.size() - back]; is_alike(at)) states.push_back(at.end);
  std::reverse(states.begin(), states.end());
  equilibrium_ = approached_equilibrium(motion.system(), index, states, least, motion.parameters(), ignorable_,
                                        motion.sizes(), settings_.flow.relative_tolerance);
  return equilibrium_.has_value();
}

/// The shortest part of the period that repeats itself comes first: what is not near itself after fewer events has an
/// orbit of fewer events elsewhere at most.
bool AttractorSearch::try_recurrence(const HybridSimulation& motion, int period) {
  doubt_.clear();
  is_near_unstable_ = false;
  for (int q = 1; q <= period; ++q)
    if (period % q == 0 && recurrence_.repeats_events(static_cast<std::size_t>(q)) &&
        (q == period || recurrence_.difference(static_cast<std::size_t>(q)) <= near) &&
        try_period(motion, static_cast<std::size_t>(q)))
      return true;
  return false;
}

bool AttractorSearch::try_nearby(const HybridSimulation& motion) {
  doubt_.clear();
  is_near_unstable_ = false;
  int tried = 0;
  for (std::size_t q = 1; q <= static_cast<std::size_t>(max_period_) && tried < most_nearby; ++q) {
    if (!recurrence_.repeats_events(q)) continue;
    // A motion that goes round a slow focus is never near where it was.
    if (tried > 0 && !(recurrence_.difference(q) <= near)) continue;
    if (try_period(motion, q)) return true;
    ++tried;
  }
  return false;
}

double AttractorSearch::duration_of_last(std::size_t events) const {
  double sum = 0.0;
  for (std::size_t back = 1; back <= events; ++back) sum += last_[last_.size() - back].duration;
  return sum;
}

bool AttractorSearch::try_period(const HybridSimulation& motion, std::size_t period) {
  SimulationSettings settings = settings_;
  settings.flow.max_duration = std::min(settings.flow.max_duration, longest_segment * duration_of_last(period));
  const OrbitCandidate candidate{
      motion,   last_.back().end, recurrence_.last(period), recurrence_.scale(2 * period), ignorable_,
      settings, passed(period)};
  const CorrectedOrbit corrected = correct_orbit(candidate);
  const bool repeats = recurrence_.period() == static_cast<int>(period);
  SettledOrbit found;
  found.end = corrected.converged ? corrected.end : candidate.end;
  if (repeats && corrected.is_smooth && (!corrected.converged || corrected.stability() == OrbitStability::neutral)) {
    const Neighbours beside = neighbours_of(candidate, found.end, corrected.uncertainty);
    if (beside == Neighbours::open || (beside == Neighbours::isolated && !corrected.converged)) {
      doubt_ = fmt::format(
          "the motion repeats itself after {} event(s), and turns beside it do not, as where it passes "
          "a fold slowly",
          period);
      is_near_unstable_ = true;
      return false;
    }
    found.is_of_family = beside == Neighbours::closed;
  }
  if (!corrected.converged) {
    if (!repeats || (corrected.is_smooth && !found.is_of_family)) return false;
    found.turn.assign(last_.end() - static_cast<std::ptrdiff_t>(period), last_.end());
    found.stability = OrbitStability::neutral;
  } else {
    found.is_corrected = true;
    found.stability = corrected.stability();
    found.multipliers = corrected.multipliers;
    found.uncertainty = corrected.uncertainty;
    found.turn = turn_of(candidate, corrected.end).segments;
  }
  if (found.stability == OrbitStability::stable) {
    if (!approaches(candidate, corrected)) {
      doubt_ = fmt::format("a stable orbit of {} event(s), {}, is near, and the motion does not approach it yet",
                           period, modulus_text(corrected));
      return false;
    }
    orbit_ = std::move(found);
    return true;
  }
  const bool is_near = repeats || (corrected.converged && is_leaving(candidate, corrected));
  if (!is_near) return false;
  is_near_unstable_ = found.stability == OrbitStability::unstable;
  if (corrected.converged)
    doubt_ = fmt::format("the orbit of {} event(s) that the motion keeps to, or is leaving, has {} and is no attractor",
                         period, modulus_text(corrected));
  if (!repeats) return false;
  kept_to_ = std::move(found);
  if (kept_to_->stability == OrbitStability::neutral && !held_)
    held_ = Held{events_, static_cast<int>(period), last_.back().end};
  return false;
}

bool AttractorSearch::keeps_repeating(const HybridSimulation& motion, int period) {
  if (period != held_->period) {
    held_.reset();
    return false;
  }
  const long passed = events_ - held_->since;
  if (passed < held_events || passed % period != 0) return false;
  const VectorXd scale = recurrence_.scale(2 * static_cast<std::size_t>(period));
  const VectorXd moved = (last_.back().end - held_->state).cwiseAbs().cwiseQuotient(scale);
  held_.reset();
  if (!(moved.maxCoeff() <= held_movement * recognition_)) return false;
  if (!try_period(motion, static_cast<std::size_t>(period))) orbit_ = kept_to_;
  return true;
}

}  // namespace tchat
