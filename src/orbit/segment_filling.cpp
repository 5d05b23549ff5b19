// The rows of a segment's Newton matrix: SegmentElimination::evaluate_group and fill_group.
#include <algorithm>

#include "linear/array_kernel.hpp"
#include "orbit/lane_entries.hpp"
#include "orbit/segment_elimination.hpp"

namespace tchat {

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
