// tchat_benchmark: how fast a continuation step is, how it scales, and how it compares with AUTO-07p.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "benchmark/auto_comparison.hpp"
#include "benchmark/elimination_times.hpp"
#include "benchmark/matrix_times.hpp"
#include "benchmark/step_times.hpp"
#include "benchmark/torus_times.hpp"
#include "benchmark/two_parameter_times.hpp"

namespace {

constexpr const char* purpose =
    "Times continuation of the impacting orbit {J1} of the linear impact oscillator (omega = 2.0072, n = 4, NCOL = 4)\n"
    "and prints tables:\n"
    "  (a) time per continuation step for 1 to 16 segments and for 50 to 800 mesh intervals;\n"
    "  (b) one Newton matrix and the multipliers, in units of the local eliminations of one Newton matrix;\n"
    "  (c) a step along a fold, period-doubling or torus curve, divided by a step of the one-parameter branch;\n"
    "  (d) a step along invariant tori by the number of orbits, beside a simulation with a curve fitted to its "
    "points;\n"
    "  (e) the elimination of mesh intervals for n = 4, 10, 20, 50, in lanes of vector registers and one by one;\n"
    "  (f) with --auto, time per step of AUTO-07p on the same k-segment problem, divided by ours.";

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
    "that of the BLAS that is installed. Compare only numbers of an optimised build.";

int run(bool quick, bool with_auto, bool only_tori) {
  using namespace tchat::benchmark;
#ifndef NDEBUG
  fmt::print("This is not an optimised build: the times mean little.\n\n");
#endif
  if (only_tori) {
    print_torus_times({21, 41, 81, 127, 255}, 9, 1500);
    return 0;
  }
  StepSizes sizes{{1, 2, 4, 8, 16}, {50, 100, 200, 400, 800}};
  if (quick) sizes = {{1, 2}, {10, 20}, 10, 3};
  print_step_times(sizes);
  print_matrix_times(quick ? 5 : 2000);
  print_two_parameter_times(quick ? 3 : 400, quick ? 20 : 100);
  print_torus_times(quick ? std::vector<int>{11, 21} : std::vector<int>{21, 41, 81, 127, 255}, quick ? 2 : 9,
                    quick ? 300 : 1500);
  print_elimination_times(quick ? std::vector<int>{4, 10} : std::vector<int>{4, 10, 20, 50}, quick ? 5 : 2000);
  if (with_auto && !auto_is_installed()) return 1;
  if (with_auto)
    print_auto_comparison(quick ? std::vector<AutoSize>{{1, 50}, {2, 50}}
                                : std::vector<AutoSize>{{1, 50}, {2, 50}, {4, 50}, {8, 50}, {1, 200}, {1, 800}},
                          quick);
  fmt::print("{}\n", how_to_read);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false;
  bool with_auto = false;
  bool only_tori = false;
  CLI::App app{purpose, "tchat_benchmark"};
  app.footer(how_to_read);
  app.add_flag("--auto", with_auto, "compare with AUTO-07p (Debian packages auto-07p and gfortran)");
  app.add_flag("--tori", only_tori, "table (d) alone");
  app.add_flag("--quick", quick, "few and small measurements: shows that the program works, times mean nothing");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(quick, with_auto, only_tori);
  } catch (const std::exception& error) {
    fmt::print(stderr, "tchat_benchmark: {}\n", error.what());
    return 1;
  }
}
