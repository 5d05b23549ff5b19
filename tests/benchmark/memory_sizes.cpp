#include "benchmark/memory_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <memory>
#include <string>

#include "benchmark/branch_walk.hpp"
#include "benchmark/chain_files.hpp"
#include "benchmark/child_process.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int points = 6;
constexpr int usual_intervals = 50;

double peak_of(const ScratchFolder& folder, const Orbit& x, int count) {
  write_chain_files(folder.path(), x, count);
  return run_child({tchat_executable(), "run", "chain", "-q", "-o", "branch"}, folder.path(), true).peak_mebibytes;
}

/// Peaks of runs in one folder, so that a plugin is compiled once: by a run before, for the compiler is no part of it.
class Peaks {
 public:
  double of(int n, int segments, int intervals) {
    const Orbit x = BranchWalk(walk_shape(segments, intervals, n)).point().orbit;
    std::unique_ptr<ScratchFolder>& folder = folders_[n];
    if (folder == nullptr) {
      folder = std::make_unique<ScratchFolder>();
      peak_of(*folder, BranchWalk(walk_shape(1, 10, n)).point().orbit, 1);
    }
    return peak_of(*folder, x, points);
  }

 private:
  std::map<int, std::unique_ptr<ScratchFolder>> folders_;
};

struct Size {
  int n, segments, intervals;
};

/// Without what a run of the smallest problem takes, the program and its libraries.
void print_series(Peaks& peaks, const char* what, const std::vector<int>& values, double base,
                  const std::vector<Size>& sizes) {
  fmt::print("{:>8}{:>16}{:>26}\n", what, "peak [MiB]", "beyond the least [MiB]");
  std::vector<double> beyond;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double peak = peaks.of(sizes[i].n, sizes[i].segments, sizes[i].intervals);
    beyond.push_back(peak - base);
    fmt::print("{:>8}{:>16.1f}{:>26.1f}\n", values[i], peak, beyond.back());
    std::fflush(stdout);
  }
  // The last three: where the sizes are small the pages of the program itself still count.
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(std::ssize(values) - 3, 0);
  const std::vector<double> last(beyond.begin() + first, beyond.end());
  if (last.size() > 1 && *std::min_element(last.begin(), last.end()) > 0.0)
    fmt::print("  grows like {}^{:.2f}\n", what, fitted_exponent({values.begin() + first, values.end()}, last));
  fmt::print("\n");
}

}  // namespace

void print_memory_sizes(const MemorySizes& sizes) {
  Peaks peaks;
  const double base = peaks.of(4, 1, 5);
  fmt::print(
      "(g) Peak resident size of `tchat run` over {} points with multipliers, NCOL = {}; the least: n = 4, k = 1, "
      "NTST = 5, {:.1f} MiB\n\n",
      points, collocation_points, base);
  std::vector<Size> series;
  for (const int k : sizes.segments) series.push_back({4, k, usual_intervals});
  print_series(peaks, "k", sizes.segments, base, series);
  series.clear();
  for (const int intervals : sizes.intervals) series.push_back({4, 1, intervals});
  print_series(peaks, "NTST", sizes.intervals, base, series);
  series.clear();
  for (const int n : sizes.dimensions) series.push_back({n, 1, usual_intervals});
  print_series(peaks, "n", sizes.dimensions, base, series);
  fmt::print("  n = {}, NTST = {}: {:.0f} MiB   (wanted: at most 1024)\n\n", sizes.dimensions.back(),
             sizes.most_intervals, peaks.of(sizes.dimensions.back(), 1, sizes.most_intervals));
}

}  // namespace tchat::benchmark
