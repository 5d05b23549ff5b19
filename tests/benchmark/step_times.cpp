#include "benchmark/step_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int steps_one_way = 10;

/// One size under measurement: a round goes the same steps there and back. Each counts with the least that it took in
/// any round: the steps of large sizes are long enough to meet most slow moments of the machine, whole rounds nearly
/// all.
class Candidate {
 public:
  explicit Candidate(const OrbitShape& shape) : walk_(std::make_unique<BranchWalk>(shape, steps_one_way)) {}
  void measure() {
    for (StepCost& least : least_) {
      least.step = std::min(least.step, processor_seconds([&] { walk_->step(); }));
      least.multipliers = std::min(least.multipliers, processor_seconds([&] { keep(walk_->multipliers()); }));
    }
  }
  const BranchWalk& walk() const { return *walk_; }
  /// The mean over all steps.
  StepCost cost() const {
    StepCost mean;
    for (const StepCost& least : least_) {
      mean.step += least.step / static_cast<double>(least_.size());
      mean.multipliers += least.multipliers / static_cast<double>(least_.size());
    }
    return mean;
  }

 private:
  std::unique_ptr<BranchWalk> walk_;
  std::vector<StepCost> least_{2 * steps_one_way, StepCost{INFINITY, INFINITY}};
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
    const StepCost cost = candidates[i].cost();
    both.push_back(cost.step + cost.multipliers);
    fmt::print("{:>8}{:>14.1f}{:>18.1f}{:>12.1f}{:>22.2f}{:>18.2f}\n", sizes[i], 1e6 * cost.step,
               1e6 * cost.multipliers, 1e6 * both.back(), candidates[i].walk().iterations_per_step(),
               candidates[i].walk().matrices_per_step());
  }
  fmt::print("  time of step and multipliers grows like {}^{:.3f}{}\n\n", what, fitted_exponent(sizes, both), wanted);
}

}  // namespace

void print_step_times(const StepSizes& sizes) {
  fmt::print("(a) Time per continuation step with multipliers: mean of {} steps, the least of {} rounds for each\n\n",
             2 * steps_one_way, sizes.rounds);
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
