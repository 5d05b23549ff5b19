#include "benchmark/two_parameter_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>

#include "benchmark/timing.hpp"
#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "continuation/path_follower.hpp"
#include "special_points/impacting_orbits.hpp"
#include "special_points/langford.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat::benchmark {

namespace {

constexpr NewtonSettings curve_newton{8, 3, 1e-7, 1e-7};
/// PathFollower renews factors that are older than this before it takes the tangent from them.
constexpr double curve_current_enough = 1e-10;

/// A start on a curve, which lies on a one-parameter branch too.
struct Bifurcation {
  std::string name;
  const HybridSystem* hybrid;
  Signature signature;
  Orbit orbit;
  int multiplier = 1;              ///< +1 or -1; 0: the pair
  std::complex<double> pair = {};  ///< of the torus
  double ds = 0.01;                ///< arclength of a step
  double wanted = 3.0;             ///< the largest ratio that is allowed
};

std::unique_ptr<OrbitCondition> condition_of(const Bifurcation& at, const DefiningSystem& system) {
  if (at.multiplier == 0) return std::make_unique<CriticalPair>(system, at.orbit.shape, at.pair);
  return std::make_unique<CriticalMultiplier>(system, at.orbit.shape, at.multiplier);
}

/// There and back again with fixed step: along the branch in PAR(1), or along the curve in PAR(1) and PAR(2).
class Walk {
 public:
  Walk(const Bifurcation& at, bool two_parameters)
      : system_(*at.hybrid, at.signature, two_parameters ? std::vector<int>{1, 2} : std::vector<int>{1}),
        follower_(system_, at.orbit.shape, WeightedNorm::unit(at.orbit.shape.dimension), curve_newton, 1,
                  two_parameters ? condition_of(at, system_) : nullptr),
        floquet_(at.orbit.shape),
        point_(follower_.make_point(at.orbit)),
        next_(point_),
        ds_(at.ds) {
    if (!follower_.start_by_minimum_norm(point_).converged())
      throw std::runtime_error("no start on the curve of " + at.name);
    next_ = point_;
  }
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;

  /// With multipliers, as in a run.
  void step() {
    constexpr int one_way = 20;
    if (steps_ > 0 && steps_ % one_way == 0) ds_ = -ds_;
    NewtonResult result;
    times.push_back(processor_seconds([&] {
      result = follower_.step(point_, ds_, next_);
      keep(floquet_.compute(follower_.condensed(), next_.orbit));
    }));
    if (!result.converged()) throw std::runtime_error("a step along the curve failed: " + describe(result.status));
    std::swap(point_, next_);
    ++steps_;
    const bool chord = follower_.condition() == nullptr;
    matrices_ += chord ? std::min(result.iterations, curve_newton.full_iterations) : result.iterations;
    if (result.change_since_factorization > curve_current_enough) ++matrices_;  // for the tangent
  }
  /// Newton matrices, that for the tangent included.
  double matrices_per_step() const { return static_cast<double>(matrices_) / steps_; }

  std::vector<double> times;

 private:
  PeriodicOrbitSystem system_;
  PathFollower follower_;
  FloquetSolver floquet_;
  PathPoint point_;
  PathPoint next_;
  double ds_;
  int steps_ = 0;
  int matrices_ = 0;
};

Bifurcation of_oscillator(const std::string& name, int multiplier, bool two_segments, int intervals) {
  using namespace tchat::test;
  const bool fold = multiplier > 0;
  const OscillatorOrbit orbit =
      fold ? one_impact_orbit(1.8901, fold_velocity()) : one_impact_orbit(2.0072, period_doubling_velocity());
  const CutOrbit cut = two_segments ? cut_at_minimum(orbit, false) : whole(orbit);
  return {name, &linosc(), cut.signature, sampled_orbit(cut.pieces, 4, intervals, 4, orbit.par()), multiplier};
}

Bifurcation of_langford(int intervals) {
  using namespace tchat::test;
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  Bifurcation result{"torus, langford", &system_of<Langford>(), {{1, 1, 1}}, circle.orbit(intervals, 4)};
  result.multiplier = 0;
  result.pair = circle.multiplier();
  result.wanted = 6.0;
  return result;
}

void print_line(const Bifurcation& at, int steps) {
  Walk branch(at, false);
  Walk curve(at, true);
  for (int k = 0; k < steps; ++k) branch.step(), curve.step();
  const double ratio = median(curve.times) / median(branch.times);
  const double by_matrix = ratio * branch.matrices_per_step() / curve.matrices_per_step();
  fmt::print("  {:<26}{:>4}{:>12.1f}{:>12.1f}{:>10.2f}{:>10.2f}{:>9.2f}{:>12.2f}{:>8.0f}\n", at.name,
             at.signature.size(), 1e6 * median(branch.times), 1e6 * median(curve.times), branch.matrices_per_step(),
             curve.matrices_per_step(), ratio, by_matrix, at.wanted);
}

}  // namespace

void print_two_parameter_times(int steps, int intervals) {
  fmt::print("(c) A step in two parameters over a step of the one-parameter branch, NTST = {}, NCOL = 4\n\n",
             intervals);
  fmt::print("  {:<26}{:>4}{:>12}{:>12}{:>10}{:>10}{:>9}{:>12}{:>8}\n", "", "", "branch", "curve", "matrices",
             "matrices", "ratio", "ratio per", "at");
  fmt::print("  {:<26}{:>4}{:>12}{:>12}{:>10}{:>10}{:>9}{:>12}{:>8}\n", "curve", "m", "[us]", "[us]", "branch", "curve",
             "", "matrix", "most");
  for (const bool two : {false, true}) {
    print_line(of_oscillator("fold, linosc", 1, two, intervals), steps);
    print_line(of_oscillator("period doubling, linosc", -1, two, intervals), steps);
  }
  print_line(of_langford(intervals), steps);
  fmt::print("\n");
}

}  // namespace tchat::benchmark
