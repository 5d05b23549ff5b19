#include "bvp/segment_elimination.hpp"

#include <algorithm>
#include <cmath>

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

/// `count` numbers of one lane from and to an array of their own.
void take_lane(const double* from, int lane, int count, double* to) {
  for (int k = 0; k < count; ++k) to[k] = from[k * lanes + lane];
}
void put_lane(const double* from, int count, int lane, double* to) {
  for (int k = 0; k < count; ++k) to[k * lanes + lane] = from[k];
}

/// The same number in all lanes.
void put_lanes(double value, double* to) { std::fill_n(to, lanes, value); }

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
      border_(border),
      rule_(rule),
      schedule_(shape.intervals),
      groups_(schedule_.groups()),
      interval_(shape.collocation * n_, (shape.collocation - 1) * n_, (shape.collocation + 1) * n_ + scalars),
      join_(2 * n_, n_, 3 * n_ + scalars),
      top_join_(join_kernel(n_, scalars)),
      joins_(joins_of_halves(groups_)),
      levels_(levels_of(joins_)),
      top_lanes_(lanes_in_use(schedule_)),
      top_joins_(joins_of_halves(static_cast<int>(top_lanes_.size()))),
      within_(threads.within),
      done_(index(groups_)) {
  const std::ptrdiff_t blocks = block(shape.segments, 0);
  const int interval_rows = interval_.rows() + border_;
  const int join_rows = join_.rows() + border_;
  interval_blocks_ = {blocks, static_cast<std::ptrdiff_t>(interval_rows) * interval_.width() * lanes};
  interval_swaps_ = {blocks, interval_.pivots() * lanes};
  join_blocks_ = {blocks, join_rows * join_.width() * lanes};
  join_swaps_ = {blocks, join_.pivots() * lanes};
  interval_rhs_ = {blocks, interval_rows * lanes};
  join_rhs_ = {blocks, join_rows * lanes};

  const std::ptrdiff_t tops = top_block(shape.segments, 0);
  lane_pieces_ = {tops, (n_ + border_) * length()};
  top_blocks_ = {tops, join_rows * top_join_.width()};
  top_swaps_ = {tops, n_};
  lane_rhs_ = {tops, n_ + border_};
  top_rhs_ = {tops, join_rows};
  whole_ = {shape.segments, (n_ + border_) * length()};

  const int c = shape.collocation;
  nodes_ = lane_zeros((c + 1) * n_);
  points_ = derivatives_ = residual_ = lane_zeros(c * n_);
  jacobian_ = lane_zeros(n_ * n_);
  zero_rhs_ = lane_zeros(std::max(interval_rows, join_rows));
  const auto evaluations = static_cast<std::size_t>(lanes * c);
  x_.resize(evaluations * index(n_));
  f_.resize(evaluations * index(n_));
  fx_.resize(evaluations * index(n_ * n_));
  fp_.resize(evaluations * index(n_ * (scalars_ - 1)));
  const int workers = std::max(threads.segments, threads.within);
  local_ = {workers, interval_.width() * lanes};
  join_local_ = {workers, join_.width() * lanes};
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

// ---- the matrix -----------------------------------------------------------------------------------------------------

Linearization SegmentElimination::condense(int s, const HybridSystem& system, int field, std::span<const int> active,
                                           const Orbit& x, std::span<const OrbitVector> rows, double* collocation) {
  bool finite = true;
  within_.run(
      groups_, [&](int group) { return finite = fill_piece(s, group, system, field, active, x, rows, collocation); },
      [&](int group, int) { done_[index(group)] = eliminate_group(s, group) ? 1 : 0; });
  if (!finite) return Linearization::not_finite;
  if (std::find(done_.begin(), done_.end(), 0) != done_.end()) return Linearization::singular;
  return join_groups(s) && join_lanes(s) ? Linearization::ready : Linearization::singular;
}

bool SegmentElimination::fill(int s, const HybridSystem& system, int field, std::span<const int> active, const Orbit& x,
                              std::span<const OrbitVector> rows, double* collocation) {
  for (int group = 0; group < groups_; ++group)
    if (!fill_piece(s, group, system, field, active, x, rows, collocation)) return false;
  return true;
}

bool SegmentElimination::eliminate(int s) {
  for (int group = 0; group < groups_; ++group)
    if (!eliminate_group(s, group)) return false;
  for (const Join& at : joins_)
    if (!join(s, at)) return false;
  return join_lanes(s);
}

bool SegmentElimination::fill_piece(int s, int group, const HybridSystem& system, int field,
                                    std::span<const int> active, const Orbit& x, std::span<const OrbitVector> rows,
                                    double* collocation) {
  if (!fill_group(s, group, system, field, active, x, collocation)) return false;
  fill_border(s, group, rows);
  return true;
}

bool SegmentElimination::eliminate_group(int s, int group) {
  const std::ptrdiff_t b = block(s, group);
  return interval_.eliminate(interval_blocks_[b], border_, interval_swaps_[b]) == 0;
}

/// work(join, thread), each after those that make its two pieces: one after the other in the order that goes on with
/// what was made last, or all of a level at a time.
template <class Work>
void SegmentElimination::for_joins(const Work& work) {
  if (within_.threads() == 1)
    for (const Join& at : joins_) work(at, 0);
  else
    for (const std::vector<Join>& level : levels_)
      within_.each(static_cast<int>(level.size()), [&](int i, int thread) { work(level[index(i)], thread); });
}

/// The same with the pieces after the join.
template <class Work>
void SegmentElimination::for_joins_in_reverse(const Work& work) {
  if (within_.threads() == 1)
    for (auto at = joins_.rbegin(); at != joins_.rend(); ++at) work(*at, 0);
  else
    for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
      within_.each(static_cast<int>(level->size()), [&](int i, int thread) { work((*level)[index(i)], thread); });
}

bool SegmentElimination::join_groups(int s) {
  for_joins([&](const Join& at, int) { done_[index(at.middle)] = join(s, at) ? 1 : 0; });
  return std::find(done_.begin(), done_.end(), 0) == done_.end();
}

/// The field and its derivatives at the Gauss points of a group's intervals, from the lanes that hold one.
void SegmentElimination::evaluate_field(int s, int group, const HybridSystem& system, int field,
                                        std::span<const int> active, const Orbit& x) {
  const int count = shape_.collocation * n_;  // numbers of one lane
  int held = 0;
  for (int l = 0; l < lanes; ++l) {
    put_lane(x.node(s, schedule_.interval(group, l) * shape_.collocation), count + n_, l, nodes_.data());
    held += schedule_.holds(group, l) ? 1 : 0;
  }
  LaneCollocation at{};
  at.n = n_;
  at.c = shape_.collocation;
  at.value = rule_.value.data();
  at.slope = rule_.slope.data();
  assembly_.interpolate(at, nodes_.data(), points_.data(), derivatives_.data());
  double* to = x_.data();
  for (int l = 0; l < lanes; ++l)
    if (schedule_.holds(group, l)) take_lane(points_.data(), l, count, to), to += count;
  system.first_at_points(FunctionKind::field, field, held * shape_.collocation, x_.data(), x.par.data(), active,
                         f_.data(), fx_.data(), fp_.data());
}

/// Collocation rows slope - h T f at the Gauss points, columns (interior | left | right | T, p).
bool SegmentElimination::fill_group(int s, int group, const HybridSystem& system, int field,
                                    std::span<const int> active, const Orbit& x, double* collocation) {
  evaluate_field(s, group, system, field, active, x);
  const int c = shape_.collocation;
  LaneCollocation at{n_, c, scalars_, rule_.value.data(), rule_.slope.data(), {}, {}, {}, {}, {}, derivatives_.data()};
  std::ptrdiff_t place[lanes];  // of the first Gauss point among those evaluated
  std::ptrdiff_t next = 0;
  for (int l = 0; l < lanes; ++l)
    if (schedule_.holds(group, l)) place[l] = next, next += c;
  for (int l = 0; l < lanes; ++l) {
    const int j = schedule_.interval(group, l);
    const std::ptrdiff_t from = place[schedule_.source(group, l)];
    at.f[l] = f_.data() + from * n_;
    at.fx[l] = fx_.data() + from * n_ * n_;
    at.fp[l] = fp_.data() + from * n_ * (scalars_ - 1);
    at.h[l] = x.mesh[index(j + 1)] - x.mesh[index(j)];
    at.scale[l] = at.h[l] * x.duration(s);
  }
  const bool finite = assembly_.fill(at, interval_blocks_[block(s, group)], jacobian_.data(), residual_.data());
  for (int l = 0; l < lanes; ++l)
    if (schedule_.holds(group, l))
      take_lane(residual_.data(), l, c * n_, collocation + schedule_.interval(group, l) * c * n_);
  return finite;
}

/// Border rows of intervals: the interior nodes and the left mesh node; the right one belongs to the next interval,
/// except at the end of the segment. The scalars' own weights are added when the segments are assembled.
void SegmentElimination::fill_border(int s, int group, std::span<const OrbitVector> rows) {
  const int width = interval_.width();
  const int left = interval_.pivots();
  double* row = interval_blocks_[block(s, group)] + interval_.rows() * width * lanes;
  for (int r = 0; r < border_; ++r, row += width * lanes) {
    std::fill_n(row + (left + n_) * lanes, (width - left - n_) * lanes, 0.0);
    for (int l = 0; l < lanes; ++l) {
      const int j = schedule_.interval(group, l);
      const double* weights = rows[index(r)].states.col(s * shape_.nodes() + j * shape_.collocation).data();
      put_lane(weights + n_, left, l, row);
      put_lane(weights, n_, l, row + left * lanes);
      if (j == shape_.intervals - 1) put_lane(weights + left + n_, n_, l, row + (left + n_) * lanes);
    }
  }
}

LanePiece SegmentElimination::piece(int s, int first, int last) const {
  const bool one_interval = last - first == 1;
  const LaneKernel& kernel = one_interval ? interval_ : join_;
  const double* block =
      one_interval ? interval_blocks_[this->block(s, first)] : join_blocks_[this->block(s, halfway(first, last))];
  const int p = kernel.pivots(), width = kernel.width();
  return {block + (p * width + p) * lanes, block + (kernel.rows() * width + p) * lanes, width};
}

bool SegmentElimination::join(int s, const Join& at) {
  double* target = join_blocks_[block(s, at.middle)];
  const LanePiece left = piece(s, at.first, at.middle);
  assembly_.join(n_, scalars_, border_, left, piece(s, at.middle, at.last), target);
  for (int l = 0; l < lanes; ++l)
    if (passes(at, l)) pass_on(left, l, target);
  return join_.eliminate(target, border_, join_swaps_[block(s, at.middle)]) == 0;
}

/// Where a lane has nothing on the right, the join's rows say that an unknown of no meaning is zero, and then what the
/// left piece says: elimination leaves them as they are.
void SegmentElimination::pass_on(const LanePiece& left, int lane, double* target) const {
  const int width = join_.width();
  const auto entry = [&](int i, int j) -> double& { return target[(i * width + j) * lanes + lane]; };
  for (int i = 0; i < join_.rows() + border_; ++i)
    for (int j = 0; j < width; ++j) entry(i, j) = i == j && i < n_ ? 1.0 : 0.0;
  for (int a = 0; a < n_; ++a) {
    const double* from = left.rows + a * left.width * lanes;
    for (int j = 0; j < length(); ++j) entry(n_ + a, n_ + j) = from[j * lanes + lane];
  }
  for (int r = 0; r < border_; ++r) {
    const double* from = left.border + r * left.width * lanes;
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
      take_lane(all.rows + a * all.width * lanes, top_lanes_[index(k)], length(), to);
    for (int r = 0; r < border_; ++r, to += length())
      take_lane(all.border + r * all.width * lanes, top_lanes_[index(k)], length(), to);
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
      for (int k = 0; k < scalars_; ++k) to[3 * n_ + k] = left[2 * n_ + k];
      to = target + (n_ + i) * width;
      for (int a = 0; a < n_; ++a) to[a] += right[a];
      for (int k = 0; k < n_ + scalars_; ++k) to[2 * n_ + k] += right[n_ + k];
    }
    if (!top_join_.eliminate(target, border_, top_swaps_[top_block(s, at.middle)])) return false;
  }
  int last_width = 0;
  const double* from = top_piece(s, 0, pieces, last_width);
  for (int i = 0; i < n_ + border_; ++i, from += last_width) std::copy_n(from, length(), whole_[s] + i * length());
  return true;
}

// ---- right-hand sides and solutions ---------------------------------------------------------------------------------

/// The right-hand sides of a piece's n condensed rows and its border rows.
double* SegmentElimination::piece_rhs(int s, int first, int last) {
  return last - first == 1 ? interval_rhs_[block(s, first)] + interval_.pivots() * lanes
                           : join_rhs_[block(s, halfway(first, last))] + n_ * lanes;
}

double* SegmentElimination::top_rhs(int s, int first, int last) {
  return last - first == 1 ? lane_rhs_[top_block(s, first)] : top_rhs_[top_block(s, halfway(first, last))] + n_;
}

void SegmentElimination::condense_group(int s, int group, const double* collocation) {
  const int rows = interval_.rows();
  const std::ptrdiff_t b = block(s, group);
  double* r = interval_rhs_[b];
  for (int l = 0; l < lanes; ++l) {
    const double* from = collocation + schedule_.interval(group, l) * rows;
    for (int i = 0; i < rows; ++i) r[i * lanes + l] = -from[i];
  }
  std::fill_n(r + rows * lanes, border_ * lanes, 0.0);
  interval_.forward(interval_blocks_[b], border_, interval_swaps_[b], r);
}

void SegmentElimination::condense_join(int s, const Join& at) {
  const std::ptrdiff_t b = block(s, at.middle);
  const double* left = piece_rhs(s, at.first, at.middle);
  const double* right = piece_rhs(s, at.middle, at.last);
  double* r = join_rhs_[b];
  const int count = n_ * lanes;
  std::copy_n(left, count, r);
  std::copy_n(right, count, r + count);
  for (int k = 0; k < border_ * lanes; ++k) r[2 * count + k] = left[count + k] + right[count + k];
  for (int l = 0; l < lanes; ++l) {
    if (!passes(at, l)) continue;
    for (int a = 0; a < n_; ++a) r[a * lanes + l] = 0.0, r[count + a * lanes + l] = left[a * lanes + l];
    for (int k = 0; k < border_; ++k) r[2 * count + k * lanes + l] = left[count + k * lanes + l];
  }
  join_.forward(join_blocks_[b], border_, join_swaps_[b], r);
}

void SegmentElimination::condense_right_hand_side(int s, const double* collocation, double* condensed) {
  within_.each(groups_, [&](int group, int) { condense_group(s, group, collocation); });
  for_joins([&](const Join& at, int) { condense_join(s, at); });
  const double* all = piece_rhs(s, 0, groups_);
  const int pieces = static_cast<int>(top_lanes_.size());
  for (int k = 0; k < pieces; ++k) take_lane(all, top_lanes_[index(k)], n_ + border_, lane_rhs_[top_block(s, k)]);
  for (const Join& at : top_joins_) {
    const std::ptrdiff_t b = top_block(s, at.middle);
    const double* left = top_rhs(s, at.first, at.middle);
    const double* right = top_rhs(s, at.middle, at.last);
    double* r = top_rhs_[b];
    std::copy_n(left, n_, r);
    std::copy_n(right, n_, r + n_);
    for (int k = 0; k < border_; ++k) r[2 * n_ + k] = left[n_ + k] + right[n_ + k];
    top_join_.forward(top_blocks_[b], border_, top_swaps_[b], r);
  }
  std::copy_n(top_rhs(s, 0, pieces), n_ + border_, condensed);
}

/// From the ends of a segment back to the ends of lanes, to mesh nodes, joins in reverse, and on to the interior nodes.
void SegmentElimination::expand(int s, const double* ends, const double* globals, bool homogeneous, OrbitVector& dx,
                                int thread) {
  const int c = shape_.collocation;
  const double duration = ends[2 * n_];
  const auto node = [&](int k) { return dx.states.col(s * shape_.nodes() + k).data(); };
  dx.durations(s) = duration;
  std::copy_n(ends, n_, node(0));
  std::copy_n(ends + n_, n_, node(shape_.nodes() - 1));
  double* local = top_local_[thread];
  for (auto at = top_joins_.rbegin(); at != top_joins_.rend(); ++at) {
    const std::ptrdiff_t b = top_block(s, at->middle);
    std::copy_n(node(top_node(at->first) * c), n_, local + n_);
    std::copy_n(node(top_node(at->last) * c), n_, local + 2 * n_);
    local[3 * n_] = duration;
    std::copy_n(globals, scalars_ - 1, local + 3 * n_ + 1);
    top_join_.backward(top_blocks_[b], homogeneous ? zero_rhs_.data() : top_rhs_[b], local);
    std::copy_n(local, n_, node(top_node(at->middle) * c));
  }
  for_joins_in_reverse(
      [&](const Join& at, int within) { expand_lane_join(s, at, globals, homogeneous, dx, std::max(thread, within)); });
  within_.each(groups_, [&](int group, int within) {
    expand_group(s, group, globals, homogeneous, dx, std::max(thread, within));
  });
}

void SegmentElimination::expand_lane_join(int s, const Join& at, const double* globals, bool homogeneous,
                                          OrbitVector& dx, int thread) {
  const int column = s * shape_.nodes();
  const auto node = [&](int k) { return dx.states.col(column + k * shape_.collocation).data(); };
  double* local = join_local_[thread];
  put_lanes(dx.durations(s), local + 3 * n_ * lanes);
  for (int k = 0; k + 1 < scalars_; ++k) put_lanes(globals[k], local + (3 * n_ + 1 + k) * lanes);
  const std::ptrdiff_t b = block(s, at.middle);
  for (int l = 0; l < lanes; ++l) {
    put_lane(node(schedule_.node(at.first, l)), n_, l, local + n_ * lanes);
    put_lane(node(schedule_.node(at.last, l)), n_, l, local + 2 * n_ * lanes);
  }
  join_.backward(join_blocks_[b], homogeneous ? zero_rhs_.data() : join_rhs_[b], local);
  for (int l = 0; l < lanes; ++l)
    if (!passes(at, l)) take_lane(local, l, n_, node(schedule_.node(at.middle, l)));
}

void SegmentElimination::expand_group(int s, int group, const double* globals, bool homogeneous, OrbitVector& dx,
                                      int thread) {
  const int c = shape_.collocation;
  const int p = interval_.pivots();
  const auto node = [&](int k) { return dx.states.col(s * shape_.nodes() + k).data(); };
  double* local = local_[thread];
  put_lanes(dx.durations(s), local + (p + 2 * n_) * lanes);
  for (int k = 0; k + 1 < scalars_; ++k) put_lanes(globals[k], local + (p + 2 * n_ + 1 + k) * lanes);
  const std::ptrdiff_t b = block(s, group);
  for (int l = 0; l < lanes; ++l) {
    const int j = schedule_.interval(group, l);
    put_lane(node(j * c), n_, l, local + p * lanes);
    put_lane(node((j + 1) * c), n_, l, local + (p + n_) * lanes);
  }
  interval_.backward(interval_blocks_[b], homogeneous ? zero_rhs_.data() : interval_rhs_[b], local);
  for (int l = 0; l < lanes; ++l)
    if (schedule_.holds(group, l)) take_lane(local, l, p, node(schedule_.interval(group, l) * c + 1));
}

void SegmentElimination::expand_adjoint(int s, const double* weights, double* collocation) {
  const int pieces = static_cast<int>(top_lanes_.size());
  // Right-hand sides are no longer needed: their places serve as scratch.
  std::copy_n(weights, n_, top_rhs(s, 0, pieces));
  for (auto at = top_joins_.rbegin(); at != top_joins_.rend(); ++at) {
    const std::ptrdiff_t b = top_block(s, at->middle);
    double* w = top_rhs_[b];
    std::fill_n(w, n_, 0.0);
    top_join_.forward_transposed(top_blocks_[b], top_swaps_[b], w);
    std::copy_n(w, n_, top_rhs(s, at->first, at->middle));
    std::copy_n(w + n_, n_, top_rhs(s, at->middle, at->last));
  }
  double* all = piece_rhs(s, 0, groups_);
  std::fill_n(all, n_ * lanes, 0.0);
  for (int k = 0; k < pieces; ++k) put_lane(lane_rhs_[top_block(s, k)], n_, top_lanes_[index(k)], all);
  for_joins_in_reverse([&](const Join& at, int) { expand_adjoint_join(s, at); });
  within_.each(groups_, [&](int group, int) { expand_adjoint_group(s, group, collocation); });
}

void SegmentElimination::expand_adjoint_join(int s, const Join& at) {
  const int count = n_ * lanes;
  const std::ptrdiff_t b = block(s, at.middle);
  double* w = join_rhs_[b];
  std::fill_n(w, count, 0.0);
  join_.forward_transposed(join_blocks_[b], join_swaps_[b], w);
  double* left = piece_rhs(s, at.first, at.middle);
  std::copy_n(w, count, left);
  std::copy_n(w + count, count, piece_rhs(s, at.middle, at.last));
  for (int l = 0; l < lanes; ++l)
    if (passes(at, l))
      for (int a = 0; a < n_; ++a) left[a * lanes + l] = w[count + a * lanes + l];
}

void SegmentElimination::expand_adjoint_group(int s, int group, double* collocation) {
  const int p = interval_.pivots();
  const int rows = interval_.rows();
  const std::ptrdiff_t b = block(s, group);
  double* w = interval_rhs_[b];
  std::fill_n(w, p * lanes, 0.0);
  interval_.forward_transposed(interval_blocks_[b], interval_swaps_[b], w);
  for (int l = 0; l < lanes; ++l)
    if (schedule_.holds(group, l)) take_lane(w, l, rows, collocation + schedule_.interval(group, l) * rows);
}

// ---- the determinant ------------------------------------------------------------------------------------------------

void SegmentElimination::divide_by_determinant(LargeProduct& product) const {
  const auto multiply = [&](int pivots, int width, int step, const double* block, const int* swaps) {
    for (int k = 0; k < pivots; ++k) {  // the blocks hold reciprocal pivots
      const double reciprocal = block[static_cast<std::ptrdiff_t>(k * width + k) * step];
      product.multiply(swaps[k * step] == k ? reciprocal : -reciprocal);
    }
  };
  const auto multiply_lane = [&](const LaneKernel& kernel, const double* block, const int* swaps, int lane) {
    multiply(kernel.pivots(), kernel.width(), lanes, block + lane, swaps + lane);
  };
  for (int s = 0; s < shape_.segments; ++s) {
    for (int group = 0; group < groups_; ++group)
      for (int l = 0; l < lanes; ++l)
        if (schedule_.holds(group, l))
          multiply_lane(interval_, interval_blocks_[block(s, group)], interval_swaps_[block(s, group)], l);
    for (const Join& at : joins_)
      for (int l = 0; l < lanes; ++l)
        if (!passes(at, l))
          multiply_lane(join_, join_blocks_[block(s, at.middle)], join_swaps_[block(s, at.middle)], l);
    for (const Join& at : top_joins_)
      multiply(n_, top_join_.width(), 1, top_blocks_[top_block(s, at.middle)], top_swaps_[top_block(s, at.middle)]);
  }
}

}  // namespace tchat
