#include "benchmark/auto_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "benchmark/auto_program.hpp"
#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int short_run = 5;

/// Measured steps of AUTO: as many as the growth of its work with k and NTST allows.
int measured_steps(const AutoSize& size, bool quick) {
  return quick ? 10 : std::max(400 * 50 / (size.segments * size.segments * size.intervals), 16);
}

struct Comparison {
  double auto_step = 0.0;        // seconds
  double step = 0.0;             // seconds
  double multipliers = 0.0;      // seconds
  double ratio = 0.0;            // AUTO / ours, without multipliers
  double auto_iterations = 0.0;  // Newton iterations per step
  double iterations = 0.0;
  double difference = 0.0;  // of the states at AUTO's last alpha
};

/// How far the states at the starts of segments are from AUTO's at the alpha of AUTO's last point. Our branch is
/// followed as many steps, then corrected to that alpha: AUTO predicts along secants, so its points lie elsewhere.
double difference_from(const AutoSolution& theirs, const OrbitShape& shape, int points) {
  BranchWalk walk(shape, points);
  for (int i = 1; i < points; ++i) walk.step();
  PathPoint point = walk.point();
  const double to_alpha = (theirs.alpha - point.orbit.par(0)) / point.tangent.globals(0);
  advance(point.orbit, to_alpha, point.tangent, walk.system().free_parameters());
  point.orbit.par(0) = theirs.alpha;
  if (!walk.follower().start_at_fixed_parameter(point).converged())
    throw std::runtime_error("no orbit was found at the alpha of AUTO's last solution");
  double largest = 0.0;
  for (int s = 0; s < shape.segments; ++s)
    for (int a = 0; a < shape.dimension; ++a) {
      const double value = theirs.start[static_cast<std::size_t>(s * shape.dimension + a)];
      largest = std::max(largest, std::abs(point.orbit.start(s)[a] - value));
    }
  return largest;
}

Comparison compare(const AutoSize& size, bool quick) {
  const AutoProgram program(size.segments, size.intervals);
  const OrbitShape shape = walk_shape(size.segments, size.intervals);
  BranchWalk walk(shape);
  const int steps = measured_steps(size, quick);
  const AutoRun checked = program.run(short_run + steps, true);

  Comparison result;
  result.difference = difference_from(checked.last, shape, short_run + steps);
  result.auto_iterations = static_cast<double>(checked.iterations) / (short_run + steps - 1);
  std::vector<double> theirs;
  std::vector<double> ours;
  std::vector<double> multipliers;
  std::vector<double> ratios;
  for (int round = 0; round < (quick ? 2 : 7); ++round) {
    const double brief = program.run(short_run, false).processor_seconds;
    const double full = program.run(short_run + steps, false).processor_seconds;
    theirs.push_back((full - brief) / steps);
    constexpr int block = 40;
    std::vector<double> times;
    for (int i = 0; i < block; ++i) {
      times.push_back(processor_seconds([&] { walk.step(); }));
      multipliers.push_back(processor_seconds([&] { keep(walk.multipliers()); }));
    }
    ours.push_back(median(times));
    ratios.push_back(theirs.back() / ours.back());
  }
  result.auto_step = median(theirs);
  result.step = median(ours);
  result.multipliers = median(multipliers);
  result.ratio = median(ratios);
  result.iterations = walk.iterations_per_step();
  return result;
}

}  // namespace

bool auto_is_installed() {
  if (auto_objects().empty()) {
    fmt::print("AUTO-07p is not there: install the Debian package auto-07p, or set AUTO_DIR to its folder.\n");
    return false;
  }
  if (std::system("gfortran --version >/dev/null 2>&1") != 0) {
    fmt::print("gfortran is not there: install the Debian package gfortran.\n");
    return false;
  }
  return true;
}

void print_auto_comparison(const std::vector<AutoSize>& sizes, bool quick) {
  fmt::print("(f) AUTO-07p (IPS = 4, 4k functions, JAC = 1) on the same k-segment problem, NCOL = {}\n\n",
             collocation_points);
  fmt::print("{:>4}{:>6}{:>14}{:>14}{:>18}{:>10}{:>20}{:>24}{:>20}\n", "k", "NTST", "AUTO [us]", "tchat [us]",
             "multipliers [us]", "ratio", "ratio with mult.", "Newton it. AUTO/tchat", "difference");
  for (const AutoSize& size : sizes) {
    const Comparison c = compare(size, quick);
    fmt::print("{:>4}{:>6}{:>14.0f}{:>14.0f}{:>18.0f}{:>10.1f}{:>20.1f}{:>17.2f} /{:>5.2f}{:>20.1e}\n", size.segments,
               size.intervals, 1e6 * c.auto_step, 1e6 * c.step, 1e6 * c.multipliers, c.ratio,
               c.ratio * c.step / (c.step + c.multipliers), c.auto_iterations, c.iterations, c.difference);
  }
  fmt::print("\n");
}

}  // namespace tchat::benchmark
