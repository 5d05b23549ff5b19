#include "benchmark/start_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "benchmark/branch_walk.hpp"
#include "benchmark/chain_files.hpp"
#include "benchmark/child_process.hpp"

namespace tchat::benchmark {

namespace {

namespace fs = std::filesystem;

/// x1 rises from 0 to 1 and is put back, x2 rests at 0: nothing to compute.
void write_idle_problem(const fs::path& folder) {
  std::ofstream(folder / "idle.cpp") << R"(#include <tchat/problem.hpp>
struct Idle {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = par[0];
    f[1] = -x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0] - 1.0;
    g[1] = x[1];
  }
};
TCHAT_PROBLEM(Idle)
)";
  std::ofstream(folder / "gc.idle") << R"(NDIM = 2, IPS = 180, IRS = 0
ICP = [1, 61], NTST = 5, NCOL = 4
NMX = 1, DS = 0.01
GCFIND = [1], GCHIND = [1], GCGIND = [1], GCSEGTYP = [1]
)";
  std::ofstream(folder / "idle.dat") << "# PAR(1) = 1\n# PAR(61) = 1\n0 0 0\n0.5 0.5 0\n1 1 0\n";
}

struct Kind {
  std::string what;
  std::vector<std::string> command;
  ChildTimes least = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), 0.0};
};

/// Instructions of one run in millions, counted by valgrind; 0 where it is not installed.
double million_instructions(const std::vector<std::string>& command, const fs::path& folder) {
  static const bool installed = std::system("valgrind --version >/dev/null 2>&1") == 0;
  if (!installed) return 0.0;
  std::vector<std::string> counted{"valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"};
  counted.insert(counted.end(), command.begin(), command.end());
  run_child(counted, folder);
  std::ifstream output(folder / "output");
  for (std::string line; std::getline(output, line);)
    if (const auto place = line.find("Collected :"); place != std::string::npos)
      return 1e-6 * std::strtod(line.c_str() + place + 11, nullptr);
  return 0.0;
}

/// Kinds of starts in a folder of this parent: the system's for temporary files, or one that lies in memory.
void measure(const fs::path& parent, const char* where, int rounds, bool count) {
  const ScratchFolder scratch(parent);
  const fs::path& folder = scratch.path();
  write_idle_problem(folder);
  constexpr int labels = 60;
  write_chain_files(folder, BranchWalk(walk_shape(1, 50)).point().orbit, labels);
  const std::string tchat = tchat_executable();
  run_child({tchat, "run", "idle", "-q"}, folder);
  run_child({tchat, "run", "chain", "-q", "-o", "labels", "NPR=1"}, folder);
  std::vector<Kind> kinds{
      {"tchat --version", {tchat, "--version"}},
      {"idle problem, NMX = 1", {tchat, "run", "idle", "-q"}},
      {"oscillator from data, NMX = 1", {tchat, "run", "chain", "-q", "-o", "first", "NMX=1"}},
      {fmt::format("from the last of {} labels, NMX = 1", labels),
       {tchat, "run", "chain", "-q", "-s", "labels", "-o", "first", "NMX=1", fmt::format("IRS={}", labels)}}};
  for (int round = 0; round < rounds; ++round)
    for (Kind& kind : kinds) {
      const ChildTimes times = run_child(kind.command, folder);
      kind.least.wall = std::min(kind.least.wall, times.wall);
      kind.least.processor = std::min(kind.least.processor, times.processor);
    }
  for (const Kind& kind : kinds) {
    const double instructions = count ? million_instructions(kind.command, folder) : 0.0;
    fmt::print("  {:<36}{:>12}{:>12.2f}{:>16.2f}{:>16}\n", kind.what, where, 1e3 * kind.least.wall,
               1e3 * kind.least.processor, instructions > 0.0 ? fmt::format("{:.1f}", instructions) : "-");
  }
}

}  // namespace

void print_start_times(int rounds, bool quick) {
  fmt::print("(h) Start-up: whole runs of the program with its plugin up to date, least of {} alternating runs\n\n",
             rounds);
  fmt::print("  {:<36}{:>12}{:>12}{:>16}{:>16}\n", "", "files in", "wall [ms]", "processor [ms]", "10^6 instr.");
  measure({}, fs::temp_directory_path().c_str(), rounds, !quick);
  constexpr const char* memory = "/dev/shm";
  if (!quick && fs::exists(memory)) measure(memory, memory, rounds, true);
  fmt::print(
      "  (wanted: at most 10 ms for the idle problem; what it takes longer on a disk is waiting for the disk)\n\n");
}

}  // namespace tchat::benchmark
