#include "benchmark/auto_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "benchmark/auto_program.hpp"
#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int short_run = 5;

/// AUTO's work on a step, in units of that for n = 4, k = 1, NTST = 50: its matrices are dense in all functions.
double work_of_auto(const AutoSize& size) {
  const double functions = size.dimension / 4.0 * size.segments;
  return std::max(functions, functions * functions * functions / 8.0) * size.intervals / 50.0;
}

/// How long AUTO is measured: steps, and rounds of them.
struct Effort {
  int steps = 10;
  int rounds = 2;
};

Effort effort(const AutoSize& size, bool quick) {
  if (quick) return {};
  const double work = work_of_auto(size);
  if (work > 1000.0) return {2, 1};
  return {std::max(static_cast<int>(400.0 / work), 16), work > 100.0 ? 2 : 5};
}

struct Comparison {
  double auto_step = 0.0;        // seconds
  double step = 0.0;             // seconds
  double both = 0.0;             // seconds, with multipliers
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
  const OrbitShape shape = walk_shape(size.segments, size.intervals, size.dimension);
  BranchWalk walk(shape);
  const AutoProgram program(walk.point().orbit);
  const auto [steps, rounds] = effort(size, quick);
  AutoRequest request{short_run + steps, step_length(size.segments), 0, 2};
  const AutoRun checked = program.run(request);
  request.diagnostics = 0;

  Comparison result;
  result.difference = difference_from(checked.last, shape, short_run + steps);
  result.auto_iterations = static_cast<double>(checked.iterations) / (short_run + steps - 1);
  std::vector<double> theirs;
  std::vector<double> ours;
  std::vector<double> both;
  for (int round = 0; round < rounds; ++round) {
    request.points = short_run;
    const double brief = program.run(request).processor_seconds;
    request.points = short_run + steps;
    const double full = program.run(request).processor_seconds;
    theirs.push_back((full - brief) / steps);
    for (int again = 0; again < 3; ++again) {
      const StepCost cost = cost_there_and_back(walk);
      ours.push_back(cost.step);
      both.push_back(cost.step + cost.multipliers);
    }
  }
  result.auto_step = least(theirs);
  result.step = least(ours);
  result.both = least(both);
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
  fmt::print(
      "(f) AUTO-07p (IPS = 4, n k functions, JAC = 1, one thread) on the same problem, NCOL = {}; time per step,\n"
      "    least of alternating runs\n\n",
      collocation_points);
  fmt::print("{:>4}{:>6}{:>6}{:>14}{:>14}{:>14}{:>10}{:>12}{:>10}{:>24}{:>14}\n", "n", "k", "NTST", "AUTO [us]",
             "tchat [us]", "with mult.", "ratio", "with mult.", "wanted", "Newton it. AUTO/tchat", "difference");
  for (const AutoSize& size : sizes) {
    const Comparison c = compare(size, quick);
    const std::string wanted = size.wanted > 0 ? fmt::format("{}", size.wanted) : "";
    fmt::print("{:>4}{:>6}{:>6}{:>14.0f}{:>14.0f}{:>14.0f}{:>10.1f}{:>12.1f}{:>10}{:>17.2f} /{:>5.2f}{:>14.1e}\n",
               size.dimension, size.segments, size.intervals, 1e6 * c.auto_step, 1e6 * c.step, 1e6 * c.both,
               c.auto_step / c.step, c.auto_step / c.both, wanted, c.auto_iterations, c.iterations, c.difference);
    std::fflush(stdout);
  }
  fmt::print("\n");
}

}  // namespace tchat::benchmark
