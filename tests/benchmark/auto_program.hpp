/// AUTO-07p of the Debian package, linked with one problem of ours and run as a program of its own in a temporary
/// folder.
#pragma once

#include <filesystem>
#include <vector>

#include "benchmark/auto_problem.hpp"
#include "benchmark/child_process.hpp"

namespace tchat::benchmark {

/// The folder of AUTO's object files, from AUTO_DIR or from the Debian package; empty when it is not installed.
std::filesystem::path auto_objects();

/// The last solution that AUTO stored.
struct AutoSolution {
  double alpha = 0.0;
  std::vector<double> start;  ///< n k states at tau = 0
};

struct AutoRun {
  double processor_seconds = 0.0;
  int iterations = 0;  ///< of Newton, in all steps; 0 unless diagnostics were asked for
  AutoSolution last;
};

class AutoProgram {
 public:
  /// Writes the problem to a new folder and compiles it with gfortran. Throws std::runtime_error when that fails.
  /// `start` is that of the chain, where there are more than 4 states.
  explicit AutoProgram(const Orbit& start);

  /// Throws std::runtime_error when AUTO fails or stops before the last point.
  AutoRun run(const AutoRequest& request) const;

 private:
  ScratchFolder folder_;
  OrbitShape shape_;
};

}  // namespace tchat::benchmark
