// No heap allocation by our own code inside the Newton loop after the first step. Every allocation of the program goes
// through the counters below; what UMFPACK asks for is counted apart, as SuiteSparse lets its allocator be replaced.
// Steps are those of one thread. Where several share a large problem, oneTBB's memory for tasks comes in addition: it
// is kept and used again, but how much there is depends on which thread was faster.
#include <SuiteSparse_config.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <functional>
#include <new>

#include "continuation/continuation_run.hpp"
#include "continuation/planar_torus.hpp"
#include "files/run_files.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/branch_writer.hpp"
#include "run/solver_settings.hpp"
#include "stability/impacting_orbits.hpp"
#include "stability/langford.hpp"
#include "stability/normal_form.hpp"
#include "stability/torus_contact.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/sharp_start.hpp"
#include "support/temporary_folder.hpp"
#include "support/three_modes.hpp"

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
extern "C" void* __libc_memalign(std::size_t, std::size_t);

namespace {

std::atomic<bool> counting{false};
std::atomic<long> ours{0};
std::atomic<long> solver{0};

void count() {
  if (counting) ++ours;
}

struct CountedScope {
  CountedScope() {
    ours = 0;
    solver = 0;
    counting = true;
  }
  ~CountedScope() { counting = false; }
};

}  // namespace

// Eigen and the C library's users go through malloc, operator new does too.
extern "C" void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
extern "C" void* realloc(void* p, std::size_t size) {
  count();
  return __libc_realloc(p, size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}

using namespace tchat;
using namespace tchat::test;

namespace {

void* solver_malloc(std::size_t size) {
  if (counting) ++solver;
  return __libc_malloc(size);
}
void* solver_calloc(std::size_t number, std::size_t size) {
  if (counting) ++solver;
  return __libc_calloc(number, size);
}
void* solver_realloc(void* p, std::size_t size) {
  if (counting) ++solver;
  return __libc_realloc(p, size);
}

void give_solver_its_own_allocator() {
#if SUITESPARSE_VERSION >= SUITESPARSE_VER_CODE(6, 0)
  SuiteSparse_config_malloc_func_set(solver_malloc);
  SuiteSparse_config_calloc_func_set(solver_calloc);
  SuiteSparse_config_realloc_func_set(solver_realloc);
#else
  SuiteSparse_config.malloc_func = solver_malloc;
  SuiteSparse_config.calloc_func = solver_calloc;
  SuiteSparse_config.realloc_func = solver_realloc;
#endif
}

struct Counts {
  long ours, solver;
  int newton_iterations;
};

/// Done at each point, whose linearisation the follower holds.
using AtPoint = std::function<void(const Orbit&)>;

Counts steps_after_the_first(
    PathFollower& follower, PathPoint here, double ds, const AtPoint& at_point = [](const Orbit&) {}) {
  PathPoint next = here;
  REQUIRE(follower.step(here, ds, next).converged());
  at_point(next.orbit);
  follower.iterations_along_tangent(here, ds, next, true);
  std::swap(here, next);
  Counts counts{0, 0, 0};
  const CountedScope scope;
  for (int k = 0; k < 10; ++k) {  // one or two iterations each
    const NewtonResult result = follower.step(here, ds, next);
    if (!result.converged()) break;
    at_point(next.orbit);
    follower.iterations_along_tangent(here, ds, next, k % 2 == 0);
    counts.newton_iterations += result.iterations;
    std::swap(here, next);
  }
  counts.ours = ours;
  counts.solver = solver;
  return counts;
}

Counts steps_after_the_first(PeriodicOrbits& orbits, const Orbit& start, double ds) {
  const PathPoint here = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  return steps_after_the_first(orbits.follower, here, ds);
}

/// On the two-parameter curve of a condition, from its start.
template <class Condition, class Multiplier>
Counts steps_on_curve(const HybridSystem& hybrid, const Orbit& start, Multiplier multiplier) {
  give_solver_its_own_allocator();
  const PeriodicOrbitSystem system(hybrid, {{1, 1, 1}}, {1, 2});
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), {9, 3, 1e-10, 1e-10}, 1,
                        std::make_unique<Condition>(system, start.shape, multiplier));
  PathPoint here = follower.make_point(start);
  REQUIRE(follower.start_by_minimum_norm(here).converged());
  NormalFormSolver forms(system);
  const FloquetMultipliers multipliers;
  int found = 0;
  const bool has_cubic_term = follower.condition()->kept_multiplier() != 1;
  const Counts counts = steps_after_the_first(follower, here, 0.02, [&](const Orbit& x) {
    found += has_cubic_term && forms.find(follower.condensed(), x, *follower.condition(), multipliers);
  });
  CHECK((found >= 5) == has_cubic_term);
  return counts;
}

}  // namespace

TEST_CASE("the counters count") {
  give_solver_its_own_allocator();
  long mine = 0;
  {
    const CountedScope scope;
    const std::vector<double> v(100, 1.0);
    const Eigen::VectorXd w = Eigen::VectorXd::Constant(50, v[3]);
    mine = w(7) > 0.0 ? ours.load() : -1;
  }
  CHECK(mine == 2);
}

TEST_CASE("no allocation of our own in continuation steps after the first") {
  give_solver_its_own_allocator();
  const int copies = GENERATE(1, 4, 16);
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const std::vector<Piece> pieces(static_cast<std::size_t>(copies), orbit.piece(0, orbit.constants.period()));
  const Orbit start = sampled_orbit(pieces, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), Signature(static_cast<std::size_t>(copies), {1, 1, 1}), 1, start.shape,
                        {8, 2, 1e-9, 1e-9});
  const Counts counts = steps_after_the_first(orbits, start, 0.05);
  CHECK(counts.newton_iterations >= 10);
  CHECK(counts.ours == 0);
  // What is left of 16 segments are frontal matrices, of fewer it is a small dense one: nothing is left for UMFPACK.
  CHECK(counts.solver == 0);
}

/// Counts from one point of the branch to another, both written.
class CountingSink final : public BranchSink {
 public:
  CountingSink(BranchWriter& writer, int from, int to) : writer_(writer), from_(from), to_(to) {}
  void point(const BranchPoint& point) override {
    writer_.point(point);
    if (point.number == from_) ours = 0, solver = 0, counting = true;
    if (point.number == to_) counting = false;
    labels_ += counting && point.labelled();
  }
  void next_step(int point_number, double ds) override { writer_.next_step(point_number, ds); }
  void note(int point_number, const std::string& text) override { writer_.note(point_number, text); }
  int labels() const { return labels_; }

 private:
  BranchWriter& writer_;
  int from_, to_, labels_ = 0;
};

TEST_CASE("no allocation from the hundredth point of a branch on, files, tests and new meshes included") {
  give_solver_its_own_allocator();
  const int copies = GENERATE(1, 8);
  CAPTURE(copies);
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const std::vector<Piece> pieces(static_cast<std::size_t>(copies), orbit.piece(0, orbit.constants.period()));
  const Orbit start = sampled_orbit(pieces, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), Signature(static_cast<std::size_t>(copies), {1, 1, 1}), 1, start.shape,
                        {8, 2, 1e-9, 1e-9});
  RunSettings settings;
  settings.problem_type = 180;
  settings.dimension = 4;
  settings.free_parameters = {1, 61};
  settings.mesh_intervals = 50;
  settings.collocation_points = 4;
  settings.detect_bifurcations = 2;
  settings.detect_folds = 1;
  settings.test_functions = {1};
  SegmentSettings segment;
  segment.index = {1, 1, 1};
  segment.monitor = {1};
  settings.segments.assign(static_cast<std::size_t>(copies), segment);
  const test_support::TemporaryFolder folder;
  RunFiles files(folder.file("branch"));
  files.open("");
  BranchWriter writer(linosc(), orbits.follower.condensed().rule(), {settings, settings.free_parameters}, files,
                      nullptr);
  writer.begin_section(1, 1e-4, {});

  constexpr int from = 100, to = 400;
  ContinuationSettings of_branch = branch_settings(start.shape, 1, 1e-4, 1e-4, to);
  of_branch.adapt_mesh_every = 3;
  for (std::vector<int>& events : of_branch.monitored) events = {1};
  TestList tests = contact_tests(orbits.system, settings);
  add_bifurcations(tests, orbits.system, settings);
  REQUIRE(tests.size() == static_cast<std::size_t>(7 + 2 * copies));
  CountingSink sink(writer, from, to - 1);
  ContinuationRun run(orbits.follower, orbits.system, of_branch, std::move(tests), sink);
  const BranchSummary summary = run.run(orbits.corrected(start));
  REQUIRE(summary.points == to);
  CHECK(sink.labels() == 0);
  // The problem's own answers, what follows the end of each segment: for the rule of its event, and for admissibility.
  CHECK(ours == 2 * copies * (to - 1 - from));
  CHECK(solver == 0);
}

/// Counts from one point of the branch to another, of which nothing is kept.
class QuietSink final : public BranchSink {
 public:
  QuietSink(int from, int to) : from_(from), to_(to) {}
  void point(const BranchPoint& point) override {
    if (point.number == from_) ours = 0, solver = 0, counting = true;
    if (point.number == to_) counting = false;
    shapes_ += !(shape_ == point.path.orbit.shape);
    shape_ = point.path.orbit.shape;
  }
  void next_step(int, double) override {}
  void note(int, const std::string&) override {}
  /// How often the segments got other numbers of intervals.
  int shapes() const { return shapes_; }
  const OrbitShape& shape() const { return shape_; }

 private:
  int from_, to_;
  OrbitShape shape_;
  int shapes_ = 0;
};

TEST_CASE("no allocation along a branch on own meshes that have settled, new meshes included") {
  give_solver_its_own_allocator();
  const double rate = 50.0;
  const Orbit start = with_own_meshes(SharpStart::sampled(SharpStart::orbit(rate), rate, 30, 4));
  PeriodicOrbits orbits(system_of<SharpStart>(), SharpStart::signature(), 1, start.shape, {8, 2, 1e-9, 1e-9});
  constexpr int from = 100, to = 300;
  ContinuationSettings settings = branch_settings(start.shape, 1, 0.01, 0.01, to);
  settings.adapt_mesh_every = 3;
  QuietSink sink(from, to - 1);
  ContinuationRun run(orbits.follower, orbits.system, settings, {}, sink);
  const BranchSummary summary = run.run(orbits.corrected(start));
  REQUIRE(summary.points == to);
  CHECK(sink.shape().intervals_of(0) > sink.shape().intervals_of(1));
  CHECK(sink.shapes() <= 5);
  CHECK(ours == 0);
  CHECK(solver == 0);
}

TEST_CASE("no allocation with kernels of run-time size, several fields and jumps") {
  give_solver_its_own_allocator();
  const PeriodicOrbit reference = ThreeModes::orbit(ThreeModes::par());
  const Orbit start =
      sampled_orbit(pieces_of(system_of<ThreeModes>(), ThreeModes::signature(), reference.map, ThreeModes::par()), 3,
                    20, 6, ThreeModes::par());
  PeriodicOrbits orbits(system_of<ThreeModes>(), ThreeModes::signature(), 1, start.shape, {8, 2, 1e-9, 1e-9});
  const Counts counts = steps_after_the_first(orbits, start, 0.02);
  CHECK(counts.newton_iterations >= 5);
  CHECK(counts.ours == 0);
}

TEST_CASE("no allocation of our own along fold, period-doubling and torus curves with their cubic terms") {
  const OscillatorOrbit fold = one_impact_orbit(1.8901, fold_velocity());
  const OscillatorOrbit doubling = one_impact_orbit(2.0072, period_doubling_velocity());
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  const auto sampled = [](const OscillatorOrbit& orbit) {
    return sampled_orbit(whole(orbit).pieces, 4, 30, 4, orbit.par());
  };
  const Counts counts[] = {
      steps_on_curve<CriticalMultiplier>(linosc(), sampled(fold), 1),
      steps_on_curve<CriticalMultiplier>(linosc(), sampled(doubling), -1),
      steps_on_curve<CriticalPair>(system_of<Langford>(), circle.orbit(30, 4), circle.multiplier()),
  };
  for (const Counts& curve : counts) {
    CHECK(curve.newton_iterations >= 5);
    CHECK(curve.ours == 0);
  }
}

TEST_CASE("no allocation of our own along a grazing curve") {
  give_solver_its_own_allocator();
  const OscillatorOrbit orbit = nonimpacting_orbit(1.7, std::abs(OscillatorConstants{1.7}.stiffness()));
  const double half = orbit.constants.period() / 2;
  const Orbit start = sampled_orbit({orbit.piece(0, half), orbit.piece(half, 2 * half)}, 4, 30, 4, orbit.par());
  const GrazingOrbitSystem system(linosc(), {{1, 3, 2}, {1, 1, 2}}, {2, 1}, 1);
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), {9, 3, 1e-10, 1e-10}, 2);
  PathPoint here = follower.make_point(start);
  REQUIRE(follower.start_at_fixed_parameter(here).converged());
  const Counts counts = steps_after_the_first(follower, here, 0.05);
  CHECK(counts.newton_iterations >= 5);
  CHECK(counts.ours == 0);
}

TEST_CASE("no allocation of our own along branches of tori, rho free or fixed") {
  give_solver_its_own_allocator();
  const std::vector<int> free =
      GENERATE(std::vector<int>{omega, ParameterLayout().rotation()}, std::vector<int>{omega, 2});
  Torus torus(15, {4, 1, 10, 4}, free);
  PathPoint here = torus.follower.make_point(torus.start(2.0, 1e-5));
  REQUIRE(torus.follower.start_at_fixed_parameter(here).converged());
  const Counts counts = steps_after_the_first(torus.follower, here, 0.02);
  CHECK(counts.newton_iterations >= 5);
  CHECK(counts.ours == 0);
  // What is left of orbits that are all coupled is UMFPACK's, whose allocator was indeed replaced.
  CHECK(counts.solver > 0);
}

TEST_CASE("no allocation of our own along tori in grazing contact, rho free or fixed") {
  give_solver_its_own_allocator();
  const std::vector<int> free =
      GENERATE(std::vector<int>{omega, wall, ParameterLayout().rotation()}, std::vector<int>{omega, 2, wall});
  const Torus torus(15, {4, 1, 10, 4});
  const TorusSystem system(system_of<PlanarTorus>(), {{1, 1, 1}}, 15, free);
  PathFollower follower(system, torus.shape, WeightedNorm::unit(torus.shape), {12, 12, 1e-10, 1e-10}, omega,
                        std::make_unique<TorusContactCondition>(system, torus.shape, 0, 2));
  Orbit start = torus.start(2.0, 1e-6);
  start.par(wall - 1) = 1.0 / (1.0 - 1.0 / std::sqrt(5.0));
  PathPoint here = follower.make_point(start);
  REQUIRE(follower.start_at_fixed_parameter(here).converged());
  const Counts counts = steps_after_the_first(follower, here, 0.02);
  CHECK(counts.newton_iterations >= 5);
  CHECK(counts.ours == 0);
}
