#include "benchmark/matrix_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>

#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"
#include "linear/lane_kernel.hpp"
#include "linear/partial_lu.hpp"

namespace tchat::benchmark {

namespace {

constexpr int n = 4;
constexpr int intervals = 50;
constexpr int scalars = 2;  // duration and alpha
constexpr int border = 1;

std::vector<double> random_numbers(std::size_t count) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> values(count);
  for (double& v : values) v = uniform(generator);
  return values;
}

/// Random blocks that an elimination kernel is let loose on, one after the other: `together` of them at a time.
class RandomBlocks {
 public:
  RandomBlocks(int blocks, int rows, int pivots, int width, int together)
      : blocks_((blocks + together - 1) / together),
        size_((rows + border) * width * together),
        work_(static_cast<std::size_t>(blocks_ * size_)),
        swaps_(static_cast<std::size_t>(pivots * together)) {
    const std::vector<double> numbers = random_numbers(work_.size());
    pristine_.assign(numbers.begin(), numbers.end());
  }

  void copy() {
    run([](double*, int*) {});
  }
  template <class Eliminate>
  void run(Eliminate&& eliminate) {
    for (int b = 0; b < blocks_; ++b) {
      double* block = work_.data() + b * size_;
      std::copy_n(pristine_.data() + b * size_, size_, block);
      eliminate(block, swaps_.data());
      keep(*block);
    }
  }

 private:
  int blocks_;
  int size_;
  LaneArray pristine_;
  LaneArray work_;
  std::vector<int> swaps_;
};

/// A matrix of the size that is left at m = 1: rows (segment | event | connection | border), columns
/// (start | end | duration | alpha).
class Remainder {
 public:
  Remainder() : entries_(random_numbers(size * size)), b_(random_numbers(size)), lu_(size), x_(size) { factorize(); }
  void factorize() {
    std::copy(entries_.begin(), entries_.end(), lu_.entries());
    keep(lu_.factorize());
  }
  void solve() {
    lu_.solve(b_.data(), x_.data());
    keep(x_);
  }

 private:
  static constexpr int size = 2 * n + scalars;
  std::vector<double> entries_;
  std::vector<double> b_;
  SmallLu lu_;
  std::vector<double> x_;
};

/// A part of the work: how to do it once, and its measured times.
struct Part {
  std::function<void()> work;
  std::vector<double> times = {};
};

void print_line(const std::string& what, double units, double unit_seconds) {
  fmt::print("  {:<66}{:>8.2f}{:>12.1f}\n", what, units, 1e6 * units * unit_seconds);
}

}  // namespace

void print_matrix_times(int rounds) {
  BranchWalk walk(walk_shape(1, intervals));
  walk.step();
  BorderedProblem problem(walk.system(), walk.point().orbit.shape, nullptr);
  CondensedSystem& condensed = problem.condensed();
  const Orbit& x = walk.point().orbit;
  const HybridSystem& system = walk.system().system();
  const OrbitVector row = walk.point().dual;
  OrbitResidual residual = problem.make_residual();
  OrbitVector dx = condensed.make_vector();
  FloquetSolver floquet(x.shape);
  constexpr int sets = collocation_points;  // of points side by side, that are evaluated in one call
  const LaneArray states(x.node(0, 0), x.node(0, 0) + sets * lanes * n);
  LaneArray f(states.size());
  LaneArray fx(f.size() * n);
  LaneArray fp(f.size());

  const LaneKernel interval(16, 12, 22);
  RandomBlocks interval_blocks(intervals, interval.rows(), interval.pivots(), interval.width(), lanes);
  RandomBlocks single_blocks(intervals, 16, 12, 24, 1);
  const LaneKernel join(2 * n, n, 3 * n + scalars);
  RandomBlocks join_blocks(intervals - 1, join.rows(), join.pivots(), join.width(), lanes);
  Remainder remainder;

  const auto eliminate_interval = [&](double* a, int* swaps) { keep(interval.eliminate(a, border, swaps)); };
  const auto eliminate_without_border = [&](double* a, int* swaps) { keep(interval.eliminate(a, 0, swaps)); };
  const auto eliminate_single = [](double* a, int* swaps) {
    keep(eliminate(FixedSizes<16, 12, 24>{}, a, border, swaps));
  };
  const auto eliminate_join = [&](double* a, int* swaps) { keep(join.eliminate(a, border, swaps)); };
  const auto derivatives = [&] {
    for (int j = 0; j < intervals; j += lanes)
      system.first_in_lanes(FunctionKind::field, 1, sets, states.data(), x.par.data(), walk.system().free_parameters(),
                            f.data(), fx.data(), fp.data());
  };

  enum {
    unit,
    unit_copy,
    unit_alone,
    single,
    single_copy,
    linearization,
    solution,
    derivative,
    join_work,
    join_copy,
    factors,
    dense_solve,
    residuals,
    multipliers,
    part_count
  };
  std::vector<Part> parts(part_count);
  parts[unit].work = [&] { interval_blocks.run(eliminate_interval); };
  parts[unit_copy].work = [&] { interval_blocks.copy(); };
  parts[unit_alone].work = [&] { interval_blocks.run(eliminate_without_border); };
  parts[single].work = [&] { single_blocks.run(eliminate_single); };
  parts[single_copy].work = [&] { single_blocks.copy(); };
  parts[linearization].work = [&] { keep(problem.linearize(x, row, residual)); };
  parts[solution].work = [&] { keep(problem.correct(residual, row, 0.0, dx)); };
  parts[derivative].work = derivatives;
  parts[join_work].work = [&] { join_blocks.run(eliminate_join); };
  parts[join_copy].work = [&] { join_blocks.copy(); };
  parts[factors].work = [&] { remainder.factorize(); };
  parts[dense_solve].work = [&] { remainder.solve(); };
  parts[residuals].work = [&] { condensed.evaluate(x, residual); };
  parts[multipliers].work = [&] { keep(floquet.compute(condensed, x)); };
  for (int round = 0; round < rounds; ++round)
    for (Part& part : parts) {
      part.work();  // in a run nothing comes between two matrices that takes the cache from them
      part.times.push_back(seconds(part.work));
    }

  std::vector<double> units(parts[unit].times);
  for (std::size_t i = 0; i < units.size(); ++i) units[i] -= parts[unit_copy].times[i];
  const auto in_units = [&](const std::vector<int>& plus, int minus = -1) {
    std::vector<double> ratios(units.size(), 0.0);
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      for (const int p : plus) ratios[i] += parts[static_cast<std::size_t>(p)].times[i];
      if (minus >= 0) ratios[i] -= parts[static_cast<std::size_t>(minus)].times[i];
      ratios[i] /= units[i];
    }
    return median(ratios);
  };
  const double second = median(units);
  const double linearize_units = in_units({linearization});
  const double solve_units = in_units({solution});
  const double derivative_units = in_units({derivative});
  const double join_units = in_units({join_work}, join_copy);
  const double factor_units = in_units({factors});
  const double dense_units = in_units({dense_solve});

  fmt::print("(b) One Newton matrix: m = 1, n = 4, NTST = {}, NCOL = 4\n\n", intervals);
  fmt::print("  {:<66}{:>8}{:>12}\n", "", "units", "time [us]");
  print_line("unit: local eliminations of random blocks in lanes, without copying", 1.0, second);
  print_line("  the same without a border row", in_units({unit_alone}, unit_copy), second);
  print_line("  the same one block after the other", in_units({single}, single_copy), second);
  print_line("one Newton matrix, evaluation to correction (wanted: 1.5)", in_units({linearization, solution}), second);
  print_line("  linearize", linearize_units, second);
  print_line("    derivatives of the field at the collocation points", derivative_units, second);
  print_line("    local eliminations (1 by definition)", 1.0, second);
  print_line("    joins of intervals: their eliminations, in lanes", join_units, second);
  print_line("    what couples the ends of segments (up to 30 rows): dense factors", factor_units, second);
  print_line("    the rest: interpolation, filling, gathering",
             linearize_units - derivative_units - 1.0 - join_units - factor_units, second);
  print_line("  solve, for the correction and the tangent", solve_units, second);
  print_line("    the same: forward and back-substitution, once", dense_units, second);
  print_line("    the rest: back-substitution to all nodes", solve_units - dense_units, second);
  print_line("multipliers (at most 1)", in_units({multipliers}), second);
  print_line("for comparison: residual without derivatives (a chord iteration)", in_units({residuals}), second);
  fmt::print("\n");
}

}  // namespace tchat::benchmark
