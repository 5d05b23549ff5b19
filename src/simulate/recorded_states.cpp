#include "simulate/recorded_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tchat {

namespace {

constexpr double forever = std::numeric_limits<double>::infinity();
constexpr double share_of_return = 1.0 / 3.0;

/// Within which an impact and a state on the section belong together.
double reach(const std::vector<TimedState>& states, const TimeSpan& span) {
  const auto count = static_cast<double>(states.size());
  if (span.period && count > 0) return share_of_return * *span.period / count;
  if (count < 2) return 0.0;
  return share_of_return * (states.back().time - states.front().time) / (count - 1.0);
}

/// Those that may be next to `time`: of a period all, which are few; else the two beside it, for they lie in the order
/// of time.
std::pair<std::size_t, std::size_t> beside(const std::vector<TimedState>& states, double time, const TimeSpan& span) {
  if (span.period) return {0, states.size()};
  const auto later = std::lower_bound(states.begin(), states.end(), time,
                                      [](const TimedState& state, double t) { return state.time < t; });
  const auto position = static_cast<std::size_t>(later - states.begin());
  return {position > 0 ? position - 1 : 0, std::min(position + 1, states.size())};
}

/// The first of the crossings at most so long behind `time`; their number where there is none.
std::size_t next_crossing(const std::vector<TimedState>& crossings, double time, double within, const TimeSpan& span) {
  std::size_t next = crossings.size();
  const auto [from, to] = beside(crossings, time, span);
  for (std::size_t c = from; c < to; ++c)
    if (const double wait = span.from_to(time, crossings[c].time); wait <= within) within = wait, next = c;
  return next;
}

}  // namespace

double TimeSpan::from_to(double a, double b) const {
  if (!period) return b >= a ? b - a : forever;
  const double wait = std::fmod(b - a, *period);
  return wait < 0.0 ? wait + *period : wait;
}

std::vector<TimedState> incoming_states(const std::vector<TimedState>& crossings, const std::vector<double>& times,
                                        const TimeSpan& span, const IncomingFlow& flow) {
  const double within = reach(crossings, span);
  std::vector<TimedState> states;
  std::vector<bool> replaced(crossings.size(), false);
  for (std::size_t k = 0; k < times.size() && within > 0.0; ++k) {
    const std::size_t next = next_crossing(crossings, times[k], within, span);
    const bool is_after = next < crossings.size();
    if (is_after && replaced[next]) continue;
    if (is_after) replaced[next] = true;
    if (std::optional<TimedState> state = flow(k, within)) states.push_back(std::move(*state));
  }
  for (std::size_t c = 0; c < crossings.size(); ++c)
    if (!replaced[c]) states.push_back(crossings[c]);
  std::sort(states.begin(), states.end(), [&](const TimedState& a, const TimedState& b) {
    return span.from_to(span.start, a.time) < span.from_to(span.start, b.time);
  });
  return states;
}

std::vector<int> nearest_contacts(const std::vector<TimedState>& states, const std::vector<TimedState>& contacts,
                                  const TimeSpan& span) {
  const double within = reach(states, span);
  std::vector<int> nearest(states.size(), -1);
  for (std::size_t s = 0; s < states.size(); ++s) {
    double least = within;
    const auto [from, to] = beside(contacts, states[s].time, span);
    for (std::size_t c = from; c < to; ++c) {
      const double apart =
          std::min(span.from_to(contacts[c].time, states[s].time), span.from_to(states[s].time, contacts[c].time));
      if (apart > least) continue;
      least = apart;
      nearest[s] = static_cast<int>(c);
    }
  }
  return nearest;
}

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int looks = 4;  // in a piece, beside its start
constexpr int halvings = 40;

}  // namespace

LargestValues::LargestValues(const HybridSystem& system, const VectorXd& par)
    : system_(system),
      par_(par),
      values_(VectorXd::Constant(system.dimension(), -std::numeric_limits<double>::infinity())) {}

void LargestValues::add_piece(int field, const DenseOutput& state, double from, double to) {
  Look before = look(field, state, from);
  values_ = values_.cwiseMax(before.state);
  for (int l = 1; l <= looks; ++l) {
    Look here = look(field, state, l == looks ? to : from + (to - from) * l / looks);
    values_ = values_.cwiseMax(here.state);
    for (Index k = 0; k < values_.size(); ++k)
      if (before.rate(k) > 0.0 && here.rate(k) < 0.0) locate(field, state, k, before.time, here.time);
    before = std::move(here);
  }
}

LargestValues::Look LargestValues::look(int field, const DenseOutput& state, double time) const {
  const Index n = system_.dimension();
  Look result{time, Eigen::Map<const VectorXd>(state(time), n), VectorXd(n)};
  system_.value(FunctionKind::field, field, result.state.data(), par_.data(), result.rate.data());
  return result;
}

void LargestValues::locate(int field, const DenseOutput& state, Index k, double rising, double falling) {
  for (int halving = 0; halving < halvings; ++halving) {
    const double middle = 0.5 * (rising + falling);
    (look(field, state, middle).rate(k) > 0.0 ? rising : falling) = middle;
  }
  values_(k) = std::max(values_(k), state(rising)[k]);
}

}  // namespace tchat
