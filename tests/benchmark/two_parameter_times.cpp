#include "benchmark/two_parameter_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>

#include "benchmark/compiled_problem.hpp"
#include "benchmark/timing.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "stability/floquet_multipliers.hpp"
#include "stability/impacting_orbits.hpp"
#include "stability/langford.hpp"

namespace tchat::benchmark {

namespace {

constexpr NewtonSettings newton{8, 3, 1e-7, 1e-7};
/// PathFollower renews factors that are older than this before it takes the tangent from them.
constexpr double current_enough = 1e-10;
constexpr int maximum_event = 2;  // of linosc
constexpr int one_way = 20;

/// A start on a curve, which lies on a one-parameter branch too.
struct Bifurcation {
  std::string name;
  const HybridSystem* hybrid;
  Signature signature;
  Orbit orbit;
  enum class Kept { multiplier, pair, contact } kept = Kept::multiplier;
  int multiplier = 1;              ///< +1 or -1
  std::complex<double> pair = {};  ///< of the torus
  double ds = 0.01;                ///< arclength of a step
  int parameter = 1;               ///< of the branch; the curve has PAR(1) and PAR(2)
  double wanted = 2.0;             ///< the largest ratio that is allowed
};

/// The grazing orbit ends in the contact; beside it the orbits that end at their maximum, which is the same place.
std::unique_ptr<DefiningSystem> system_of_walk(const Bifurcation& at, bool two_parameters) {
  if (!two_parameters) {
    Signature signature = at.signature;
    if (at.kept == Bifurcation::Kept::contact) signature.back().event = maximum_event;
    return std::make_unique<PeriodicOrbitSystem>(*at.hybrid, signature, std::vector<int>{at.parameter});
  }
  const std::vector<int> free{at.parameter, 3 - at.parameter};
  if (at.kept != Bifurcation::Kept::contact)
    return std::make_unique<PeriodicOrbitSystem>(*at.hybrid, at.signature, free);
  return std::make_unique<GrazingOrbitSystem>(*at.hybrid, at.signature, free,
                                              static_cast<int>(at.signature.size()) - 1);
}

std::unique_ptr<OrbitCondition> condition_of(const Bifurcation& at, const DefiningSystem& system) {
  if (at.kept == Bifurcation::Kept::contact) return nullptr;
  if (at.kept == Bifurcation::Kept::pair) return std::make_unique<CriticalPair>(system, at.orbit.shape, at.pair);
  return std::make_unique<CriticalMultiplier>(system, at.orbit.shape, at.multiplier);
}

/// There and back again with fixed step: along the branch in PAR(1) or PAR(2), or along the curve in PAR(1) and PAR(2).
class Walk {
 public:
  Walk(const Bifurcation& at, bool two_parameters)
      : system_(system_of_walk(at, two_parameters)),
        follower_(*system_, at.orbit.shape, WeightedNorm::unit(at.orbit.shape), newton, at.parameter,
                  two_parameters ? condition_of(at, *system_) : nullptr),
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
    matrices_ += chord ? std::min(result.iterations, newton.full_iterations) : result.iterations;
    if (result.change_since_factorization > current_enough) ++matrices_;  // for the tangent
  }
  /// Newton matrices, that for the tangent included.
  double matrices_per_step() const { return static_cast<double>(matrices_) / steps_; }

  std::vector<double> times;

 private:
  std::unique_ptr<DefiningSystem> system_;
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
  Bifurcation result{name,
                     &problem_of_repository("linosc"),
                     cut.signature,
                     sampled_orbit(cut.pieces, 4, intervals, 4, orbit.par()),
                     Bifurcation::Kept::multiplier,
                     multiplier};
  result.wanted = fold ? 2.2 : 2.0;
  return result;
}

/// At alpha = 3 from contact to contact, in omega: in alpha the equations are linear, and one matrix does.
Bifurcation grazing_oscillator(int intervals) {
  using namespace tchat::test;
  const OscillatorOrbit orbit = one_impact_orbit(grazing_omega, 0.0);
  Bifurcation result{"grazing, linosc",
                     &problem_of_repository("linosc"),
                     {{1, 1, 2}},
                     sampled_orbit(whole(orbit).pieces, 4, intervals, 4, orbit.par()),
                     Bifurcation::Kept::contact};
  result.parameter = 2;
  result.wanted = 1.2;
  return result;
}

Bifurcation of_langford(int intervals) {
  using namespace tchat::test;
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  Bifurcation result{"torus, langford", &problem_of_repository("langford"), {{1, 1, 1}}, circle.orbit(intervals, 4)};
  result.kept = Bifurcation::Kept::pair;
  result.pair = circle.multiplier();
  result.wanted = 3.0;
  return result;
}

/// A step, mean of those there and back.
double seconds_a_step(Walk& walk, int steps) {
  walk.times.clear();
  for (int k = 0; k < steps; ++k) walk.step();
  return std::accumulate(walk.times.begin(), walk.times.end(), 0.0) / steps;
}

void print_line(const Bifurcation& at, int rounds) {
  Walk branch(at, false);
  Walk curve(at, true);
  std::vector<double> branch_times;
  std::vector<double> curve_times;
  for (int k = 0; k < rounds; ++k) {
    branch_times.push_back(seconds_a_step(branch, 2 * one_way));
    curve_times.push_back(seconds_a_step(curve, 2 * one_way));
  }
  const double ratio = least(curve_times) / least(branch_times);
  const double by_matrix = ratio * branch.matrices_per_step() / curve.matrices_per_step();
  fmt::print("  {:<26}{:>4}{:>12.1f}{:>12.1f}{:>10.2f}{:>10.2f}{:>9.2f}{:>12.2f}{:>8.1f}\n", at.name,
             at.signature.size(), 1e6 * least(branch_times), 1e6 * least(curve_times), branch.matrices_per_step(),
             curve.matrices_per_step(), ratio, by_matrix, at.wanted);
}

}  // namespace

void print_two_parameter_times(int rounds, int intervals) {
  fmt::print(
      "(c) A step in two parameters over a step of the one-parameter branch, NTST = {}, NCOL = 4, least of {} "
      "alternating runs\n\n",
      intervals, rounds);
  fmt::print("  {:<26}{:>4}{:>12}{:>12}{:>10}{:>10}{:>9}{:>12}{:>8}\n", "", "", "branch", "curve", "matrices",
             "matrices", "ratio", "ratio per", "at");
  fmt::print("  {:<26}{:>4}{:>12}{:>12}{:>10}{:>10}{:>9}{:>12}{:>8}\n", "curve", "m", "[us]", "[us]", "branch", "curve",
             "", "matrix", "most");
  for (const bool two : {false, true}) {
    print_line(of_oscillator("fold, linosc", 1, two, intervals), rounds);
    print_line(of_oscillator("period doubling, linosc", -1, two, intervals), rounds);
  }
  print_line(of_langford(intervals), rounds);
  print_line(grazing_oscillator(intervals), rounds);
  fmt::print("\n");
}

}  // namespace tchat::benchmark
