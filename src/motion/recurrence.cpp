#include "motion/recurrence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/levels.hpp"
#include "base/limit_at_zero.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "orbit/equilibrium_system.hpp"

namespace tchat {

namespace {

constexpr double shrunk = 1e-3;
constexpr std::size_t ratios = 10;  // compared with each other
constexpr double agreement = 0.1;   // of 1 - rho
constexpr int too_many_zeros = 50;

}  // namespace

void ChatteringDetector::add(const IndexVector& index, double duration, double uncertainty, bool has_limit) {
  segments_.push_back({index, duration, uncertainty, has_limit});
  if (segments_.size() > most_kept) segments_.pop_front();
  zeros_ = duration > 0.0 ? 0 : zeros_ + 1;
  const std::size_t last = segments_.size() - 1;
  for (std::size_t q = 1; q <= longest_pattern; ++q) {
    const bool is_shorter = last >= q && segments_[last - q].index == index && duration < segments_[last - q].duration;
    shrinking_[q] = is_shorter ? shrinking_[q] + 1 : 0;
  }
}

void SeriesCounter::add(const IndexVector& index, double duration) {
  constexpr int least = 5;
  constexpr double shrunk_to = 0.25;
  const bool goes_on = index == index_ && duration < last_;
  if (index == index_ && !goes_on && falling_ >= least && last_ <= shrunk_to * first_) {
    BrokenSeries& series = broken_[index];
    ++series.count;
    series.longest = std::max(series.longest, falling_);
  }
  falling_ = goes_on ? falling_ + 1 : 0;
  if (!goes_on) first_ = duration;
  last_ = duration;
  index_ = index;
}

std::optional<ChatteringDetector::Accumulation> ChatteringDetector::accumulation() const {
  if (zeros_ >= too_many_zeros) return Accumulation{};
  for (std::size_t q = 1; q <= longest_pattern; ++q)
    if (const auto found = accumulation(q)) return found;
  return std::nullopt;
}

std::optional<ChatteringDetector::Accumulation> ChatteringDetector::accumulation(std::size_t q) const {
  if (segments_.empty()) return std::nullopt;
  const std::size_t turns = std::min(shrinking_[q], segments_.size() - 1) / q;
  if (turns < 3 || shrinking_[q] < ratios) return std::nullopt;
  const std::size_t last = segments_.size() - 1;
  for (std::size_t k = last + 1 - q; k <= last; ++k)
    if (segments_[k].has_limit) return std::nullopt;
  if (!(segments_[last].duration < shrunk * segments_[last - q * turns].duration)) return std::nullopt;

  double sum = 0.0;
  double least = 1.0;
  double largest = 0.0;
  for (std::size_t k = last + 1 - ratios; k <= last; ++k) {
    const double ratio = segments_[k].duration / segments_[k - q].duration;
    sum += ratio;
    least = std::min(least, ratio);
    largest = std::max(largest, ratio);
  }
  const double ratio = sum / static_cast<double>(ratios);
  if (largest - least > agreement * (1.0 - ratio)) return std::nullopt;
  const auto is_as_last = [&](const Segment& segment) { return segment.index == segments_.back().index; };
  if (std::all_of(segments_.end() - static_cast<std::ptrdiff_t>(q), segments_.end(), is_as_last))
    return limit(1, q * turns, std::pow(ratio, 1.0 / static_cast<double>(q)));
  return limit(q, turns, ratio);
}

/// The last events may be so slow that their times are hardly known, or not at all where h_x f = 0: the limit that is
/// known best, without so many of them.
ChatteringDetector::Accumulation ChatteringDetector::limit(std::size_t q, std::size_t turns, double ratio) const {
  Accumulation best = limit_before(segments_.size(), q, turns, ratio);
  double since = 0.0;
  for (std::size_t left_out = 1; left_out + 2 * q <= q * turns; ++left_out) {
    const std::size_t end = segments_.size() - left_out;
    since += segments_[end].duration;
    Accumulation found = limit_before(end, q, (q * turns - left_out) / q, ratio);
    found.remaining = std::max(found.remaining - since, 0.0);
    if (found.uncertainty < best.uncertainty) best = found;
  }
  return best;
}

/// From the segments before `end`, and from the last event among them.
ChatteringDetector::Accumulation ChatteringDetector::limit_before(std::size_t end, std::size_t q, std::size_t turns,
                                                                  double ratio) const {
  constexpr std::size_t most_nodes = 8;
  constexpr double safety = 5.0;  // of the last increment, which has been 2 to 5 times too small
  const std::size_t nodes = std::min(turns, most_nodes);
  std::array<double, most_nodes> lengths{};
  double known_to = 0.0, first = 0.0;  // where the first pattern ends, before the last one
  std::size_t k = end;
  for (std::size_t j = 0; j < nodes; ++j) {
    if (j > 0) first -= lengths[j - 1];
    for (std::size_t i = 0; i < q; ++i) {
      --k;
      lengths[j] += segments_[k].duration;
      known_to = std::max(known_to, segments_[k].uncertainty);
    }
  }
  LimitAtZero limit;
  double time = first;
  for (std::size_t j = nodes; j-- > 0;) {
    limit.add(lengths[j], time, 0.0);
    if (j > 0) time += lengths[j - 1];
  }
  const double about = lengths[0] * ratio / (1.0 - ratio);
  const double remaining = nodes > 1 ? limit.best : about, error = nodes > 1 ? limit.error : about;
  return {remaining, ratio, static_cast<int>(q), safety * error + known_to / (1.0 - ratio)};
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

bool is_ignored(const std::vector<bool>& ignorable, Eigen::Index i) {
  const auto k = static_cast<std::size_t>(i);
  return k < ignorable.size() && ignorable[k];
}

/// Is a function independent of state c, apart from passing it on in a jump? Values are compared, since derivatives do
/// not tell: mod(x, 1) has that of x. `size`: of the state.
bool only_moves_with(const HybridSystem& system, FunctionKind kind, int index, const VectorXd& x, int c, double size,
                     const VectorXd& par) {
  const Eigen::Index rows = kind == FunctionKind::event ? 1 : x.size();
  VectorXd before(rows), after(rows);
  system.value(kind, index, x.data(), par.data(), before.data());
  VectorXd moved = x;
  for (const double share : {0.37, -1.3, 5.1}) {  // of its size
    moved(c) = x(c) + share * size;
    system.value(kind, index, moved.data(), par.data(), after.data());
    if (kind == FunctionKind::jump) after(c) -= moved(c) - x(c);
    VectorXd least = level::negligible * before.cwiseAbs();
    if (kind == FunctionKind::jump) least(c) += level::negligible * std::abs(moved(c));
    if (!((after - before).cwiseAbs().array() <= least.array()).all()) return false;
  }
  return true;
}

/// Clears the flags of the states that a function depends on; a jump may only pass a state on.
void keep_independent(const HybridSystem& system, FunctionKind kind, const VectorXd& x, const VectorXd& par,
                      std::vector<bool>& flags) {
  const int n = system.dimension();
  const int rows = kind == FunctionKind::event ? 1 : n;
  for (int index = 1; index <= system.count(kind); ++index) {
    VectorXd value(rows);
    MatrixXd dx(rows, n);
    double no_parameters = 0.0;
    system.first(kind, index, x.data(), par.data(), {}, value.data(), dx.data(), &no_parameters);
    if (kind == FunctionKind::jump) dx -= MatrixXd::Identity(n, n);
    constexpr double rounding = level::negligible;  // of differences, as a share of what a value is made of
    const VectorXd sizes = (x.array() == 0.0).select(1.0, x.cwiseAbs());
    const MatrixXd terms = dx.cwiseAbs() * sizes.asDiagonal();
    const VectorXd least = rounding * (terms.rowwise().sum() + value.cwiseAbs());
    for (int c = 0; c < n; ++c)
      if (!(terms.col(c).array() <= least.array()).all() ||
          (flags[static_cast<std::size_t>(c)] && !only_moves_with(system, kind, index, x, c, sizes(c), par)))
        flags[static_cast<std::size_t>(c)] = false;
  }
}

}  // namespace

void Recurrence::measure(Difference difference, const VectorXd& least_range) {
  difference_ = std::move(difference);
  least_range_ = least_range;
}

void Recurrence::add(const IndexVector& index, const VectorXd& after, const VectorXd& low, const VectorXd& high) {
  ends_.push_back({index, after, low, high});
  if (ends_.size() > 2 * static_cast<std::size_t>(max_period_)) ends_.pop_front();
}

std::vector<bool> Recurrence::tiny_states() const {
  constexpr double tiny = level::orbit;
  VectorXd sizes = VectorXd::Zero(back(0).low.size());
  for (const End& end : ends_) sizes = sizes.cwiseMax(end.low.cwiseAbs()).cwiseMax(end.high.cwiseAbs());
  double largest = 0.0;
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    if (!is_ignored(ignorable_, i)) largest = std::max(largest, sizes(i));
  std::vector<bool> flags(static_cast<std::size_t>(sizes.size()));
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    flags[static_cast<std::size_t>(i)] = !is_ignored(ignorable_, i) && sizes(i) <= tiny * largest;
  return flags;
}

std::optional<int> Recurrence::period() const {
  for (std::size_t p = 1; 2 * p <= ends_.size(); ++p)
    if (repeats(p)) return static_cast<int>(p);
  return std::nullopt;
}

VectorXd Recurrence::scale(std::size_t segments) const {
  VectorXd low = back(0).low;
  VectorXd high = back(0).high;
  for (std::size_t i = 1; i < segments; ++i) {
    low = low.cwiseMin(back(i).low);
    high = high.cwiseMax(back(i).high);
  }
  if (least_range_.size() > 0) return (high - low).cwiseMax(least_range_);
  return sizes_of_differences(low, high, without_size_, ignorable_);
}

Signature Recurrence::last(std::size_t segments) const {
  Signature signature;
  for (std::size_t i = segments; i > 0; --i) signature.push_back(back(i - 1).index);
  return signature;
}

bool Recurrence::repeats_events(std::size_t period) const {
  if (period == 0 || 2 * period > ends_.size()) return false;
  for (std::size_t i = 0; i < period; ++i)
    if (back(i).index != back(i + period).index) return false;
  return true;
}

double Recurrence::difference(std::size_t period) const {
  const VectorXd scale = this->scale(2 * period);
  double largest = 0.0;
  for (std::size_t i = 0; i < period; ++i) {
    const VectorXd &now = back(i).after, &then = back(i + period).after;
    const VectorXd d = (difference_ ? difference_(now, then) : VectorXd(now - then)).cwiseAbs();
    for (Eigen::Index k = 0; k < d.size(); ++k)
      if (d(k) != 0.0) largest = std::max(largest, d(k) / scale(k));
  }
  return largest;
}

bool Recurrence::repeats(std::size_t period) const {
  // Where nothing moves the motion rests.
  return repeats_events(period) && difference(period) <= tolerance_ && scale(2 * period).maxCoeff() > 0.0;
}

void RangeGrowth::add(const SimulatedSegment& segment) {
  now_ = events_ == 0 ? Extremes{segment.low, segment.high}
                      : Extremes{now_.low.cwiseMin(segment.low), now_.high.cwiseMax(segment.high)};
  ++events_;
  if ((events_ & (events_ - 1)) == 0) doubled_.push_back(now_);
}

double RangeGrowth::growth(Eigen::Index state) const {
  const Extremes& then = before();
  return (now_.high(state) - now_.low(state)) / (then.high(state) - then.low(state));
}

std::optional<Eigen::Index> RangeGrowth::growing(const std::vector<bool>& left_out) const {
  constexpr double share = 0.25, least = level::located;  // of a range; of the state
  constexpr long least_events = 64;
  if (events_ < least_events) return std::nullopt;
  const Extremes& then = before();
  for (Eigen::Index i = 0; i < now_.low.size(); ++i) {
    const double range = now_.high(i) - now_.low(i);
    const double size = std::max(std::abs(now_.low(i)), std::abs(now_.high(i)));
    if (!is_ignored(left_out, i) && range > least * size && range > (1.0 + share) * (then.high(i) - then.low(i)))
      return i;
  }
  return std::nullopt;
}

void EventRanges::add(const SimulatedSegment& segment) {
  Window& now = windows_[segment.index].now;
  now.low = now.events == 0 ? segment.end : VectorXd(now.low.cwiseMin(segment.end));
  now.high = now.events == 0 ? segment.end : VectorXd(now.high.cwiseMax(segment.end));
  ++now.events;
  const VectorXd size = segment.low.cwiseAbs().cwiseMax(segment.high.cwiseAbs());
  sizes_ = events_++ == 0 ? size : VectorXd(sizes_.cwiseMax(size));
  if ((events_ & (events_ - 1)) != 0) return;
  for (auto& [index, windows] : windows_) {
    windows.before = std::exchange(windows.last, std::move(windows.now));
    windows.now = {};
  }
}

std::optional<EventRanges::Change> EventRanges::changing(const std::vector<bool>& left_out) const {
  constexpr long least_events = 32;
  constexpr double same = 0.8, moved = 0.2, least = level::located;  // of a range; of a state
  for (const auto& [index, windows] : windows_) {
    const auto& [now, last, before] = windows;
    if (before.events < least_events || last.events < least_events) continue;
    for (Eigen::Index i = 0; i < last.low.size(); ++i) {
      const double range = last.high(i) - last.low(i), was = before.high(i) - before.low(i);
      if (is_ignored(left_out, i) || !(std::max(range, was) > least * sizes_(i))) continue;
      const double shift = 0.5 * std::abs(last.low(i) + last.high(i) - before.low(i) - before.high(i));
      if (range < same * was || was < same * range || shift > moved * was)
        return Change{index, i, range / was, shift / was};
    }
  }
  return std::nullopt;
}

std::vector<bool> ignorable_states(const HybridSystem& system, const std::vector<VectorXd>& points,
                                   const VectorXd& par) {
  std::vector<bool> flags(static_cast<std::size_t>(system.dimension()), !points.empty());
  for (const VectorXd& x : points)
    for (const FunctionKind kind : {FunctionKind::field, FunctionKind::event, FunctionKind::jump})
      keep_independent(system, kind, x, par, flags);
  return flags;
}

namespace {

using Eigen::Index;

constexpr double rounding = level::orbit;  // of real parts, relative to |f_x|
constexpr std::size_t least_states = 4;
constexpr double no_movement = 1e-3;           // relative to the sizes of the states
constexpr double at_surface = level::located;  // the same from the surface of an event
constexpr double least_fall = 1e-3;            // of distances, relative to the last one

/// An equilibrium, and the real parts of the eigenvalues of its f_x in units of |f_x|, n.
struct Rest {
  VectorXd state, growth;
};

/// An equilibrium whose f_x has no eigenvalue with a positive real part.
std::optional<Rest> attracting_equilibrium(const HybridSystem& system, int field, const VectorXd& near,
                                           const VectorXd& par, const std::vector<Index>& ignorable,
                                           const VectorXd& sizes) {
  const std::optional<NearbyEquilibrium> found = find_equilibrium(system, field, near, par.data(), ignorable, sizes);
  if (!found) return std::nullopt;
  const double size = found->jacobian.norm();
  const VectorXd growth = eigenvalues(found->jacobian).real() / (size > 0.0 ? size : 1.0);
  if ((growth.array() > rounding).any()) return std::nullopt;
  return Rest{found->state, growth};
}

/// Of falling distances.
bool fall_to_zero(const std::vector<double>& distances) {
  const std::size_t space = (distances.size() - 1) / 2, last = distances.size() - 1;
  const double end = distances[last];
  const double before = distances[last - 2 * space] - distances[last - space], after = distances[last - space] - end;
  if (!(before + after >= least_fall * end)) return false;
  return after >= before || end - after * after / (before - after) <= 0.5 * end;
}

}  // namespace

StateSizes sizes_in(const HybridSystem& system, std::span<const SimulatedSegment> segments, const VectorXd& par) {
  MatrixXd extremes(system.dimension(), 2 * std::ssize(segments));
  Eigen::Index column = 0;
  for (const SimulatedSegment& segment : segments) {
    extremes.col(column++) = segment.low;
    extremes.col(column++) = segment.high;
  }
  StateSizes sizes(extremes);
  for (const SimulatedSegment& segment : segments) {
    const auto [field, event, jump] = segment.index;
    for (const VectorXd& x : {segment.start, segment.end})
      sizes.add(system, FunctionKind::field, field, x.data(), par.data());
    if (event == 0) continue;
    sizes.add(system, FunctionKind::jump, jump, segment.end.data(), par.data());
    sizes.add(system, FunctionKind::event, event, segment.end.data(), par.data());
  }
  return sizes;
}

std::optional<VectorXd> reached_equilibrium(const HybridSystem& system, const SimulatedSegment& last,
                                            const VectorXd& par, const std::vector<Index>& ignorable,
                                            const VectorXd& sizes) {
  const int field = last.mode.field();
  VectorXd f(last.end.size());
  system.value(FunctionKind::field, field, last.end.data(), par.data(), f.data());
  for (const Index k : ignorable) f(k) = 0.0;
  // One that has been rounding of zero all along may do what it likes.
  const VectorXd sizes_here = sizes.cwiseMax(sizes_in(system, {&last, 1}, par).sizes());
  const std::optional<Rest> rest = attracting_equilibrium(system, field, last.end, par, ignorable, sizes_here);
  if (!rest) return std::nullopt;
  if (length_in_sizes(f * last.duration, sizes_here) <= no_movement) return rest->state;
  // The longer the wait, the more the integration's noise moves it.
  VectorXd distance = last.end - rest->state;
  for (const Index k : ignorable) distance(k) = 0.0;
  const bool is_there = length_in_sizes(distance, sizes_here) <= level::located;
  const bool attracts = (rest->growth.array() < -rounding).count() >= last.end.size() - std::ssize(ignorable);
  return is_there && attracts ? std::optional(rest->state) : std::nullopt;
}

std::optional<VectorXd> approached_equilibrium(const HybridSystem& system, const IndexVector& index,
                                               const std::vector<VectorXd>& states, std::size_t least,
                                               const VectorXd& par, const std::vector<Index>& ignorable,
                                               const VectorXd& sizes, double tolerance) {
  if (states.size() < least_states) return std::nullopt;
  const double there = std::max(level::differences, 100.0 * tolerance);  // integration cannot tell it from zero
  const std::optional<Rest> found = attracting_equilibrium(system, index.field, states.back(), par, ignorable, sizes);
  if (!found) return std::nullopt;
  const VectorXd& rest = found->state;
  const EventAt at = event_at(system, index.event, rest.data(), par.data());
  if (!(std::abs(at.h) <= at_surface * at.scale(rest.data(), sizes))) return std::nullopt;
  std::vector<double> falling;  // the last distances, as long as each is smaller than the one before it, or nothing
  VectorXd first;               // the first of them, of each state in sizes
  VectorXd last(sizes.size());
  for (const VectorXd& state : states) {
    VectorXd d = state - rest;
    for (const Index k : ignorable) d(k) = 0.0;
    const double distance = length_in_sizes(d, sizes);
    last = d.cwiseAbs().cwiseQuotient(sizes.unaryExpr(&size_for_tolerance));
    if (!falling.empty() && !(distance < falling.back()) && !(distance <= there)) falling.clear();
    if (falling.empty()) first = last;
    falling.push_back(distance);
  }
  if (falling.size() < std::max(least_states, least)) return std::nullopt;
  if (falling.back() <= there) return rest;
  // A state that stays where it is comes to no rest elsewhere, however others come near.
  Index farthest = 0;
  last.maxCoeff(&farthest);
  const bool falls = last(farthest) <= (1.0 - least_fall) * first(farthest);
  return falls && fall_to_zero(falling) ? std::optional(rest) : std::nullopt;
}

}  // namespace tchat
