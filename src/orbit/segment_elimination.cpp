#include "orbit/segment_elimination.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>

#include "linear/array_kernel.hpp"
#include "linear/partial_lu.hpp"

namespace tchat {

namespace {

std::vector<int> lanes_in_use(const LaneSchedule& schedule) {
  std::vector<int> result;
  for (int l = 0; l < lanes; ++l)
    if (schedule.size(l) > 0) result.push_back(l);
  return result;
}

/// Pieces before those that they are part of, in an order that goes on with what was made last.
std::vector<PieceJoin> joins_of_halves(int pieces) {
  const auto halfway = SegmentPlan::halfway;
  std::vector<PieceJoin> result;
  std::vector<PieceJoin> open{{0, halfway(0, pieces), pieces}};
  while (!open.empty()) {  // a piece, its right half, its left half: the reverse of the order wanted
    const PieceJoin at = open.back();
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
std::vector<std::vector<PieceJoin>> levels_of(const std::vector<PieceJoin>& joins) {
  std::vector<std::vector<PieceJoin>> levels;
  for (const PieceJoin& at : joins) {
    std::size_t level = 0;
    for (int pieces = 1; pieces < at.last - at.first; pieces *= 2) ++level;
    levels.resize(std::max(levels.size(), level));
    levels[level - 1].push_back(at);
  }
  return levels;
}

}  // namespace

SegmentPlan::SegmentPlan(int intervals)
    : schedule(intervals),
      groups(schedule.groups()),
      joins(joins_of_halves(groups)),
      number_of_middle(static_cast<std::size_t>(groups)),
      levels(levels_of(joins)),
      top_lanes(lanes_in_use(schedule)),
      top_joins(joins_of_halves(static_cast<int>(top_lanes.size()))) {
  for (const PieceJoin& at : joins) number_of_middle[static_cast<std::size_t>(at.middle)] = at.number;
}

namespace {

LaneArray lane_zeros(std::ptrdiff_t count) { return LaneArray(static_cast<std::size_t>(count * lanes), 0.0); }

/// How many groups the segments have at most, however their intervals are dealt out.
std::ptrdiff_t most_groups(const OrbitShape& shape) {
  const std::ptrdiff_t m = shape.segments;
  return shape.own ? (m * shape.intervals + m * (lanes - 1)) / lanes : m * LaneSchedule(shape.intervals).groups();
}

/// work(reciprocal pivot, is its row exchanged with another one?) for all pivots of a block in the lanes that count:
/// eliminated blocks hold reciprocal pivots.
template <class Counts, class Work>
void for_pivots(const LaneKernel& kernel, const double* block, const int* swaps, const Counts& counts,
                const Work& work) {
  for (int l = 0; l < lanes; ++l) {
    if (!counts(l)) continue;
    for (int k = 0; k < kernel.pivots(); ++k)
      work(block[static_cast<std::ptrdiff_t>(k * kernel.stride() + k) * lanes + l], swaps[k * lanes + l] != k);
  }
}

/// The sign of a product of pivots.
class SignProduct {
 public:
  void operator()(double reciprocal, bool exchanged) {
    signs_ ^= std::bit_cast<std::uint64_t>(reciprocal);
    exchanges_ ^= exchanged ? 1U : 0U;
  }
  bool negative() const { return (signs_ >> 63U) != exchanges_; }

 private:
  std::uint64_t signs_ = 0;  // in the highest bit
  unsigned exchanges_ = 0;
};

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
      plans_(index(shape.segments)),
      first_groups_(index(shape.segments + 1)),
      interval_(shape.collocation * n_, (shape.collocation - 1) * n_, (shape.collocation + 1) * n_ + columns_),
      join_(2 * n_, n_, 3 * n_ + columns_),
      top_join_(join_kernel(n_, columns_)),
      within_(threads.within),
      keeps_segments_(threads.segments > 1),
      keeps_groups_(threads.within > 1) {
  deal_out(shape);
  const std::ptrdiff_t blocks = most_groups(shape);
  const std::ptrdiff_t joins = blocks - shape.segments;
  const std::ptrdiff_t of_segment = shape.own ? blocks : plan(0).groups;
  outcomes_.resize(index(of_segment));
  const int interval_rows = interval_.rows() + border_;
  const int join_rows = join_.rows() + border_;
  interval_blocks_ = {blocks, interval_.block_size(border_)};
  interval_swaps_ = {blocks, interval_.pivots() * lanes};
  join_blocks_ = {joins, join_.block_size(border_)};
  join_swaps_ = {joins, join_.pivots() * lanes};
  interval_rhs_ = {blocks, interval_rows * lanes};
  join_rhs_ = {joins, join_rows * lanes};

  const std::ptrdiff_t tops = top_block(shape.segments, 0);
  top_blocks_ = {tops, join_rows * top_join_.width()};
  top_swaps_ = {tops, n_};
  lane_rhs_ = {tops, n_ + border_};
  top_rhs_ = {tops, join_rows};
  whole_ = {shape.segments, (n_ + border_) * length()};
  largest_residuals_.resize(index(blocks));
  negative_groups_.resize(index(blocks));
  negative_joins_.resize(index(joins));
  negative_top_joins_.resize(index(tops));

  const int c = shape.collocation;
  nodes_ = lane_zeros((c + 1) * n_);
  points_ = lane_zeros(c * n_);
  zero_rhs_ = lane_zeros(std::max(interval_rows, join_rows));
  const std::ptrdiff_t kept = keeps_segments_ ? blocks : keeps_groups_ ? of_segment : 1;
  f_ = derivatives_ = {kept, c * n_ * lanes};
  fx_ = {kept, c * n_ * n_ * lanes};
  fp_ = {kept, c * n_ * (scalars_ - 1) * lanes};
  x_of_points_.resize(index(c * n_ * lanes));
  f_of_points_.resize(index(c * n_ * lanes));
  fx_of_points_.resize(index(c * n_ * n_ * lanes));
  fp_of_points_.resize(index(c * n_ * (scalars_ - 1) * lanes));
  const int workers = std::max(threads.segments, threads.within);
  constexpr auto together = static_cast<std::ptrdiff_t>(most_together);
  lane_pieces_ = {std::ptrdiff_t{lanes} * workers, (n_ + border_) * length()};
  jacobian_ = {workers, n_ * n_ * lanes};
  residual_ = {workers, c * n_ * lanes};
  local_ = {together * workers, interval_.width() * lanes};
  join_local_ = {together * workers, join_.width() * lanes};
  top_local_ = {workers, top_join_.width()};
}

/// Made when it is needed first; segments of equally many intervals have one in common.
const SegmentPlan& SegmentElimination::plan_for(int intervals) {
  const auto known = std::find_if(known_plans_.begin(), known_plans_.end(),
                                  [&](const auto& plan) { return plan->schedule.intervals() == intervals; });
  if (known != known_plans_.end()) return **known;
  return *known_plans_.emplace_back(std::make_unique<const SegmentPlan>(intervals));
}

void SegmentElimination::deal_out(const OrbitShape& shape) {
  shape_ = shape;
  for (int s = 0; s < shape.segments; ++s) {
    plans_[index(s)] = &plan_for(shape.intervals_of(s));
    first_groups_[index(s + 1)] = first_groups_[index(s)] + plan(s).groups;
  }
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
  const int groups = plan(s).groups;
  fetch_segment(s + 1, x.states);
  fetch_top_joins(s + 1);
  within_.run(
      groups, [&](int group) { evaluate_group(s, group, system, field, active, x); },
      [&](int group, int thread) { outcomes_[index(group)] = condense_group(s, group, x, rows, collocation, thread); });
  if (const Linearization outcome = worst(std::span(outcomes_).first(index(groups))); outcome != Linearization::ready)
    return outcome;
  return join_groups(s) && join_lanes(s, 0) ? Linearization::ready : Linearization::singular;
}

void SegmentElimination::evaluate(int s, const HybridSystem& system, int field, std::span<const int> active,
                                  const Orbit& x) {
  assert(keeps_segments_);
  for (int group = 0; group < plan(s).groups; ++group) evaluate_group(s, group, system, field, active, x);
}

Linearization SegmentElimination::condense_evaluated(int s, const Orbit& x, std::span<const OrbitVector> rows,
                                                     double* collocation, int thread) {
  Linearization all = Linearization::ready;
  for (int group = 0; group < plan(s).groups; ++group)
    all = worst(std::array{all, condense_group(s, group, x, rows, collocation, thread)});
  if (all != Linearization::ready) return all;
  for (const Join& at : plan(s).joins)
    if (!join(s, at)) return Linearization::singular;
  return join_lanes(s, thread) ? Linearization::ready : Linearization::singular;
}

double SegmentElimination::largest_residual() const {
  return *std::max_element(largest_residuals_.begin(), largest_residuals_.begin() + first_groups_.back());
}

Linearization SegmentElimination::condense_group(int s, int group, const Orbit& x, std::span<const OrbitVector> rows,
                                                 double* collocation, int thread) {
  if (!fill_group(s, group, x, collocation, thread)) return Linearization::not_finite;
  fill_border(s, group, rows);
  return eliminate_group(s, group) ? Linearization::ready : Linearization::singular;
}

bool SegmentElimination::eliminate_group(int s, int group) {
  const std::ptrdiff_t b = block(s, group);
  if (interval_.eliminate(interval_blocks_[b], border_, interval_swaps_[b], interval_blocks_.behind(b)) != 0)
    return false;
  SignProduct sign;
  for_pivots_of_group(s, group, std::ref(sign));
  negative_groups_[index(b)] = sign.negative();
  return true;
}

bool SegmentElimination::join_groups(int s) {
  for_joins(s, [&](const Join& at, int) {
    outcomes_[index(at.middle)] = join(s, at) ? Linearization::ready : Linearization::singular;
  });
  return worst(std::span(outcomes_).first(index(plan(s).groups))) == Linearization::ready;
}

LanePiece SegmentElimination::piece(int s, int first, int last) const {
  const bool one_interval = last - first == 1;
  const LaneKernel& kernel = one_interval ? interval_ : join_;
  const double* block = one_interval ? interval_blocks_[this->block(s, first)]
                                     : join_blocks_[this->block(s, plan(s).join_of(first, last))];
  const int p = kernel.pivots(), stride = kernel.stride();
  return {block + (p * stride + p) * lanes, block + (kernel.rows() * stride + p) * lanes, stride};
}

bool SegmentElimination::join(int s, const Join& at) {
  const std::ptrdiff_t b = block(s, at);
  double* target = join_blocks_[b];
  const LanePiece left = piece(s, at.first, at.middle);
  assembly_.join({n_, columns_, border_, join_.stride()}, left, piece(s, at.middle, at.last), target);
  for (int l = 0; l < lanes; ++l)
    if (plan(s).passes(at, l)) pass_on(left, l, target);
  if (join_.eliminate(target, border_, join_swaps_[b], join_blocks_.behind(b)) != 0) return false;
  SignProduct sign;
  for_pivots_of_join(s, at, std::ref(sign));
  negative_joins_[index(b)] = sign.negative();
  return true;
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
const double* SegmentElimination::top_piece(int s, int first, int last, int thread, int& width) const {
  if (last - first == 1) {
    width = length();
    return lane_pieces_[lane_piece(thread, first)];
  }
  width = top_join_.width();
  return top_blocks_[top_block(s, halfway(first, last))] + n_ * width + n_;
}

/// The joins between lanes: columns (middle | first | last | scalars), rows (left piece | right piece | border).
bool SegmentElimination::join_lanes(int s, int thread) {
  const SegmentPlan& plan = this->plan(s);
  const LanePiece all = piece(s, 0, plan.groups);
  const int pieces = static_cast<int>(plan.top_lanes.size());
  for (int k = 0; k < pieces; ++k) {
    double* to = lane_pieces_[lane_piece(thread, k)];
    for (int a = 0; a < n_; ++a, to += length())
      take_lane(all.rows + a * all.stride * lanes, plan.top_lanes[index(k)], length(), to);
    for (int r = 0; r < border_; ++r, to += length())
      take_lane(all.border + r * all.stride * lanes, plan.top_lanes[index(k)], length(), to);
  }
  const int width = top_join_.width();
  for (const Join& at : plan.top_joins) {
    double* target = top_blocks_[top_block(s, at.middle)];
    std::fill_n(target, (top_join_.rows() + border_) * width, 0.0);
    int left_width = 0;
    int right_width = 0;
    const double* left = top_piece(s, at.first, at.middle, thread, left_width);
    const double* right = top_piece(s, at.middle, at.last, thread, right_width);
    for (int i = 0; i < n_ + border_; ++i, left += left_width, right += right_width) {
      double* to = target + (i < n_ ? i : n_ + i) * width;
      for (int a = 0; a < n_; ++a) to[a] = left[n_ + a], to[n_ + a] = left[a];
      for (int k = 0; k < columns_; ++k) to[3 * n_ + k] = left[2 * n_ + k];
      to = target + (n_ + i) * width;
      for (int a = 0; a < n_; ++a) to[a] += right[a];
      for (int k = 0; k < n_ + columns_; ++k) to[2 * n_ + k] += right[n_ + k];
    }
    if (!top_join_.eliminate(target, border_, top_swaps_[top_block(s, at.middle)])) return false;
    SignProduct sign;
    for_pivots_of_top_join(s, at, std::ref(sign));
    negative_top_joins_[index(top_block(s, at.middle))] = sign.negative();
  }
  int last_width = 0;
  const double* from = top_piece(s, 0, pieces, thread, last_width);
  for (int i = 0; i < n_ + border_; ++i, from += last_width) std::copy_n(from, length(), whole_[s] + i * length());
  return true;
}

template <class Work>
void SegmentElimination::for_pivots_of_group(int s, int group, const Work& work) const {
  const std::ptrdiff_t b = block(s, group);
  const auto counts = [&](int lane) { return plan(s).schedule.holds(group, lane); };
  for_pivots(interval_, interval_blocks_[b], interval_swaps_[b], counts, work);
}

template <class Work>
void SegmentElimination::for_pivots_of_join(int s, const Join& at, const Work& work) const {
  const std::ptrdiff_t b = block(s, at);
  const auto counts = [&](int lane) { return !plan(s).passes(at, lane); };
  for_pivots(join_, join_blocks_[b], join_swaps_[b], counts, work);
}

template <class Work>
void SegmentElimination::for_pivots_of_top_join(int s, const Join& at, const Work& work) const {
  const double* block = top_blocks_[top_block(s, at.middle)];
  const int* swaps = top_swaps_[top_block(s, at.middle)];
  for (int k = 0; k < n_; ++k) work(block[std::ptrdiff_t{k} * top_join_.width() + k], swaps[k] != k);
}

void SegmentElimination::divide_by_determinant(LargeProduct& product) const {
  const auto divide = [&](double reciprocal, bool exchanged) {
    product.multiply(exchanged ? -reciprocal : reciprocal);
  };
  for (int s = 0; s < shape_.segments; ++s) {
    for (int group = 0; group < plan(s).groups; ++group) for_pivots_of_group(s, group, divide);
    for (const Join& at : plan(s).joins) for_pivots_of_join(s, at, divide);
    for (const Join& at : plan(s).top_joins) for_pivots_of_top_join(s, at, divide);
  }
}

int SegmentElimination::determinant_sign() const {
  unsigned negative = 0;
  const auto count = [&](const std::vector<unsigned char>& of, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = 0; i < end; ++i) negative ^= of[index(i)];
  };
  count(negative_groups_, first_groups_.back());
  count(negative_joins_, first_groups_.back() - shape_.segments);
  for (int s = 0; s < shape_.segments; ++s)
    for (const Join& at : plan(s).top_joins) negative ^= negative_top_joins_[index(top_block(s, at.middle))];
  return negative == 0 ? 1 : -1;
}

// The rows of a segment's Newton matrix: SegmentElimination::evaluate_group and fill_group.

// What a problem gives in lanes goes to the elimination as it is.
static_assert(lanes == TCHAT_POINTS_OF_SET);

std::ptrdiff_t SegmentElimination::field_block(int s, int group) const {
  return keeps_segments_ ? block(s, group) : keeps_groups_ ? group : 0;
}

/// The field and its derivatives at the Gauss points of a group's intervals.
void SegmentElimination::evaluate_group(int s, int group, const HybridSystem& system, int field,
                                        std::span<const int> active, const Orbit& x) {
  const double* from[lanes];
  for (int l = 0; l < lanes; ++l) from[l] = x.node(s, plan(s).schedule.interval(group, l) * shape_.collocation);
  assembly_.gather(from, (shape_.collocation + 1) * n_, nodes_.data());
  LaneCollocation at{};
  at.n = n_;
  at.c = shape_.collocation;
  at.value = rule_.value.data();
  at.slope = rule_.slope.data();
  const std::ptrdiff_t b = field_block(s, group);
  assembly_.interpolate(at, nodes_.data(), points_.data(), derivatives_[b]);
  if (system.has_first_in_lanes())
    system.first_in_lanes(FunctionKind::field, field, shape_.collocation, points_.data(), x.par.data(), active, f_[b],
                          fx_[b], fp_[b]);
  else
    evaluate_at_points(s, group, system, field, active, x);
}

/// The same at the points of the lanes that hold an interval, one after the other.
void SegmentElimination::evaluate_at_points(int s, int group, const HybridSystem& system, int field,
                                            std::span<const int> active, const Orbit& x) {
  const int c = shape_.collocation;
  const std::ptrdiff_t b = field_block(s, group);
  int place[lanes];  // of a lane's first point
  int held = 0;
  for (int l = 0; l < lanes; ++l)
    if (plan(s).schedule.holds(group, l)) place[l] = held, held += c;
  double* to[lanes];
  for (int l = 0; l < lanes; ++l)
    to[l] = plan(s).schedule.holds(group, l) ? x_of_points_.data() + place[l] * n_ : nullptr;
  assembly_.scatter(points_.data(), c * n_, to);
  system.first_at_points(FunctionKind::field, field, held, x_of_points_.data(), x.par.data(), active,
                         f_of_points_.data(), fx_of_points_.data(), fp_of_points_.data());
  const auto gather = [&](const std::vector<double>& of_points, int size, double* of_lanes) {
    const double* from[lanes];
    for (int l = 0; l < lanes; ++l) from[l] = of_points.data() + place[plan(s).schedule.source(group, l)] * size;
    assembly_.gather(from, c * size, of_lanes);
  };
  gather(f_of_points_, n_, f_[b]);
  gather(fx_of_points_, n_ * n_, fx_[b]);
  gather(fp_of_points_, n_ * (scalars_ - 1), fp_[b]);
}

/// Collocation rows slope - h T f at the Gauss points, columns (interior | left | right | T, p | residual).
bool SegmentElimination::fill_group(int s, int group, const Orbit& x, double* collocation, int thread) {
  const std::ptrdiff_t b = field_block(s, group);
  LaneCollocation at{
      n_, shape_.collocation, scalars_, rule_.value.data(), rule_.slope.data(), f_[b], fx_[b], fp_[b], {},
      {}, derivatives_[b]};
  const double* const mesh = x.mesh_of(s);
  for (int l = 0; l < lanes; ++l) {
    const int j = plan(s).schedule.interval(group, l);
    at.h[l] = mesh[j + 1] - mesh[j];
    at.scale[l] = at.h[l] * x.duration(s);
  }
  const bool finite =
      assembly_.fill(at, interval_.stride(), interval_blocks_[block(s, group)], jacobian_[thread], residual_[thread]);
  if (finite) keep_residual(s, group, collocation, residual_[thread]);
  return finite;
}

/// Lanes that hold no interval have the residual of one that is held.
void SegmentElimination::keep_residual(int s, int group, double* collocation, const double* residual) {
  const int rows = interval_.rows();
  largest_residuals_[index(block(s, group))] =
      array_functions().range(residual, static_cast<long>(rows) * lanes).largest;
  if (collocation == nullptr) return;
  double* to[lanes];
  for (int l = 0; l < lanes; ++l)
    to[l] = plan(s).schedule.holds(group, l) ? collocation + plan(s).schedule.interval(group, l) * rows : nullptr;
  assembly_.scatter(residual, rows, to);
}

/// Border rows of intervals: the interior nodes and the left mesh node; the right one belongs to the next interval,
/// except at the end of the segment. The scalars' own weights are added when the segments are assembled.
void SegmentElimination::fill_border(int s, int group, std::span<const OrbitVector> rows) {
  const int width = interval_.width();
  const int left = interval_.pivots();
  const int row_length = interval_.stride() * lanes;
  double* row = interval_blocks_[block(s, group)] + interval_.rows() * row_length;
  for (int r = 0; r < border_; ++r, row += row_length) {
    const double* left_node[lanes];
    const double* interior[lanes];
    for (int l = 0; l < lanes; ++l) {
      const int j = plan(s).schedule.interval(group, l);
      left_node[l] = rows[index(r)].states.col(shape_.first_node(s) + j * shape_.collocation).data();
      interior[l] = left_node[l] + n_;
    }
    assembly_.gather(interior, left, row);
    assembly_.gather(left_node, n_, row + left * lanes);
    std::fill_n(row + (left + n_) * lanes, (width - left - n_) * lanes, 0.0);
    for (int l = 0; l < lanes; ++l)
      if (plan(s).schedule.interval(group, l) == shape_.intervals_of(s) - 1)
        put_lane(interior[l] + left, n_, l, row + (left + n_) * lanes);
  }
}

}  // namespace tchat
