// tchat_benchmark: how fast a continuation step is, how it scales, and how it compares with AUTO-07p.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "benchmark/auto_comparison.hpp"
#include "benchmark/branch_walk.hpp"
#include "benchmark/compiled_problem.hpp"
#include "benchmark/elimination_times.hpp"
#include "benchmark/matrix_times.hpp"
#include "benchmark/memory_sizes.hpp"
#include "benchmark/program_times.hpp"
#include "benchmark/start_times.hpp"
#include "benchmark/step_times.hpp"
#include "benchmark/sweep_times.hpp"
#include "benchmark/thread_times.hpp"
#include "benchmark/torus_times.hpp"
#include "benchmark/two_parameter_times.hpp"

namespace {

constexpr const char* purpose =
    "Times continuation of the impacting orbit {J1} of the linear impact oscillator (omega = 2.0072, n = 4, NCOL = 4)\n"
    "and of a chain of such oscillators (n = 10, 20, 50), and prints tables:\n"
    "  (a) time per continuation step for 1 to 512 segments, 50 to 800 mesh intervals, 4 to 50 states;\n"
    "  (b) one Newton matrix and the multipliers, in units of the local eliminations of one Newton matrix;\n"
    "  (c) a step along a fold, period-doubling, torus or grazing curve, divided by a step of the one-parameter "
    "branch;\n"
    "  (d) a step along invariant tori by the number of orbits, beside a simulation with a curve fitted to its "
    "points;\n"
    "  (e) the elimination of mesh intervals for n = 4, 10, 20, 50, in lanes of vector registers and one by one;\n"
    "  (f) with --auto, time per step of AUTO-07p on the same k-segment problem, divided by ours;\n"
    "  (g) the peak resident size of the program;\n"
    "  (h) start-up: what a run that computes nothing takes;\n"
    "  (i) one Newton matrix by two threads, compared with one;\n"
    "  (j) a further step of `tchat run`, files and all; with --auto, beside one of AUTO's executable;\n"
    "  (k) a value of `tchat sweep`, beside a loop of Boost's odeint by hand;\n"
    "  (l) a further step of `tchat run` for 16 to 512 segments.";

constexpr const char* how_to_read =
    "How to read it. The machine's speed drops out of exponents, units and ratios; microseconds only tell where the\n"
    "time goes. (a) An exponent near 1 says that work grows in proportion; a larger one says that something couples\n"
    "segments or intervals that should be independent. (b) A part of 0.5 units takes half the time of the "
    "eliminations\n"
    "that every collocation code has to do; the parts below a line are measured on their own and add up to it only\n"
    "about. (c) Both with multipliers, as in a run; a curve has no chord iterations, every Newton matrix is new.\n"
    "(d) Processor times; the simulation has the largest tolerance, of powers of ten, with which its curve is as "
    "near.\n"
    "(f) Processor times of one thread; a ratio of 10 says that AUTO needs ten times as long for a step. AUTO\n"
    "computes no multipliers when IPS = 4, hence the two ratios. The difference is that of the states on the two\n"
    "branches at the same alpha; AUTO's file has ten digits. (e) Rates count multiplications and additions; dgemm is\n"
    "that of the BLAS that is installed. (g) Read when the program ends, its libraries included. (i) Wall-clock "
    "times,\n"
    "for a machine with two processors that do nothing else. (j) AUTO looks for no special points here, tchat for all "
    "that\nit knows; the last alphas show that both followed the same branch. (l) As in (a), files and all. Compare "
    "only\nnumbers of an optimised build.";

struct Choice {
  bool quick = false;
  bool with_auto = false;
  std::string tables;  ///< letters; empty: all
  bool has(char table) const { return tables.empty() || tables.find(table) != std::string::npos; }
};

using tchat::OrbitShape;
using tchat::benchmark::AutoSize;
using tchat::benchmark::walk_shape;

std::vector<AutoSize> auto_sizes(const Choice& choice) {
  if (choice.quick) return {{1, 50}, {2, 50}, {1, 10, 10}};
  return {{1, 50, 4, 5},  {2, 50, 4, 12}, {4, 50, 4, 20}, {8, 50, 4, 40}, {64, 50},
          {1, 200, 4, 5}, {1, 800, 4, 5}, {1, 50, 10},    {1, 50, 20},    {1, 50, 50}};
}

std::vector<tchat::benchmark::ProgramSize> program_sizes(bool quick) {
  if (quick) return {{1, 50, 4, 20}};
  return {{1, 50, 4, 600, 8}, {8, 50, 4, 100, 80}, {1, 200, 4, 300, 8}, {1, 50, 20, 150, 12}};
}

std::vector<OrbitShape> thread_shapes(bool quick) {
  if (quick) return {walk_shape(1, 10), walk_shape(10, 50)};
  return {walk_shape(1, 50, 50), walk_shape(1, 100, 50), walk_shape(1, 50, 20), walk_shape(1, 40, 20),
          walk_shape(64, 50),    walk_shape(10, 50),     walk_shape(8, 50),     walk_shape(1, 50)};
}

void print_tables(const Choice& choice) {
  using namespace tchat::benchmark;
  const bool quick = choice.quick;
  if (choice.has('a')) {
    StepSizes sizes{{1, 2, 4, 8, 16, 32, 64}, {50, 100, 200, 400, 800}, {4, 10, 20, 50}, 50, {64, 128, 256, 512}};
    if (quick) sizes = {{1, 2}, {10, 20}, {4, 10}, 10, {2, 4}, 5, 2};
    print_step_times(sizes);
  }
  if (choice.has('b')) print_matrix_times(quick ? 5 : 2000);
  if (choice.has('c')) print_two_parameter_times(quick ? 1 : 15, quick ? 20 : 100);
  if (choice.has('d'))
    print_torus_times(quick ? std::vector<int>{11, 21} : std::vector<int>{21, 41, 81, 127, 255}, quick ? 2 : 9,
                      quick ? 300 : 1500);
  if (choice.has('e'))
    print_elimination_times(quick ? std::vector<int>{4, 10} : std::vector<int>{4, 10, 20, 50}, quick ? 5 : 2000);
  if (choice.with_auto && choice.has('f')) print_auto_comparison(auto_sizes(choice), quick);
  if (choice.has('g')) {
    MemorySizes sizes{{1, 4, 16, 32, 64}, {50, 200, 800, 2000, 5000}, {4, 10, 20, 50}};
    if (quick) sizes = {{1, 2}, {10, 20}, {4}, 20};
    print_memory_sizes(sizes);
  }
  if (choice.has('h')) print_start_times(quick ? 2 : 40, quick);
  if (choice.has('i')) print_thread_times(thread_shapes(quick), quick ? 1 : 9);
  if (choice.has('j')) print_program_times(program_sizes(quick), quick ? 1 : 5, choice.with_auto);
  if (choice.has('k')) print_sweep_times(quick ? 3 : 21, quick ? 1 : 5);
  if (choice.has('l')) {
    if (quick)
      print_segment_times({2, 4}, 5, 1);
    else
      print_segment_times({16, 32, 64, 128, 256, 512}, 10, 15);
  }
}

int run(const Choice& choice) {
#ifndef NDEBUG
  fmt::print("This is not an optimised build: the times mean little.\n\n");
#endif
  if (choice.with_auto && !tchat::benchmark::auto_is_installed()) return 1;
  print_tables(choice);
  fmt::print("{}\n", how_to_read);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Choice choice;
  CLI::App app{purpose, "tchat_benchmark"};
  app.footer(how_to_read);
  app.add_flag("--auto", choice.with_auto, "compare with AUTO-07p (Debian packages auto-07p and gfortran)");
  app.add_option("--tables", choice.tables, "these alone, as in --tables acf");
  app.add_flag("--quick", choice.quick, "few and small measurements: shows that the program works, times mean nothing");
  CLI11_PARSE(app, argc, argv);
  try {
    const tchat::benchmark::CompiledProblems problems;
    return run(choice);
  } catch (const std::exception& error) {
    fmt::print(stderr, "tchat_benchmark: {}\n", error.what());
    return 1;
  }
}
