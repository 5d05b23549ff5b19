#include "benchmark/step_times.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int steps_one_way = 10;

/// One size under measurement.
struct Candidate {
  explicit Candidate(const OrbitShape& shape) : walk(std::make_unique<BranchWalk>(shape, steps_one_way)) {}
  void measure() {
    const StepCost cost = cost_there_and_back(*walk);
    steps.push_back(cost.step);
    multipliers.push_back(cost.multipliers);
    both.push_back(cost.step + cost.multipliers);
  }
  std::unique_ptr<BranchWalk> walk;
  std::vector<double> steps, multipliers, both;
};

/// Measures all sizes in turn, round by round, so that a slow moment of the machine meets all of them.
void print_table(const char* what, const std::vector<int>& sizes, const std::vector<OrbitShape>& shapes, int rounds,
                 const std::string& wanted) {
  std::vector<Candidate> candidates;
  for (const OrbitShape& shape : shapes) candidates.emplace_back(shape);
  for (int round = 0; round < rounds; ++round)
    for (Candidate& candidate : candidates) candidate.measure();

  fmt::print("{:>8}{:>14}{:>18}{:>12}{:>22}{:>18}\n", what, "step [us]", "multipliers [us]", "both [us]",
             "Newton iterations", "Newton matrices");
  std::vector<double> both;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Candidate& c = candidates[i];
    both.push_back(least(c.both));
    fmt::print("{:>8}{:>14.1f}{:>18.1f}{:>12.1f}{:>22.2f}{:>18.2f}\n", sizes[i], 1e6 * least(c.steps),
               1e6 * least(c.multipliers), 1e6 * both.back(), c.walk->iterations_per_step(),
               c.walk->matrices_per_step());
  }
  fmt::print("  time of step and multipliers grows like {}^{:.3f}{}\n\n", what, fitted_exponent(sizes, both), wanted);
}

}  // namespace

void print_step_times(const StepSizes& sizes) {
  fmt::print("(a) Time per continuation step with multipliers, least of {} alternating rounds of {} steps\n\n",
             sizes.rounds, 2 * steps_one_way);
  constexpr const char* wanted = "   (wanted: at most 1.05)";
  std::vector<OrbitShape> shapes;
  for (const int m : sizes.segments) shapes.push_back(walk_shape(m, sizes.intervals_for_segments));
  print_table("k", sizes.segments, shapes, sizes.rounds, wanted);
  shapes.clear();
  for (const int m : sizes.many_segments) shapes.push_back(walk_shape(m, sizes.intervals_for_many));
  print_table("k", sizes.many_segments, shapes, sizes.rounds, wanted);
  shapes.clear();
  for (const int intervals : sizes.intervals) shapes.push_back(walk_shape(1, intervals));
  print_table("NTST", sizes.intervals, shapes, sizes.rounds, wanted);
  shapes.clear();
  for (const int n : sizes.dimensions) shapes.push_back(walk_shape(1, sizes.intervals_for_segments, n));
  print_table("n", sizes.dimensions, shapes, sizes.rounds, "   (a chain of oscillators; eliminations: n^3)");
}

}  // namespace tchat::benchmark
