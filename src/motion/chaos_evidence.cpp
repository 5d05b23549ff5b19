#include "motion/chaos_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/lyapunov_exponents.hpp"
#include "motion/settle.hpp"

namespace tchat {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double least_growth = 3.0;  // of the logarithm of a distance in a window
constexpr double most_spread = 3.0;
constexpr double least_share_of_rate = 0.75;
constexpr double least_share = 1e-3;  // of a state, as a share of the largest range
constexpr double share_of_others = 0.3;
constexpr double no_range = level::negligible;  // of a state, as a share of the largest range: rounding
constexpr long first_window = 64;               // events
constexpr long most_events = 8192;

class SimulationBeside : public MotionBeside {
 public:
  SimulationBeside(const HybridSimulation& motion, const VectorXd& end, SimulationSettings settings)
      : settings_(std::move(settings)), end_(end) {
    settings_.samples = 0;
    settings_.sections.clear();
    settings_.on_piece = {};
    at_.emplace(motion, end, settings_);
    units_ = units_of(motion.sizes());
  }

  bool pass(long events, LyapunovSpectrum* spectrum) override {
    SimulationSettings settings = settings_;
    std::optional<LyapunovAccumulator> exponents;
    if (spectrum != nullptr) exponents.emplace(at_->system(), at_->parameters(), of_window());
    if (exponents) exponents->attach(settings);
    HybridSimulation simulation(*at_, end_, settings);
    if (exponents) exponents->begin();
    bool has_begun = false;
    const Course course = settle(simulation, plan_of_events(events), [&](const SimulatedSegment& segment, bool) {
      low_ = has_begun ? low_.cwiseMin(segment.low) : segment.low;
      high_ = has_begun ? high_.cwiseMax(segment.high) : segment.high;
      has_begun = true;
      was_interrupted_ = segment.ended_by == SegmentEnd::interrupted;
      message_ = segment.message;
      if (!goes_on(segment)) return true;
      if (exponents) exponents->pass(segment);
      end_ = segment.end;
      time_ += segment.duration;
      return false;
    });
    if (course.has_ended) return false;
    at_.emplace(simulation, end_, settings_);
    if (exponents) *spectrum = exponents->spectrum();
    return true;
  }

  VectorXd units() const override { return units_; }
  VectorXd range() const override { return (high_ - low_).cwiseQuotient(units_); }
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
  VectorXd end_, low_, high_, units_;
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
  const bool keeps_growing = largest >= least_share_of_rate * rate_;
  const bool counts = grows && (in_a_row_ == 0 || (spread_ <= most_spread && keeps_growing));
  in_a_row_ = counts ? in_a_row_ + 1 : grows ? 1 : 0;
  regular_in_a_row_ = signs.positive == 0 && signs.unclear == 0 ? regular_in_a_row_ + 1 : 0;
  rate_ = largest;
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
  const VectorXd units = beside->units();
  const VectorXd push = push_along(direction.cwiseQuotient(units), beside->range());
  const std::unique_ptr<MotionBeside> pushed = begin_beside(units.cwiseProduct(push));
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
