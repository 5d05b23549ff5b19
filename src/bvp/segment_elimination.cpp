#include "bvp/segment_elimination.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "bvp/lane_entries.hpp"
#include "linear_algebra/partial_lu.hpp"

namespace tchat {

namespace {

LaneArray lane_zeros(std::ptrdiff_t count) { return LaneArray(static_cast<std::size_t>(count * lanes), 0.0); }

std::vector<int> lanes_in_use(const LaneSchedule& schedule) {
  std::vector<int> result;
  for (int l = 0; l < lanes; ++l)
    if (schedule.size(l) > 0) result.push_back(l);
  return result;
}

}  // namespace

void LargeProduct::multiply(double factor) {
  int shift = 0;
  mantissa = std::frexp(mantissa * factor, &shift);
  exponent += shift;
}

SegmentElimination::SegmentElimination(const OrbitShape& shape, int scalars, int border, const CollocationRule& rule,
                                       const EliminationThreads& threads)
    : shape_(shape),
      n_(shape.dimension),
      scalars_(scalars),
      columns_(scalars + 1),
      border_(border),
      rule_(rule),
      schedule_(shape.intervals),
      groups_(schedule_.groups()),
      interval_(shape.collocation * n_, (shape.collocation - 1) * n_, (shape.collocation + 1) * n_ + columns_),
      join_(2 * n_, n_, 3 * n_ + columns_),
      top_join_(join_kernel(n_, columns_)),
      joins_(joins_of_halves(groups_)),
      levels_(levels_of(joins_)),
      top_lanes_(lanes_in_use(schedule_)),
      top_joins_(joins_of_halves(static_cast<int>(top_lanes_.size()))),
      within_(threads.within),
      kept_segments_(threads.segments > 1 ? shape.segments : 1),
      kept_groups_(threads.segments > 1 || threads.within > 1 ? groups_ : 1),
      outcomes_(index(groups_)) {
  const std::ptrdiff_t blocks = block(shape.segments, 0);
  const std::ptrdiff_t joins = static_cast<std::ptrdiff_t>(shape.segments) * (groups_ - 1);
  number_of_middle_.resize(index(groups_));
  for (const Join& at : joins_) number_of_middle_[index(at.middle)] = at.number;
  const int interval_rows = interval_.rows() + border_;
  const int join_rows = join_.rows() + border_;
  interval_blocks_ = {blocks, interval_.block_size(border_)};
  interval_swaps_ = {blocks, interval_.pivots() * lanes};
  join_blocks_ = {joins, join_.block_size(border_)};
  join_swaps_ = {joins, join_.pivots() * lanes};
  interval_rhs_ = {blocks, interval_rows * lanes};
  join_rhs_ = {joins, join_rows * lanes};

  const std::ptrdiff_t tops = top_block(shape.segments, 0);
  lane_pieces_ = {tops, (n_ + border_) * length()};
  top_blocks_ = {tops, join_rows * top_join_.width()};
  top_swaps_ = {tops, n_};
  lane_rhs_ = {tops, n_ + border_};
  top_rhs_ = {tops, join_rows};
  whole_ = {shape.segments, (n_ + border_) * length()};
  largest_residuals_.resize(index(blocks));

  const int c = shape.collocation;
  nodes_ = lane_zeros((c + 1) * n_);
  points_ = lane_zeros(c * n_);
  zero_rhs_ = lane_zeros(std::max(interval_rows, join_rows));
  const std::ptrdiff_t kept = static_cast<std::ptrdiff_t>(kept_segments_) * kept_groups_;
  f_ = derivatives_ = {kept, c * n_ * lanes};
  fx_ = {kept, c * n_ * n_ * lanes};
  fp_ = {kept, c * n_ * (scalars_ - 1) * lanes};
  x_of_points_.resize(index(c * n_ * lanes));
  f_of_points_.resize(index(c * n_ * lanes));
  fx_of_points_.resize(index(c * n_ * n_ * lanes));
  fp_of_points_.resize(index(c * n_ * (scalars_ - 1) * lanes));
  const int workers = std::max(threads.segments, threads.within);
  constexpr auto together = static_cast<std::ptrdiff_t>(most_together);
  jacobian_ = {workers, n_ * n_ * lanes};
  residual_ = {workers, c * n_ * lanes};
  local_ = {together * workers, interval_.width() * lanes};
  join_local_ = {together * workers, join_.width() * lanes};
  top_local_ = {workers, top_join_.width()};
}

/// Pieces before those that they are part of, in an order that goes on with what was made last.
std::vector<SegmentElimination::Join> SegmentElimination::joins_of_halves(int pieces) {
  std::vector<Join> result;
  std::vector<Join> open{{0, halfway(0, pieces), pieces}};
  while (!open.empty()) {  // a piece, its right half, its left half: the reverse of the order wanted
    const Join at = open.back();
    open.pop_back();
    if (at.last - at.first < 2) continue;
    result.push_back(at);
    open.push_back({at.first, halfway(at.first, at.middle), at.middle});
    open.push_back({at.middle, halfway(at.middle, at.last), at.last});
  }
  std::reverse(result.begin(), result.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i].number = static_cast<int>(i);
  return result;
}

/// A join is of the level after those of its two pieces.
std::vector<std::vector<SegmentElimination::Join>> SegmentElimination::levels_of(const std::vector<Join>& joins) {
  std::vector<std::vector<Join>> levels;
  for (const Join& at : joins) {
    std::size_t level = 0;
    for (int pieces = 1; pieces < at.last - at.first; pieces *= 2) ++level;
    levels.resize(std::max(levels.size(), level));
    levels[level - 1].push_back(at);
  }
  return levels;
}

/// The mesh node where a piece of a lane begins; of one beyond the last, where the segment ends.
int SegmentElimination::top_node(int piece) const {
  return piece < static_cast<int>(top_lanes_.size()) ? schedule_.start(top_lanes_[index(piece)]) : shape_.intervals;
}

namespace {

/// Not finite before singular: the order in which pieces are done does not matter.
Linearization worst(std::span<const Linearization> outcomes) {
  for (const Linearization worse : {Linearization::not_finite, Linearization::singular})
    if (std::find(outcomes.begin(), outcomes.end(), worse) != outcomes.end()) return worse;
  return Linearization::ready;
}

}  // namespace

Linearization SegmentElimination::condense(int s, const HybridSystem& system, int field, std::span<const int> active,
                                           const Orbit& x, std::span<const OrbitVector> rows, double* collocation) {
  within_.run(
      groups_, [&](int group) { evaluate_group(s, group, system, field, active, x); },
      [&](int group, int thread) { outcomes_[index(group)] = condense_group(s, group, x, rows, collocation, thread); });
  if (const Linearization outcome = worst(outcomes_); outcome != Linearization::ready) return outcome;
  return join_groups(s) && join_lanes(s) ? Linearization::ready : Linearization::singular;
}

void SegmentElimination::evaluate(int s, const HybridSystem& system, int field, std::span<const int> active,
                                  const Orbit& x) {
  assert(kept_segments_ == shape_.segments && kept_groups_ == groups_);
  for (int group = 0; group < groups_; ++group) evaluate_group(s, group, system, field, active, x);
}

Linearization SegmentElimination::condense_evaluated(int s, const Orbit& x, std::span<const OrbitVector> rows,
                                                     double* collocation, int thread) {
  Linearization all = Linearization::ready;
  for (int group = 0; group < groups_; ++group)
    all = worst(std::array{all, condense_group(s, group, x, rows, collocation, thread)});
  if (all != Linearization::ready) return all;
  for (const Join& at : joins_)
    if (!join(s, at)) return Linearization::singular;
  return join_lanes(s) ? Linearization::ready : Linearization::singular;
}

double SegmentElimination::largest_residual() const {
  return *std::max_element(largest_residuals_.begin(), largest_residuals_.end());
}

Linearization SegmentElimination::condense_group(int s, int group, const Orbit& x, std::span<const OrbitVector> rows,
                                                 double* collocation, int thread) {
  if (!fill_group(s, group, x, collocation, thread)) return Linearization::not_finite;
  fill_border(s, group, rows);
  return eliminate_group(s, group) ? Linearization::ready : Linearization::singular;
}

bool SegmentElimination::eliminate_group(int s, int group) {
  const std::ptrdiff_t b = block(s, group);
  return interval_.eliminate(interval_blocks_[b], border_, interval_swaps_[b], interval_blocks_.behind(b)) == 0;
}

bool SegmentElimination::join_groups(int s) {
  for_joins([&](const Join& at, int) {
    outcomes_[index(at.middle)] = join(s, at) ? Linearization::ready : Linearization::singular;
  });
  return worst(outcomes_) == Linearization::ready;
}

LanePiece SegmentElimination::piece(int s, int first, int last) const {
  const bool one_interval = last - first == 1;
  const LaneKernel& kernel = one_interval ? interval_ : join_;
  const double* block =
      one_interval ? interval_blocks_[this->block(s, first)] : join_blocks_[this->block(s, join_of(first, last))];
  const int p = kernel.pivots(), stride = kernel.stride();
  return {block + (p * stride + p) * lanes, block + (kernel.rows() * stride + p) * lanes, stride};
}

bool SegmentElimination::join(int s, const Join& at) {
  const std::ptrdiff_t b = block(s, at);
  double* target = join_blocks_[b];
  const LanePiece left = piece(s, at.first, at.middle);
  assembly_.join({n_, columns_, border_, join_.stride()}, left, piece(s, at.middle, at.last), target);
  for (int l = 0; l < lanes; ++l)
    if (passes(at, l)) pass_on(left, l, target);
  return join_.eliminate(target, border_, join_swaps_[b], join_blocks_.behind(b)) == 0;
}

/// Where a lane has nothing on the right, the join's rows say that an unknown of no meaning is zero, and then what the
/// left piece says: elimination leaves them as they are.
void SegmentElimination::pass_on(const LanePiece& left, int lane, double* target) const {
  const auto entry = [&](int i, int j) -> double& { return target[(i * join_.stride() + j) * lanes + lane]; };
  for (int i = 0; i < join_.rows() + border_; ++i)
    for (int j = 0; j < join_.width(); ++j) entry(i, j) = i == j && i < n_ ? 1.0 : 0.0;
  for (int a = 0; a < n_; ++a) {
    const double* from = left.rows + a * left.stride * lanes;
    for (int j = 0; j < length(); ++j) entry(n_ + a, n_ + j) = from[j * lanes + lane];
  }
  for (int r = 0; r < border_; ++r) {
    const double* from = left.border + r * left.stride * lanes;
    for (int j = 0; j < length(); ++j) entry(2 * n_ + r, n_ + j) = from[j * lanes + lane];
  }
}

/// A piece of several lanes, or of one; its border rows follow the n others.
const double* SegmentElimination::top_piece(int s, int first, int last, int& width) const {
  if (last - first == 1) {
    width = length();
    return lane_pieces_[top_block(s, first)];
  }
  width = top_join_.width();
  return top_blocks_[top_block(s, halfway(first, last))] + n_ * width + n_;
}

/// The joins between lanes: columns (middle | first | last | scalars), rows (left piece | right piece | border).
bool SegmentElimination::join_lanes(int s) {
  const LanePiece all = piece(s, 0, groups_);
  const int pieces = static_cast<int>(top_lanes_.size());
  for (int k = 0; k < pieces; ++k) {
    double* to = lane_pieces_[top_block(s, k)];
    for (int a = 0; a < n_; ++a, to += length())
      take_lane(all.rows + a * all.stride * lanes, top_lanes_[index(k)], length(), to);
    for (int r = 0; r < border_; ++r, to += length())
      take_lane(all.border + r * all.stride * lanes, top_lanes_[index(k)], length(), to);
  }
  const int width = top_join_.width();
  for (const Join& at : top_joins_) {
    double* target = top_blocks_[top_block(s, at.middle)];
    std::fill_n(target, (top_join_.rows() + border_) * width, 0.0);
    int left_width = 0;
    int right_width = 0;
    const double* left = top_piece(s, at.first, at.middle, left_width);
    const double* right = top_piece(s, at.middle, at.last, right_width);
    for (int i = 0; i < n_ + border_; ++i, left += left_width, right += right_width) {
      double* to = target + (i < n_ ? i : n_ + i) * width;
      for (int a = 0; a < n_; ++a) to[a] = left[n_ + a], to[n_ + a] = left[a];
      for (int k = 0; k < columns_; ++k) to[3 * n_ + k] = left[2 * n_ + k];
      to = target + (n_ + i) * width;
      for (int a = 0; a < n_; ++a) to[a] += right[a];
      for (int k = 0; k < n_ + columns_; ++k) to[2 * n_ + k] += right[n_ + k];
    }
    if (!top_join_.eliminate(target, border_, top_swaps_[top_block(s, at.middle)])) return false;
  }
  int last_width = 0;
  const double* from = top_piece(s, 0, pieces, last_width);
  for (int i = 0; i < n_ + border_; ++i, from += last_width) std::copy_n(from, length(), whole_[s] + i * length());
  return true;
}

/// work(reciprocal pivot, is its row exchanged with another one?) for all pivots of all segments.
template <class Work>
void SegmentElimination::for_pivots(const Work& work) const {
  // The blocks hold reciprocal pivots.
  const auto of_lanes = [&](const LaneKernel& kernel, const double* block, const int* swaps,
                            const std::array<bool, static_cast<std::size_t>(lanes)>& counts) {
    for (int k = 0; k < kernel.pivots(); ++k) {
      const double* pivots = block + static_cast<std::ptrdiff_t>(k * kernel.stride() + k) * lanes;
      for (int l = 0; l < lanes; ++l)
        if (counts[static_cast<std::size_t>(l)]) work(pivots[l], swaps[k * lanes + l] != k);
    }
  };
  const auto lanes_where = [](const auto& holds) {
    std::array<bool, static_cast<std::size_t>(lanes)> result{};
    for (int l = 0; l < lanes; ++l) result[static_cast<std::size_t>(l)] = holds(l);
    return result;
  };
  for (int s = 0; s < shape_.segments; ++s) {
    for (int group = 0; group < groups_; ++group)
      of_lanes(interval_, interval_blocks_[block(s, group)], interval_swaps_[block(s, group)],
               lanes_where([&](int l) { return schedule_.holds(group, l); }));
    for (const Join& at : joins_)
      of_lanes(join_, join_blocks_[block(s, at)], join_swaps_[block(s, at)],
               lanes_where([&](int l) { return !passes(at, l); }));
    for (const Join& at : top_joins_) {
      const double* block = top_blocks_[top_block(s, at.middle)];
      const int* swaps = top_swaps_[top_block(s, at.middle)];
      for (int k = 0; k < n_; ++k) work(block[std::ptrdiff_t{k} * top_join_.width() + k], swaps[k] != k);
    }
  }
}

void SegmentElimination::divide_by_determinant(LargeProduct& product) const {
  for_pivots([&](double reciprocal, bool exchanged) { product.multiply(exchanged ? -reciprocal : reciprocal); });
}

int SegmentElimination::determinant_sign() const {
  std::uint64_t signs = 0;  // in the highest bit
  unsigned exchanges = 0;
  for_pivots([&](double reciprocal, bool exchanged) {
    signs ^= std::bit_cast<std::uint64_t>(reciprocal);
    exchanges ^= exchanged ? 1U : 0U;
  });
  return (signs >> 63U) == exchanges ? 1 : -1;
}

}  // namespace tchat
