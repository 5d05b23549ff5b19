#include "benchmark/elimination_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <random>

#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"
#include "linear/lane_kernel.hpp"
#include "linear/partial_lu.hpp"

extern "C" void dgemm_(const char* transposed_a, const char* transposed_b, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc, std::size_t, std::size_t);

namespace tchat::benchmark {

namespace {

constexpr int border = 1;
constexpr int scalars = 2;  // duration and alpha; the residual is one more column
constexpr int intervals = 50;

struct IntervalSizes {
  int rows, pivots, columns;
  explicit IntervalSizes(int n)
      : rows(collocation_points * n),
        pivots((collocation_points - 1) * n),
        columns((collocation_points + 1) * n + scalars + 1) {}
  /// Multiplications and additions of the elimination of one block.
  double operations() const {
    double sum = 0.0;
    for (int k = 0; k < pivots; ++k) sum += 2.0 * (rows + border - k - 1) * (columns - k - 1);
    return sum;
  }
};

/// Interval blocks as a short interval has them: multiples of the identity for each node, and something small.
LaneArray interval_blocks(const IntervalSizes& sizes, int n, int width, int together) {
  assert(sizes.columns <= width);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  LaneArray blocks(static_cast<std::size_t>((sizes.rows + border) * width * together), 0.0);
  for (int i = 0; i < sizes.rows + border; ++i)
    for (int j = 0; j < sizes.columns; ++j)
      for (int l = 0; l < together; ++l) {
        const double slope = i % n == j % n ? 3.0 * std::cos(1.0 + 2.0 * (i / n) + 1.7 * (j / n)) : 0.0;
        blocks[static_cast<std::size_t>((i * width + j) * together + l)] = slope + uniform(generator);
      }
  return blocks;
}

/// Least time of the work on a fresh copy of the blocks.
template <class Work>
double least_time(const LaneArray& blocks, int rounds, Work&& work) {
  LaneArray copy = blocks;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    std::copy(blocks.begin(), blocks.end(), copy.begin());
    least = std::min(least, seconds([&] { work(copy.data()); }));
    keep(copy[0]);
  }
  return least;
}

double multiplication_rate(int size, int rounds) {
  const auto entries = static_cast<std::size_t>(size * size);
  const std::vector<double> a(entries, 1.5), b(entries, -0.5);
  std::vector<double> c(entries, 0.0);
  const double one = 1.0;
  const double zero = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    least = std::min(least, seconds([&] {
                       dgemm_("N", "N", &size, &size, &size, &one, a.data(), &size, b.data(), &size, &zero, c.data(),
                              &size, 1, 1);
                     }));
    keep(c[0]);
  }
  return 2.0 * size * size * size / least;
}

}  // namespace

void print_elimination_times(const std::vector<int>& dimensions, int rounds) {
  fmt::print("(e) Elimination of {} mesh intervals, NCOL = {}, and dense matrix multiplication, least of {} times\n\n",
             intervals, collocation_points, rounds);
  fmt::print("{:>6}{:>16}{:>12}{:>22}{:>12}{:>20}\n", "n", "in lanes [us]", "Gflop/s", "one by one [us]", "Gflop/s",
             "dgemm Gflop/s");
  for (const int n : dimensions) {
    const IntervalSizes sizes(n);
    const int repeated = std::max(1, rounds * 64 / (n * n));
    std::vector<int> swaps(static_cast<std::size_t>(sizes.pivots * lanes));
    const LaneKernel kernel(sizes.rows, sizes.pivots, sizes.columns);
    const double in_lanes = least_time(interval_blocks(sizes, n, kernel.stride(), lanes), repeated,
                                       [&](double* a) { keep(kernel.eliminate(a, border, swaps.data())); }) *
                            intervals / lanes;
    const BlockKernel single = interval_kernel(n, collocation_points, scalars + 1);
    const double one_by_one = least_time(interval_blocks(sizes, n, single.width(), 1), repeated,
                                         [&](double* a) { keep(single.eliminate(a, border, swaps.data())); }) *
                              intervals;
    const double work = 1e-9 * intervals * sizes.operations();
    fmt::print("{:>6}{:>16.1f}{:>12.1f}{:>22.1f}{:>12.1f}{:>20.1f}\n", n, 1e6 * in_lanes, work / in_lanes,
               1e6 * one_by_one, work / one_by_one, 1e-9 * multiplication_rate(sizes.rows, std::max(1, repeated / 8)));
  }
  fmt::print("\n");
}

}  // namespace tchat::benchmark
