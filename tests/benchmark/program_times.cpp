#include "benchmark/program_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
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
    return run_child(command, folder_.path()).processor;
  }
  /// Seconds that a step takes: a short run beside one, the last, of so many more steps.
  double further_step(int further) const {
    const double of_start = run(first_points);
    return (run(first_points + further) - of_start) / further;
  }
  double alpha() const {
    return read_point_file((folder_.path() / "p.chain").string()).sections.back().rows.back().values.front();
  }

 private:
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
    ours_times.push_back(ours.further_step(size.further));
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

/// Runs of any number of segments take about as long.
int further_steps(int segments) { return std::clamp(20000 / segments, 40, 500); }

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
      "(l) Whole programs: processor time of a further step by the number of segments, least of {} alternating\n"
      "    runs; n = 4, NTST = {}\n\n",
      rounds, intervals);
  std::vector<std::unique_ptr<TchatProgram>> programs;
  for (const int k : segments)
    programs.push_back(std::make_unique<TchatProgram>(BranchWalk(walk_shape(k, intervals)).point().orbit));
  std::vector<std::vector<double>> times(segments.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < segments.size(); ++i)
      times[i].push_back(programs[i]->further_step(further_steps(segments[i])));
  std::vector<double> leasts;
  fmt::print("{:>8}{:>8}{:>14}{:>20}\n", "k", "steps", "step [us]", "per segment [us]");
  for (std::size_t i = 0; i < segments.size(); ++i) {
    leasts.push_back(least(times[i]));
    fmt::print("{:>8}{:>8}{:>14.1f}{:>20.2f}\n", segments[i], further_steps(segments[i]), 1e6 * leasts[i],
               1e6 * leasts[i] / segments[i]);
  }
  fmt::print("  time grows like k^{:.3f}   (wanted: at most 1.05)\n\n", fitted_exponent(segments, leasts));
}

}  // namespace tchat::benchmark
