#include "benchmark/program_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "benchmark/auto_program.hpp"
#include "benchmark/branch_walk.hpp"
#include "benchmark/chain_files.hpp"
#include "benchmark/child_process.hpp"
#include "benchmark/timing.hpp"
#include "files/point_file_reader.hpp"

namespace tchat::benchmark {

namespace {

constexpr int first_points = 20;

class TchatProgram {
 public:
  explicit TchatProgram(const Orbit& start) {
    write_chain_files(folder_.path(), start, first_points);
    step_ = step_length(start.shape.segments);
    run(1);  // compiles the plugin
  }
  double run(int points) const {
    std::vector<std::string> command{tchat_executable(), "run", "chain", "-q", "NPR=0", "IADS=0"};
    for (const auto& [name, value] : {std::pair{"DS", step_},
                                      {"DSMAX", 2.0 * step_},
                                      {"DSMIN", 0.5 * step_},
                                      {"EPSL", newton_settings.tolerance_parameters},
                                      {"EPSU", newton_settings.tolerance_states}})
      command.push_back(fmt::format("{}={}", name, value));
    command.push_back(fmt::format("NMX={}", points));
    const double time = run_child(command, folder_.path()).processor;
    if (std::abs(last().point) != points) throw std::runtime_error("a run of the benchmark ended early");
    return time;
  }
  double alpha() const { return last().values.front(); }

 private:
  /// Of the run before.
  PointRow last() const { return read_point_file((folder_.path() / "p.chain").string()).sections.back().rows.back(); }

  ScratchFolder folder_;
  double step_;
};

struct Times {
  double tchat = 0.0;  // seconds, of a further step
  double autos = 0.0;
  double ratio = 0.0;
  double alpha = NAN;
  double alpha_of_auto = NAN;
};

Times measure(const ProgramSize& size, int rounds, bool with_auto) {
  const Orbit start = BranchWalk(walk_shape(size.segments, size.intervals, size.dimension)).point().orbit;
  const TchatProgram ours(start);
  std::unique_ptr<AutoProgram> theirs;
  if (with_auto) theirs = std::make_unique<AutoProgram>(start);
  AutoRequest request{first_points, step_length(size.segments), 3, 2};
  std::vector<double> ours_times;
  std::vector<double> their_times;
  std::vector<double> ratios;
  Times result;
  for (int round = 0; round < rounds; ++round) {
    const double of_start = ours.run(first_points);
    ours_times.push_back((ours.run(first_points + size.further) - of_start) / size.further);
    result.alpha = ours.alpha();
    if (!theirs) continue;
    request.points = first_points;
    const double of_their_start = theirs->run(request).processor_seconds;
    request.points = first_points + size.further;
    const AutoRun run = theirs->run(request);
    their_times.push_back((run.processor_seconds - of_their_start) / size.further);
    result.alpha_of_auto = run.last.alpha;
    ratios.push_back(their_times.back() / ours_times.back());
  }
  result.tchat = median(ours_times);
  result.autos = median(their_times);
  result.ratio = median(ratios);
  return result;
}

/// Of one number of segments: a short run and one of `further` more steps, the least of each.
class FurtherSteps {
 public:
  FurtherSteps(int segments, int intervals)
      : further_(std::clamp(20000 / segments, 40, 500)),
        program_(BranchWalk(walk_shape(segments, intervals)).point().orbit) {}
  void measure() {
    short_run_ = std::min(short_run_, program_.run(first_points));
    long_run_ = std::min(long_run_, program_.run(first_points + further_));
  }
  int further() const { return further_; }
  double step() const { return (long_run_ - short_run_) / further_; }

 private:
  int further_;
  TchatProgram program_;
  double short_run_ = INFINITY, long_run_ = INFINITY;
};

}  // namespace

void print_program_times(const std::vector<ProgramSize>& sizes, int rounds, bool with_auto) {
  fmt::print("(j) Whole programs: processor time of a further step, median of {} alternating runs\n\n", rounds);
  fmt::print("{:>4}{:>6}{:>6}{:>8}{:>14}{:>14}{:>10}{:>10}{:>18}{:>18}\n", "n", "k", "NTST", "steps", "tchat [us]",
             "AUTO [us]", "ratio", "wanted", "last alpha", "AUTO's");
  for (const ProgramSize& size : sizes) {
    const Times t = measure(size, rounds, with_auto);
    const std::string wanted = size.wanted > 0 ? fmt::format("{}", size.wanted) : "";
    fmt::print("{:>4}{:>6}{:>6}{:>8}{:>14.1f}", size.dimension, size.segments, size.intervals, size.further,
               1e6 * t.tchat);
    if (with_auto)
      fmt::print("{:>14.1f}{:>10.2f}{:>10}{:>18.9f}{:>18.9f}", 1e6 * t.autos, t.ratio, wanted, t.alpha,
                 t.alpha_of_auto);
    fmt::print("\n");
    std::fflush(stdout);
  }
  fmt::print("\n");
}

void print_segment_times(const std::vector<int>& segments, int intervals, int rounds) {
  fmt::print(
      "(l) Whole programs: processor time of a further step by the number of segments, from the least of {} "
      "alternating\n"
      "    short and long runs; n = 4, NTST = {}\n\n",
      rounds, intervals);
  std::vector<std::unique_ptr<FurtherSteps>> sizes;
  for (const int k : segments) sizes.push_back(std::make_unique<FurtherSteps>(k, intervals));
  for (int round = 0; round < rounds; ++round)
    for (const auto& size : sizes) size->measure();
  std::vector<double> steps;
  fmt::print("{:>8}{:>8}{:>14}{:>20}\n", "k", "steps", "step [us]", "per segment [us]");
  for (std::size_t i = 0; i < segments.size(); ++i) {
    steps.push_back(sizes[i]->step());
    fmt::print("{:>8}{:>8}{:>14.1f}{:>20.2f}\n", segments[i], sizes[i]->further(), 1e6 * steps.back(),
               1e6 * steps.back() / segments[i]);
  }
  fmt::print("  time grows like k^{:.3f}   (wanted: at most 1.05)\n\n", fitted_exponent(segments, steps));
}

}  // namespace tchat::benchmark
