/// Sums over long arrays, as following a branch has them: vectors of all unknowns of an orbit.
///
/// Like those of lane_kernel.hpp the functions are compiled for several kinds of processors, one of which is chosen
/// when the program runs, and all of them do the same operations in the same order: entry i belongs to lane i % 4 of
/// sum i / 4 % 4 while 16 are left, the rest to the first sum (where several arrays are summed at once, of the one sum
/// that each has).
#pragma once

#include <array>
#include <cassert>
#include <cstddef>

#include "linear/lane_kernel.hpp"

namespace tchat {

/// The largest magnitude among the entries of an array, and whether all of them are finite.
struct ArrayRange {
  double largest;
  bool finite;
};

/// `range` becomes that of both arrays.
inline void widen(ArrayRange& range, const ArrayRange& other) {
  if (other.largest > range.largest) range.largest = other.largest;
  range.finite = range.finite && other.finite;
}

/// Polynomials of n entries through c + 1 nodes on each of some intervals one behind the other, whose last node is the
/// first of the next one.
struct IntervalBasis {
  const double* value;  ///< of the basis: that of node i at point g of an interval is value[i points + g]
  int points;           ///< on each interval
  int c;
  int n;
  int intervals;
};

/// Integrals of products of such polynomials: node i of an interval of length h and the others, times weights[a] for
/// entry a: h sum_k mass[i nodes + k] v_k.
struct MassIntervals {
  const double* mesh;  ///< intervals + 1
  int intervals;
  const double* mass;
  int nodes;  ///< of an interval, 8 at most
  const double* weights;
  int n;
};

/// Combinations of c + 1 nodes of n entries that follow each other: number k begins at node first[k] and has the
/// weights in column k.
struct NodeCombinations {
  const double* weights;
  const int* first;
  int count;
  int c;
  int n;
};

/// Functions of several pairs of arrays take this many at a time at most.
inline constexpr int most_pairs = 3;

struct ArrayFunctions {
  /// sum a_i b_i
  double (*dot)(const double* a, const double* b, long count);
  /// sums[i % GrowingDot::stride] += a_i b_i; `count` is a multiple of that stride
  void (*add_products)(const double* a, const double* b, long count, double* sums);
  /// sum a_i b_i and sum a_i c_i, as dot() finds each
  void (*dot_both)(const double* a, const double* b, const double* c, long count, double* results);
  /// sum a_i (b_i - c_i)
  double (*dot_difference)(const double* a, const double* b, const double* c, long count);
  ArrayRange (*range)(const double* a, long count);
  /// y += factor a
  void (*add)(double factor, const double* a, double* y, long count);
  /// y += factor a, and the ranges of a and of the new y
  void (*add_and_measure)(double factor, const double* a, double* y, long count, ArrayRange* of_a, ArrayRange* of_y);
  /// The ranges of a - (b + factor c) and of a
  void (*measure_difference)(const double* a, const double* b, double factor, const double* c, long count,
                             ArrayRange* of_difference, ArrayRange* of_a);
  /// For each of `pairs` (at least one) the sums of a_i (places[k]_i - c_i) and of a_i directions[k]_i.
  void (*project)(const double* a, const double* c, const double* const* places, const double* const* directions,
                  int pairs, double* distances, double* products, long count);
  /// Of 2 + 2 `pairs` arrays: the ranges of the first two, then of sum k = 1 .. pairs, that of the first 2 + 2 k arrays
  /// with the weights in row k, of 2 + 2 most_pairs entries. And y as combine() makes it of all arrays.
  void (*ranges_of_sums)(const double* const* arrays, const double* weights, int pairs, ArrayRange* ranges,
                         const double* weights_of_y, double* y, long count);
  /// y = sum of weights[k] arrays[k], one after the other; y is none of them.
  void (*combine)(const double* const* arrays, const double* weights, int arrays_count, double* y, long count);
  /// y += M v with the mass matrix M of all intervals
  void (*add_mass)(const MassIntervals& on, const double* v, double* y);
  /// v M v
  double (*mass_product)(const MassIntervals& on, const double* v);
  /// The polynomials through `nodes` at the points of the intervals: n entries each, `stride` from one to the next.
  void (*interpolate)(const IntervalBasis& basis, const double* nodes, double* points, int stride);
  /// The combinations one after the other: values of n entries.
  void (*combine_nodes)(const NodeCombinations& combinations, const double* nodes, double* values);
  /// The transpose of interpolate(): nodes += what weights of the values at the points make of them.
  void (*add_interpolated)(const IntervalBasis& basis, const double* points, int stride, double* nodes);
};

/// Those for what this processor has.
const ArrayFunctions& array_functions();
const ArrayFunctions& array_functions(VectorSet set);

/// dot(), to the last bit, of arrays that become known from the first entry on: their entries are read while they are
/// in the cache.
class GrowingDot {
 public:
  static constexpr int stride = 4 * lanes;

  GrowingDot(const double* a, const double* b) : a_(a), b_(b) {}
  /// The first `count` entries of both are known.
  void grow_to(long count) {
    assert(count >= done_);
    const long more = (count - done_) / stride * stride;
    array_functions().add_products(a_ + done_, b_ + done_, more, sums_.data());
    done_ += more;
  }
  /// The sum over the first `count` entries, after grow_to(count).
  double value(long count) const {
    assert(count >= done_ && count - done_ < stride);
    double rest = 0.0;
    for (long i = done_; i < count; ++i) rest += a_[i] * b_[i];
    std::array<double, lanes> total{};
    for (std::size_t l = 0; l < total.size(); ++l)
      total[l] = (sums_[l] + sums_[2 * lanes + l]) + (sums_[lanes + l] + sums_[3 * lanes + l]);
    return ((total[0] + total[2]) + (total[1] + total[3])) + rest;
  }

 private:
  const double *a_, *b_;
  long done_ = 0;
  std::array<double, stride> sums_{};
};

}  // namespace tchat
