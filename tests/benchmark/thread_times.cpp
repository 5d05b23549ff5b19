#include "benchmark/thread_times.hpp"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "benchmark/branch_walk.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr double round_seconds = 0.1;  // of one matrix after the other: as in a run, threads stay awake between them

/// The same matrix by a number of threads.
class Team {
 public:
  Team(BranchWalk& walk, int threads)
      : x_(walk.point().orbit),
        row_(walk.point().dual),
        problem_(walk.system(), x_.shape, nullptr, {}, threads),
        residual_(problem_.make_residual()),
        correction_(problem_.condensed().make_vector()) {}

  void measure() {
    for (double spent = 0.0; spent < round_seconds; spent += times_.back())
      times_.push_back(seconds([&] { matrix(); }));
  }
  double time() const { return median(times_); }
  bool agrees_with(const Team& other) const {
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() &&
             std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
    };
    return same(correction_.states, other.correction_.states) &&
           same(correction_.durations, other.correction_.durations) &&
           same(correction_.globals, other.correction_.globals);
  }

 private:
  void matrix() {
    keep(problem_.linearize(x_, row_, residual_));
    keep(problem_.correct(residual_, row_, 0.0, correction_));
  }

  const Orbit& x_;
  const OrbitVector& row_;
  BorderedProblem problem_;
  OrbitResidual residual_;
  OrbitVector correction_;
  std::vector<double> times_;
};

void print_line(const OrbitShape& shape, int rounds) {
  BranchWalk walk(shape);
  walk.step();
  Team alone(walk, 1);
  Team pair(walk, 2);
  for (int round = 0; round < rounds; ++round) {
    alone.measure();
    pair.measure();
  }
  if (!pair.agrees_with(alone)) throw std::runtime_error("two threads compute other numbers than one");
  fmt::print("{:>4}{:>6}{:>6}{:>16.1f}{:>16.1f}{:>9.2f}\n", shape.dimension, shape.segments, shape.intervals,
             1e6 * alone.time(), 1e6 * pair.time(), alone.time() / pair.time());
}

}  // namespace

void print_thread_times(const std::vector<OrbitShape>& shapes, int rounds) {
  fmt::print(
      "(i) One Newton matrix and its correction by one thread and by two, NCOL = 4, median of {} alternating "
      "rounds\n\n",
      rounds);
  fmt::print("{:>4}{:>6}{:>6}{:>16}{:>16}{:>9}\n", "n", "k", "NTST", "one [us]", "two [us]", "ratio");
  for (const OrbitShape& shape : shapes) print_line(shape, rounds);
  fmt::print(
      "  (wanted: 1.6 for n = 50 or 64 segments, 1 for small ones; the corrections are the same bit by bit)\n\n");
}

}  // namespace tchat::benchmark
