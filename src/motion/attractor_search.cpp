#include "motion/attractor_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "motion/lyapunov_exponents.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t points_looked_at = 6;
constexpr long first_nearby = 48;  // events
constexpr std::size_t most_passed = 8192;
constexpr long first_gap = 8;           // events between two tries where the motion repeats itself
constexpr double near = 0.05;           // states one period apart, in ranges
constexpr int most_nearby = 3;          // candidates of one try
constexpr long held_events = 64;        // for so long a motion that cannot be corrected repeats itself
constexpr double held_movement = 10.0;  // recognitions

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

bool AttractorSearch::is_beyond(const VectorXd& x, double bound, const VectorXd& start) const {
  for (Index i = 0; i < x.size(); ++i)
    if (!(std::abs(x(i)) <= bound * std::max(1.0, std::abs(start(i)))) &&
        std::find(ignorable_.begin(), ignorable_.end(), i) == ignorable_.end())
      return true;
  return false;
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
  rounding_ = rounding_among(recurrence_.tiny_states(), motion, segment);
  recurrence_.take_for_rounding(rounding_);
  last_.push_back(segment);
  if (last_.size() > static_cast<std::size_t>(max_period_)) last_.pop_front();
  passed_.push_back({segment.index, segment.end});
  if (passed_.size() > most_passed) passed_.pop_front();
  ++events_;
}

std::string AttractorSearch::unbounded(const HybridSystem& system) const {
  std::vector<bool> left_out = rounding_;
  left_out.resize(static_cast<std::size_t>(system.dimension()), false);
  for (const Index k : ignorable_) left_out[static_cast<std::size_t>(k)] = true;
  const std::optional<Index> state = range_.growing(left_out);
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
  equilibrium_ =
      approached_equilibrium(motion.system(), index, states, least, motion.parameters(), ignorable_, motion.sizes());
  return equilibrium_.has_value();
}

/// The shortest part of the period that repeats itself comes first.
bool AttractorSearch::try_recurrence(const HybridSimulation& motion, int period) {
  doubt_.clear();
  is_near_unstable_ = false;
  for (int q = 1; q <= period; ++q)
    if (period % q == 0 && recurrence_.repeats_events(static_cast<std::size_t>(q)) &&
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

bool AttractorSearch::try_period(const HybridSimulation& motion, std::size_t period) {
  const OrbitCandidate candidate{
      motion,    last_.back().end, recurrence_.last(period), recurrence_.scale(2 * period), ignorable_,
      settings_, passed(period)};
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

namespace {

constexpr double least_growth = 3.0;  // of the logarithm of a distance in a window
constexpr double most_spread = 3.0;
constexpr double least_share = 1e-3;  // of a state, as a share of the largest range
constexpr double share_of_others = 0.3;
constexpr double no_range = level::negligible;  // of a state, as a share of the largest range: rounding
constexpr long first_window = 64;               // events
constexpr long most_events = 8192;
constexpr double without_end = 1e300;

class SimulationBeside : public MotionBeside {
 public:
  SimulationBeside(const HybridSimulation& motion, const VectorXd& end, SimulationSettings settings)
      : settings_(std::move(settings)), end_(end) {
    settings_.samples = 0;
    settings_.sections.clear();
    settings_.on_piece = {};
    at_.emplace(motion, end, settings_);
  }

  bool pass(long events, LyapunovSpectrum* spectrum) override {
    SimulationSettings settings = settings_;
    std::optional<LyapunovAccumulator> exponents;
    if (spectrum != nullptr) exponents.emplace(at_->system(), at_->parameters(), of_window());
    if (exponents) exponents->attach(settings);
    HybridSimulation simulation(*at_, end_, settings);
    if (exponents) exponents->begin();
    for (long k = 0; k < events; ++k) {
      SimulatedSegment segment = simulation.next(without_end);
      low_ = k == 0 ? segment.low : low_.cwiseMin(segment.low);
      high_ = k == 0 ? segment.high : high_.cwiseMax(segment.high);
      was_interrupted_ = segment.ended_by == SegmentEnd::interrupted;
      message_ = segment.message;
      if (segment.ended_by != SegmentEnd::event) return false;
      if (exponents) exponents->pass(segment);
      end_ = segment.end;
      time_ += segment.duration;
    }
    at_.emplace(simulation, end_, settings_);
    if (exponents) *spectrum = exponents->spectrum();
    return true;
  }

  VectorXd range() const override { return high_ - low_; }
  double time() const override { return time_; }
  std::string why_ended() const override { return message_; }
  bool was_interrupted() const override { return was_interrupted_; }

 private:
  LyapunovSettings of_window() const {
    LyapunovSettings settings;
    settings.exponents = std::min<int>(2, at_->system().dimension());
    settings.flow = settings_.flow;
    return settings;
  }

  SimulationSettings settings_;
  std::optional<HybridSimulation> at_;
  VectorXd end_, low_, high_;
  double time_ = 0.0;
  bool was_interrupted_ = false;
  std::string message_;
};

/// Onto the surface of the last event, along the flow.
VectorXd on_event(const HybridSimulation& motion, const VectorXd& end, const VectorXd& change) {
  const IndexVector& last = motion.last_event();
  const EventAt at = event_at(motion.system(), last.event, last.field, end.data(), motion.parameters().data());
  const VectorXd projected = at.project(change);
  return end + (projected.allFinite() ? projected : change);
}

ChaosEvidence evidence_of_end(const MotionBeside& motion) {
  return {false, motion.was_interrupted(), "a motion that begins beside it has ended: " + motion.why_ended(), 0};
}

}  // namespace

void ChaosJudge::add(const LyapunovSpectrum& spectrum, const VectorXd& range) {
  spread_ = 0.0;
  for (Index i = 0; i < range_.size(); ++i)
    if (std::min(range(i), range_(i)) > no_range * range.maxCoeff()) spread_ = std::max(spread_, range(i) / range_(i));
  const ExponentSigns signs = signs_of(spectrum);
  double largest = 0.0;
  for (Index j = 0; j < spectrum.exponents.size(); ++j)
    if (!spectrum.is_structural(j)) largest = std::max(largest, spectrum.exponents(j));
  const bool grows = signs.positive > 0 && largest * spectrum.time >= least_growth;
  const bool counts = grows && (in_a_row_ == 0 || spread_ <= most_spread);
  in_a_row_ = counts ? in_a_row_ + 1 : grows ? 1 : 0;
  regular_in_a_row_ = signs.positive == 0 && signs.unclear == 0 ? regular_in_a_row_ + 1 : 0;
  last_ = spectrum;
  range_ = range;
}

std::string ChaosJudge::doubt() const {
  if (spread_ > most_spread)
    return fmt::format("a motion that begins beside it still spreads: its range grows {:.2g}-fold", spread_);
  const char* const meaning = is_regular() ? "it leaves something unstable"
                                           : "too uncertain; a longer --transient or another --state may decide";
  return fmt::format("a motion that begins beside it has the largest exponents {}: {}", largest_exponents_text(last_),
                     meaning);
}

VectorXd push_along(const VectorXd& direction, const VectorXd& range) {
  // Of each state its range, not less than a share of the largest.
  const VectorXd scale = range.cwiseMax(least_share * range.maxCoeff());
  const double largest = direction.cwiseQuotient(scale).cwiseAbs().maxCoeff();
  VectorXd push = VectorXd::Zero(range.size());
  if (std::isfinite(largest) && largest > 0.0) push = direction / largest;
  for (Index i = 0; i < push.size(); ++i) push(i) += (i % 2 == 0 ? share_of_others : -share_of_others) * scale(i);
  return ChaosJudge::push * push;
}

ChaosEvidence chaos_evidence(const std::function<std::unique_ptr<MotionBeside>(const VectorXd&)>& begin_beside,
                             const VectorXd& direction, double rate) {
  const std::unique_ptr<MotionBeside> beside = begin_beside(VectorXd::Zero(direction.size()));
  if (!beside->pass(first_window, nullptr)) return evidence_of_end(*beside);
  const double events_before = ChaosJudge::growth_before / rate * static_cast<double>(first_window) / beside->time();
  if (!(events_before <= static_cast<double>(most_events)))
    return {false, false,
            fmt::format("a distance grows {:.2g}-fold in {} events only, as where a motion leaves something unstable",
                        std::exp(rate * beside->time() * most_events / first_window), most_events),
            0};
  const std::unique_ptr<MotionBeside> pushed = begin_beside(push_along(direction, beside->range()));
  if (!pushed->pass(1 + static_cast<long>(events_before), nullptr)) return evidence_of_end(*pushed);
  ChaosJudge judge;
  LyapunovSpectrum spectrum;
  long events = 1 + static_cast<long>(events_before);
  for (long window = first_window; !judge.is_chaotic() && !judge.is_regular() && window < most_events; window *= 2) {
    if (!pushed->pass(window, &spectrum)) return evidence_of_end(*pushed);
    judge.add(spectrum, pushed->range());
    events += window;
  }
  return {judge.is_chaotic(), false, judge.is_chaotic() ? "" : judge.doubt(), events};
}

ChaosEvidence chaos_evidence(const HybridSimulation& motion, const VectorXd& end, const VectorXd& direction,
                             double rate, const SimulationSettings& settings) {
  const auto begin_beside = [&](const VectorXd& change) -> std::unique_ptr<MotionBeside> {
    return std::make_unique<SimulationBeside>(motion, change.isZero(0.0) ? end : on_event(motion, end, change),
                                              settings);
  };
  return chaos_evidence(begin_beside, direction, rate);
}

}  // namespace tchat
