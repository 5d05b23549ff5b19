/// Condensation of one segment: the order in which its intervals are eliminated, the rows of its Newton matrix, and
/// their elimination. segment_solution.cpp solves with the factors.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "linear/lane_kernel.hpp"
#include "linear/memory.hpp"
#include "linear/partial_lu.hpp"
#include "linear/shared_work.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// Numbers of one lane of arrays whose entries are `lanes` numbers side by side.

/// `count` numbers of one lane from and to an array of their own.
inline void take_lane(const double* from, int lane, int count, double* to) {
  for (int k = 0; k < count; ++k) to[k] = from[k * lanes + lane];
}
inline void put_lane(const double* from, int count, int lane, double* to) {
  for (int k = 0; k < count; ++k) to[k * lanes + lane] = from[k];
}

/// The same number in all lanes.
inline void put_lanes(double value, double* to) { std::fill_n(to, lanes, value); }

// In which order the intervals of a segment are eliminated, and its pieces joined; by their number alone.

/// Which interval of a segment is where. Lanes have equally many intervals or one less: those have none in the last
/// group, the last lane always has one.
class LaneSchedule {
 public:
  explicit LaneSchedule(int intervals) : intervals_(intervals) {}
  int intervals() const { return intervals_; }
  /// Sets of one interval in each lane.
  int groups() const { return (intervals_ + lanes - 1) / lanes; }
  /// The first interval of a lane; that of lane `lanes` is the number of intervals.
  int start(int lane) const { return static_cast<int>(static_cast<long>(lane) * intervals_ / lanes); }
  int size(int lane) const { return start(lane + 1) - start(lane); }
  bool holds(int group, int lane) const { return group < size(lane); }
  /// The lane whose interval a lane computes with in a group: its own, or where it has none the last one's.
  int source(int group, int lane) const { return holds(group, lane) ? lane : lanes - 1; }
  int interval(int group, int lane) const { return start(source(group, lane)) + group; }
  /// The mesh node of a lane before its interval `group`, or where it has none at its end.
  int node(int group, int lane) const { return group < size(lane) ? start(lane) + group : start(lane + 1); }

 private:
  int intervals_;
};

/// The elimination of what is between pieces first..middle-1 and middle..last-1.
struct PieceJoin {
  int first, middle, last;
  int number = 0;  ///< among all joins in the order in which they are done
};

struct SegmentPlan {
  explicit SegmentPlan(int intervals);

  LaneSchedule schedule;
  int groups;
  std::vector<PieceJoin> joins;                ///< of groups, each after those that make its two pieces
  std::vector<int> number_of_middle;           ///< of those joins
  std::vector<std::vector<PieceJoin>> levels;  ///< the same, those of one level independent of one another
  std::vector<int> top_lanes;                  ///< that have intervals
  std::vector<PieceJoin> top_joins;            ///< of top_lanes

  static int halfway(int first, int last) { return first + (last - first) / 2; }
  const PieceJoin& join_of(int first, int last) const {
    return joins[static_cast<std::size_t>(number_of_middle[static_cast<std::size_t>(halfway(first, last))])];
  }
  /// Does a lane have nothing on the right side of a join?
  bool passes(const PieceJoin& at, int lane) const { return at.middle >= schedule.size(lane); }
  /// The mesh node where a piece of a lane begins; of one beyond the last, where the segment ends.
  int top_node(int piece) const {
    return piece < static_cast<int>(top_lanes.size()) ? schedule.start(top_lanes[static_cast<std::size_t>(piece)])
                                                      : schedule.intervals();
  }
};

// Elimination of all unknowns of a segment but those at its ends, the duration and the free parameters (5.30-5.49),
// four mesh intervals at a time in the lanes of vector registers.
//
// Each of the four lanes has a quarter of the segment's intervals, one behind the other: what is done to intervals,
// and to the joins of neighbouring ones, is the same in all lanes and touches one another's values nowhere. Then:
//   1. interval: the c - 1 interior nodes are eliminated from the c n collocation rows; n rows in (left, right)
//   remain;
//   2. joins: neighbouring pieces are joined by elimination of the mesh node between them with pivoting, halves of a
//   quarter from their halves, and at last the quarters, until n rows remain,
//          A x(0) + C x(1) + B (T, p) + r = 0                                         (5.48-5.49 with C kept)
//   The residual is one more column: its unknown is 1 for Newton's correction, 0 for null vectors.
//   The order matters. From left to right the same elimination becomes a product of transfer matrices wherever the
//   flow grows little per interval: every pivot is then an entry of the longer piece, rounding grows like the flow
//   over the whole segment, up to 2^(n N), and decaying modes are lost [S. J. Wright, SIAM J. Sci. Comput. 14 (1993)
//   231]. Pieces of equal length show their growth to the pivot search; rounding grows by 2^n for each of the log2 N
//   levels at most, by little in practice.
//
// Border rows are eliminated on the way. Work and memory are linear in the number of intervals. All arrays are
// allocated when the object is made, except for plans: each number of intervals gets one when a segment first has it.
//
// Several threads: segments have nothing to do with one another, and neither have the groups of a segment, nor joins
// of one level. Whoever has a piece writes to its own blocks alone, so that results do not depend on the threads to
// the last bit. The problem's functions need not be re-entrant: one thread calls them, and others fill and eliminate
// meanwhile with what it has found. As a rule blocks, which are large, stay with the thread that they were filled by,
// where they are eliminated, joined and solved: processors may share no cache.

/// Outcome of a linearisation; factors exist only when it is `ready`. `condition_lost`: the condition of a
/// two-parameter curve cannot be evaluated.
enum class Linearization { ready, not_finite, singular, condition_lost };

/// A product that may be larger or smaller than any double: mantissa * 2^exponent.
struct LargeProduct {
  double mantissa = 1.0;
  long exponent = 0;
  void multiply(double factor);
};

/// What a segment is to be solved for: the rows' own residual with its sign changed (Newton's correction), zero (null
/// vectors), or what condense_right_hand_side() was given last.
enum class RightHandSide { own, zero, condensed };

/// A solution of which the ends of a segment are known.
struct SegmentSolution {
  RightHandSide right = RightHandSide::zero;
  const double* ends = nullptr;     ///< 2 n + 1: first node, last node, duration
  const double* globals = nullptr;  ///< q: changes of the free parameters
  OrbitVector* dx = nullptr;        ///< that gets all nodes and the duration
};

/// Threads that work on an orbit at a time: as many segments are done at once, or as many pieces of one segment. One of
/// the two is 1.
struct EliminationThreads {
  int segments = 1;
  int within = 1;
};

class SegmentElimination {
 public:
  /// Of all segments of an orbit with `scalars` columns (duration and free parameters) and `border` rows. As many
  /// different segments as `threads` says may be worked on by different threads at a time.
  SegmentElimination(const OrbitShape& shape, int scalars, int border, const CollocationRule& rule,
                     const EliminationThreads& threads = {});

  /// For orbits that have as many intervals, dealt out to segments with meshes of their own in another way. What was
  /// eliminated is lost.
  void deal_out(const OrbitShape& shape);

  /// The collocation rows of segment s, whose field has this number, at x and `rows`' parts of the segment, eliminated.
  /// `collocation` becomes their residual, unless it is null: interval, Gauss point, component. The same as evaluate()
  /// and condense_evaluated(), each piece condensed as soon as it is evaluated.
  Linearization condense(int s, const HybridSystem& system, int field, std::span<const int> active, const Orbit& x,
                         std::span<const OrbitVector> rows, double* collocation);
  /// Only what the problem's functions say, where several threads have segments; for one segment at a time.
  void evaluate(int s, const HybridSystem& system, int field, std::span<const int> active, const Orbit& x);
  /// What evaluate() left, by thread number `thread` < `segments` of the threads.
  Linearization condense_evaluated(int s, const Orbit& x, std::span<const OrbitVector> rows, double* collocation,
                                   int thread);

  /// The largest magnitude of the residual of all segments' rows, as they were filled last.
  double largest_residual() const;

  /// What is left of segment s: n rows of length() entries, columns (first node | last node | scalars | residual), and
  /// b border rows.
  const double* rows(int s) const { return whole_[s]; }
  const double* border(int s) const { return whole_[s] + n_ * length(); }
  int length() const { return 2 * n_ + columns_; }

  /// The right-hand side -collocation of segment s, condensed to n + b entries.
  void condense_right_hand_side(int s, const double* collocation, double* condensed);
  /// From the ends of segment s to all nodes. `thread` < `segments` of the threads, another one for each at a time.
  void expand(int s, const SegmentSolution& solution, int thread = 0) {
    expand_together(s, std::span(&solution, 1), thread);
  }
  /// At most `most_together` at once, each to the last bit what it is alone; where there are several, none for a
  /// condensed right-hand side.
  void expand_together(int s, std::span<const SegmentSolution> solutions, int thread = 0);
  static constexpr std::size_t most_together = 4;
  /// The adjoint: weights (n) of the condensed rows to weights of the collocation rows of segment s. Right-hand sides
  /// are lost.
  void expand_adjoint(int s, const double* weights, double* collocation);

  /// Divided by the determinant of what was eliminated of all segments.
  void divide_by_determinant(LargeProduct& product) const;
  /// Of that determinant: 1 or -1.
  int determinant_sign() const;

 private:
  using Join = PieceJoin;
  static int halfway(int first, int last) { return SegmentPlan::halfway(first, last); }
  static std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }
  const SegmentPlan& plan_for(int intervals);
  const SegmentPlan& plan(int s) const { return *plans_[index(s)]; }
  /// Numbers of blocks of a group, of a join within lanes, and of a lane or a join between lanes. A segment has one
  /// join less than groups.
  std::ptrdiff_t block(int s, int group) const { return first_groups_[index(s)] + group; }
  std::ptrdiff_t block(int s, const Join& at) const { return first_groups_[index(s)] - s + at.number; }
  std::ptrdiff_t top_block(int s, int middle) const { return static_cast<std::ptrdiff_t>(s) * lanes + middle; }

  /// The number of the block in lane_pieces_ that this thread has for what a lane leaves.
  static std::ptrdiff_t lane_piece(int thread, int lane) { return std::ptrdiff_t{thread} * lanes + lane; }

  template <class Work>
  void for_pivots_of_group(int s, int group, const Work& work) const;
  template <class Work>
  void for_pivots_of_join(int s, const Join& at, const Work& work) const;
  template <class Work>
  void for_pivots_of_top_join(int s, const Join& at, const Work& work) const;
  /// Where the values of the field in a group are kept, until its block is filled.
  std::ptrdiff_t field_block(int s, int group) const;
  void evaluate_group(int s, int group, const HybridSystem& system, int field, std::span<const int> active,
                      const Orbit& x);
  void evaluate_at_points(int s, int group, const HybridSystem& system, int field, std::span<const int> active,
                          const Orbit& x);
  Linearization condense_group(int s, int group, const Orbit& x, std::span<const OrbitVector> rows, double* collocation,
                               int thread);
  bool fill_group(int s, int group, const Orbit& x, double* collocation, int thread);
  void keep_residual(int s, int group, double* collocation, const double* residual);
  void fill_border(int s, int group, std::span<const OrbitVector> rows);
  LanePiece piece(int s, int first, int last) const;
  bool eliminate_group(int s, int group);
  bool join_groups(int s);
  template <class Work>
  void for_joins(int s, const Work& work);
  template <class Work>
  void for_joins_in_reverse(int s, const Work& work);
  bool join(int s, const Join& at);
  void pass_on(const LanePiece& left, int lane, double* target) const;
  bool join_lanes(int s, int thread);
  void condense_group_rhs(int s, int group, const double* collocation);
  void condense_join_rhs(int s, const Join& at);
  const double* top_piece(int s, int first, int last, int thread, int& width) const;
  double* piece_rhs(int s, int first, int last);
  double* top_rhs(int s, int first, int last);
  static std::ptrdiff_t first_local(int thread) { return static_cast<std::ptrdiff_t>(most_together) * thread; }
  void fetch_segment(int s, const Eigen::MatrixXd& states) const;
  void fetch_top_joins(int s) const;
  void put_ends(int s, const SegmentSolution& of);
  void expand_top_join(int s, const Join& at, const SegmentSolution& of, int thread);
  void put_scalars(const SegmentSolution& of, double* to) const;
  void expand_lane_join(int s, const Join& at, std::span<const SegmentSolution> solutions, int thread);
  void gather_around_join(int s, const Join& at, const SegmentSolution& of, double* local) const;
  void scatter_from_join(int s, const Join& at, const double* local, const SegmentSolution& of) const;
  void expand_group(int s, int group, std::span<const SegmentSolution> solutions, int thread);
  void gather_around_group(int s, int group, const SegmentSolution& of, double* local) const;
  void scatter_from_group(int s, int group, const double* local, const SegmentSolution& of) const;
  void expand_adjoint_join(int s, const Join& at);
  void expand_adjoint_group(int s, int group, double* collocation);

  OrbitShape shape_;
  int n_;
  int scalars_;  // duration and free parameters
  int columns_;  // scalars and the residual
  int border_;
  CollocationRule rule_;
  std::vector<std::unique_ptr<const SegmentPlan>> known_plans_;  // of different numbers of intervals
  std::vector<const SegmentPlan*> plans_;                        // of segments
  std::vector<std::ptrdiff_t> first_groups_;                     // of segments, and behind the last one
  LaneAssembly assembly_;
  LaneKernel interval_;
  LaneKernel join_;
  BlockKernel top_join_;

  // of groups and joins
  BlockArray<double> interval_blocks_;  // (c n + b) x stride
  BlockArray<int> interval_swaps_;
  BlockArray<double> join_blocks_;  // (2 n + b) x stride
  BlockArray<int> join_swaps_;
  BlockArray<double> interval_rhs_;
  BlockArray<double> join_rhs_;
  // of segments: four each
  BlockArray<double> top_blocks_;  // (2 n + b) x width
  BlockArray<int> top_swaps_;
  BlockArray<double> lane_rhs_;  // n + b
  BlockArray<double> top_rhs_;   // 2 n + b
  // one each
  BlockArray<double> whole_;  // (n + b) x length

  std::vector<double> largest_residuals_;  // of groups
  // is the determinant of what was eliminated negative? Found while the block is in the cache.
  std::vector<unsigned char> negative_groups_, negative_joins_, negative_top_joins_;

  SharedWork within_;
  bool keeps_segments_, keeps_groups_;   // whose fields are kept: all that several threads may have begun, or one
  std::vector<Linearization> outcomes_;  // of groups, or of the joins of these numbers

  // of groups that are evaluated and not yet filled: the field, its derivatives, and those of the polynomials
  BlockArray<double> f_, fx_, fp_, derivatives_;
  // scratch of one group, for the thread that calls the problem
  LaneArray nodes_, points_;
  std::vector<double> x_of_points_, f_of_points_, fx_of_points_, fp_of_points_;  // of problems that have no lanes
  LaneArray zero_rhs_;
  // of threads
  BlockArray<double> jacobian_, residual_, local_, join_local_, top_local_;
  BlockArray<double> lane_pieces_;  // four each, (n + b) x length
};

/// work(join, thread), each after those that make its two pieces: one after the other in the order that goes on with
/// what was made last, or all of a level at a time.
template <class Work>
void SegmentElimination::for_joins(int s, const Work& work) {
  if (within_.threads() == 1)
    for (const Join& at : plan(s).joins) work(at, 0);
  else
    for (const std::vector<Join>& level : plan(s).levels)
      within_.each(static_cast<int>(level.size()), [&](int i, int thread) { work(level[index(i)], thread); });
}

/// The same with the pieces after the join.
template <class Work>
void SegmentElimination::for_joins_in_reverse(int s, const Work& work) {
  const SegmentPlan& of = plan(s);
  if (within_.threads() == 1)
    for (auto at = of.joins.rbegin(); at != of.joins.rend(); ++at) work(*at, 0);
  else
    for (auto level = of.levels.rbegin(); level != of.levels.rend(); ++level)
      within_.each_in_reverse(static_cast<int>(level->size()),
                              [&](int i, int thread) { work((*level)[index(i)], thread); });
}

}  // namespace tchat
