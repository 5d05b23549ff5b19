// Right-hand sides of a segment, and its solutions from what is left at its ends.
#include <algorithm>
#include <array>
#include <cassert>

#include "linear/memory.hpp"
#include "orbit/segment_elimination.hpp"

namespace tchat {

namespace {

/// The pivot unknowns of a block for one solution, with this right-hand side, or for several with none: `gather` puts
/// what is known into the local unknowns, `scatter` takes what was found. Those of a thread begin at `first_local`.
template <class Gather, class Scatter>
void solve_block(const LaneKernel& kernel, const BlockArray<double>& blocks, std::ptrdiff_t b, const double* right,
                 BlockArray<double>& locals, std::ptrdiff_t first_local, std::span<const SegmentSolution> solutions,
                 const Gather& gather, const Scatter& scatter) {
  std::array<double*, SegmentElimination::most_together> local{};
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    local[k] = locals[first_local + static_cast<std::ptrdiff_t>(k)];
    gather(solutions[k], local[k]);
  }
  if (solutions.size() == 1)
    kernel.backward(blocks[b], right, local[0], blocks.before(b));
  else
    kernel.backward_of_several(blocks[b], std::span(local).first(solutions.size()), blocks.before(b));
  for (std::size_t k = 0; k < solutions.size(); ++k) scatter(solutions[k], local[k]);
}

}  // namespace

/// The right-hand sides of a piece's n condensed rows and its border rows.
double* SegmentElimination::piece_rhs(int s, int first, int last) {
  return last - first == 1 ? interval_rhs_[block(s, first)] + interval_.pivots() * lanes
                           : join_rhs_[block(s, plan(s).join_of(first, last))] + n_ * lanes;
}

double* SegmentElimination::top_rhs(int s, int first, int last) {
  return last - first == 1 ? lane_rhs_[top_block(s, first)] : top_rhs_[top_block(s, halfway(first, last))] + n_;
}

void SegmentElimination::condense_group_rhs(int s, int group, const double* collocation) {
  const int rows = interval_.rows();
  const std::ptrdiff_t b = block(s, group);
  double* r = interval_rhs_[b];
  for (int l = 0; l < lanes; ++l) {
    const double* from = collocation + plan(s).schedule.interval(group, l) * rows;
    for (int i = 0; i < rows; ++i) r[i * lanes + l] = -from[i];
  }
  std::fill_n(r + rows * lanes, border_ * lanes, 0.0);
  interval_.forward(interval_blocks_[b], border_, interval_swaps_[b], r, interval_blocks_.behind(b));
}

void SegmentElimination::condense_join_rhs(int s, const Join& at) {
  const std::ptrdiff_t b = block(s, at);
  const double* left = piece_rhs(s, at.first, at.middle);
  const double* right = piece_rhs(s, at.middle, at.last);
  double* r = join_rhs_[b];
  const int count = n_ * lanes;
  std::copy_n(left, count, r);
  std::copy_n(right, count, r + count);
  for (int k = 0; k < border_ * lanes; ++k) r[2 * count + k] = left[count + k] + right[count + k];
  for (int l = 0; l < lanes; ++l) {
    if (!plan(s).passes(at, l)) continue;
    for (int a = 0; a < n_; ++a) r[a * lanes + l] = 0.0, r[count + a * lanes + l] = left[a * lanes + l];
    for (int k = 0; k < border_; ++k) r[2 * count + k * lanes + l] = left[count + k * lanes + l];
  }
  join_.forward(join_blocks_[b], border_, join_swaps_[b], r, join_blocks_.behind(b));
}

void SegmentElimination::condense_right_hand_side(int s, const double* collocation, double* condensed) {
  const SegmentPlan& plan = this->plan(s);
  fetch_top_joins(s + 1);
  within_.each(plan.groups, [&](int group, int) { condense_group_rhs(s, group, collocation); });
  for_joins(s, [&](const Join& at, int) { condense_join_rhs(s, at); });
  const double* all = piece_rhs(s, 0, plan.groups);
  const int pieces = static_cast<int>(plan.top_lanes.size());
  for (int k = 0; k < pieces; ++k) take_lane(all, plan.top_lanes[index(k)], n_ + border_, lane_rhs_[top_block(s, k)]);
  for (const Join& at : plan.top_joins) {
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
void SegmentElimination::expand_together(int s, std::span<const SegmentSolution> solutions, int thread) {
  assert(solutions.size() <= most_together);
  assert(solutions.size() == 1 || std::none_of(solutions.begin(), solutions.end(), [](const SegmentSolution& of) {
           return of.right == RightHandSide::condensed;
         }));
  fetch_top_joins(s - 1);  // one thread solves the segments from the last one to the first
  for (const SegmentSolution& of : solutions) fetch_segment(s - 1, of.dx->states);
  for (const SegmentSolution& of : solutions) {
    put_ends(s, of);
    for (auto at = plan(s).top_joins.rbegin(); at != plan(s).top_joins.rend(); ++at)
      expand_top_join(s, *at, of, thread);
  }
  for_joins_in_reverse(
      s, [&](const Join& at, int within) { expand_lane_join(s, at, solutions, std::max(thread, within)); });
  within_.each_in_reverse(  // as blocks are fetched
      plan(s).groups, [&](int group, int within) { expand_group(s, group, solutions, std::max(thread, within)); });
}

/// Prefetches the states at the nodes of segment s. Does nothing if there is no such segment.
void SegmentElimination::fetch_segment(int s, const Eigen::MatrixXd& states) const {
  if (s < 0 || s >= shape_.segments) return;
  fetch_ahead(states.col(shape_.first_node(s)).data(), std::ptrdiff_t{shape_.nodes_of(s)} * n_);
}

/// The same of its joins between lanes.
void SegmentElimination::fetch_top_joins(int s) const {
  if (s < 0 || s >= shape_.segments) return;
  for (const Join& at : plan(s).top_joins)
    fetch_ahead(top_blocks_[top_block(s, at.middle)], std::ptrdiff_t{top_join_.rows() + border_} * top_join_.width());
}

void SegmentElimination::put_ends(int s, const SegmentSolution& of) {
  of.dx->durations(s) = of.ends[2 * n_];
  std::copy_n(of.ends, n_, of.dx->states.col(shape_.first_node(s)).data());
  std::copy_n(of.ends + n_, n_, of.dx->states.col(shape_.last_node(s)).data());
}

void SegmentElimination::expand_top_join(int s, const Join& at, const SegmentSolution& of, int thread) {
  const auto node = [&](int piece) {
    return of.dx->states.col(shape_.first_node(s) + plan(s).top_node(piece) * shape_.collocation).data();
  };
  const std::ptrdiff_t b = top_block(s, at.middle);
  double* local = top_local_[thread];
  std::copy_n(node(at.first), n_, local + n_);
  std::copy_n(node(at.last), n_, local + 2 * n_);
  double* scalars = local + 3 * n_;
  scalars[0] = of.ends[2 * n_];
  std::copy_n(of.globals, scalars_ - 1, scalars + 1);
  scalars[scalars_] = of.right == RightHandSide::own ? 1.0 : 0.0;
  top_join_.backward(top_blocks_[b], of.right == RightHandSide::condensed ? top_rhs_[b] : zero_rhs_.data(), local);
  std::copy_n(local, n_, node(at.middle));
}

/// The unknowns of the last columns, the same in all lanes.
void SegmentElimination::put_scalars(const SegmentSolution& of, double* to) const {
  put_lanes(of.ends[2 * n_], to);
  for (int k = 0; k + 1 < scalars_; ++k) put_lanes(of.globals[k], to + (1 + k) * lanes);
  put_lanes(of.right == RightHandSide::own ? 1.0 : 0.0, to + scalars_ * lanes);
}

void SegmentElimination::expand_lane_join(int s, const Join& at, std::span<const SegmentSolution> solutions,
                                          int thread) {
  const std::ptrdiff_t b = block(s, at);
  const double* right = solutions.front().right == RightHandSide::condensed ? join_rhs_[b] : zero_rhs_.data();
  solve_block(
      join_, join_blocks_, b, right, join_local_, first_local(thread), solutions,
      [&](const SegmentSolution& of, double* local) { gather_around_join(s, at, of, local); },
      [&](const SegmentSolution& of, const double* local) { scatter_from_join(s, at, local, of); });
}

void SegmentElimination::gather_around_join(int s, const Join& at, const SegmentSolution& of, double* local) const {
  const double* states = of.dx->states.col(shape_.first_node(s)).data();
  const int step = shape_.collocation * n_;
  const double* first[lanes];
  const double* last[lanes];
  for (int l = 0; l < lanes; ++l) {
    first[l] = states + plan(s).schedule.node(at.first, l) * step;
    last[l] = states + plan(s).schedule.node(at.last, l) * step;
  }
  assembly_.gather(first, n_, local + n_ * lanes);
  assembly_.gather(last, n_, local + 2 * n_ * lanes);
  put_scalars(of, local + 3 * n_ * lanes);
}

void SegmentElimination::scatter_from_join(int s, const Join& at, const double* local,
                                           const SegmentSolution& of) const {
  double* states = of.dx->states.col(shape_.first_node(s)).data();
  double* to[lanes];
  for (int l = 0; l < lanes; ++l)
    to[l] = plan(s).passes(at, l) ? nullptr : states + plan(s).schedule.node(at.middle, l) * shape_.collocation * n_;
  assembly_.scatter(local, n_, to);
}

void SegmentElimination::expand_group(int s, int group, std::span<const SegmentSolution> solutions, int thread) {
  const std::ptrdiff_t b = block(s, group);
  const double* right = solutions.front().right == RightHandSide::condensed ? interval_rhs_[b] : zero_rhs_.data();
  solve_block(
      interval_, interval_blocks_, b, right, local_, first_local(thread), solutions,
      [&](const SegmentSolution& of, double* local) { gather_around_group(s, group, of, local); },
      [&](const SegmentSolution& of, const double* local) { scatter_from_group(s, group, local, of); });
}

void SegmentElimination::gather_around_group(int s, int group, const SegmentSolution& of, double* local) const {
  const double* states = of.dx->states.col(shape_.first_node(s)).data();
  const int step = shape_.collocation * n_;
  double* ends = local + interval_.pivots() * lanes;
  const double* left[lanes];
  const double* right[lanes];
  for (int l = 0; l < lanes; ++l) {
    left[l] = states + plan(s).schedule.interval(group, l) * step;
    right[l] = left[l] + step;
  }
  assembly_.gather(left, n_, ends);
  assembly_.gather(right, n_, ends + n_ * lanes);
  put_scalars(of, ends + 2 * n_ * lanes);
}

void SegmentElimination::scatter_from_group(int s, int group, const double* local, const SegmentSolution& of) const {
  double* states = of.dx->states.col(shape_.first_node(s)).data();
  const int step = shape_.collocation * n_;
  double* to[lanes];
  for (int l = 0; l < lanes; ++l)
    to[l] = plan(s).schedule.holds(group, l) ? states + plan(s).schedule.interval(group, l) * step + n_ : nullptr;
  assembly_.scatter(local, interval_.pivots(), to);
}

void SegmentElimination::expand_adjoint(int s, const double* weights, double* collocation) {
  const SegmentPlan& plan = this->plan(s);
  const int pieces = static_cast<int>(plan.top_lanes.size());
  // Right-hand sides are no longer needed: their places serve as scratch.
  std::copy_n(weights, n_, top_rhs(s, 0, pieces));
  for (auto at = plan.top_joins.rbegin(); at != plan.top_joins.rend(); ++at) {
    const std::ptrdiff_t b = top_block(s, at->middle);
    double* w = top_rhs_[b];
    std::fill_n(w, n_, 0.0);
    top_join_.forward_transposed(top_blocks_[b], top_swaps_[b], w);
    std::copy_n(w, n_, top_rhs(s, at->first, at->middle));
    std::copy_n(w + n_, n_, top_rhs(s, at->middle, at->last));
  }
  double* all = piece_rhs(s, 0, plan.groups);
  std::fill_n(all, n_ * lanes, 0.0);
  for (int k = 0; k < pieces; ++k) put_lane(lane_rhs_[top_block(s, k)], n_, plan.top_lanes[index(k)], all);
  for_joins_in_reverse(s, [&](const Join& at, int) { expand_adjoint_join(s, at); });
  within_.each(plan.groups, [&](int group, int) { expand_adjoint_group(s, group, collocation); });
}

void SegmentElimination::expand_adjoint_join(int s, const Join& at) {
  const int count = n_ * lanes;
  const std::ptrdiff_t b = block(s, at);
  double* w = join_rhs_[b];
  std::fill_n(w, count, 0.0);
  join_.forward_transposed(join_blocks_[b], join_swaps_[b], w);
  double* left = piece_rhs(s, at.first, at.middle);
  std::copy_n(w, count, left);
  std::copy_n(w + count, count, piece_rhs(s, at.middle, at.last));
  for (int l = 0; l < lanes; ++l)
    if (plan(s).passes(at, l))
      for (int a = 0; a < n_; ++a) left[a * lanes + l] = w[count + a * lanes + l];
}

void SegmentElimination::expand_adjoint_group(int s, int group, double* collocation) {
  const int p = interval_.pivots();
  const int rows = interval_.rows();
  const std::ptrdiff_t b = block(s, group);
  double* w = interval_rhs_[b];
  std::fill_n(w, p * lanes, 0.0);
  interval_.forward_transposed(interval_blocks_[b], interval_swaps_[b], w);
  double* to[lanes];
  for (int l = 0; l < lanes; ++l)
    to[l] = plan(s).schedule.holds(group, l) ? collocation + plan(s).schedule.interval(group, l) * rows : nullptr;
  assembly_.scatter(w, rows, to);
}

}  // namespace tchat
