// Right-hand sides of a segment, and its solutions from what is left at its ends.
#include <algorithm>

#include "bvp/lane_entries.hpp"
#include "bvp/segment_elimination.hpp"

namespace tchat {

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

}  // namespace tchat
