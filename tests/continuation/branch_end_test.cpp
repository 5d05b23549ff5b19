// How branches end, and which points are labelled.
#include <catch2/catch.hpp>

#include "continuation/solution_measure.hpp"
#include "settings/problem_type.hpp"
#include "stability/normal_forms.hpp"
#include "stability/test_function.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

/// The impacting branch at omega = 2.0072 from v = 0.5, alpha growing.
struct Branch {
  PeriodicOrbits orbits{linosc(), {{1, 1, 1}}, 1, {4, 1, 30, 4}};
  ContinuationSettings settings = branch_settings({4, 1, 30, 4}, 1, 0.05, 0.2, 12);
  std::vector<std::unique_ptr<TestFunction>> tests;
  KeepingSink sink;

  BranchSummary run() {
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
    const PathPoint point =
        orbits.corrected(sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 30, 4, orbit.par()));
    REQUIRE(orbits.result.converged());
    ContinuationRun continuation(orbits.follower, orbits.system, settings, std::move(tests), sink);
    return continuation.run(point);
  }
  std::vector<int> labelled() const {
    std::vector<int> numbers;
    for (const KeptPoint& p : sink.points)
      if (p.special.type != PointType::ordinary) numbers.push_back(p.number);
    return numbers;
  }
};

/// The normal forms, until their field is broken: then it has no value anywhere.
struct Breakable : NormalForms {
  static inline bool broken = false;
  template <class T>
  void field(int i, const T* u, const T* p, T* f) const {
    NormalForms::field(i, u, p, f);
    if (broken) f[2] = std::numeric_limits<double>::quiet_NaN();
  }
};

/// Refuses the first step beyond mu = -0.1 by a value far from its trend, and breaks the field.
class Breaking final : public TestFunction {
 public:
  std::string name() const override { return "breaking"; }
  TestValue evaluate(const TestedPoint& point) const override {
    if (point.orbit.par(0) < -0.1) return TestValue::of(1.0, 0.0);
    Breakable::broken = true;
    return TestValue::of(1e6, 0.0);
  }
  Resolution resolution() const override { return Resolution::trend; }
  SpecialPoint classify(const TestedPoint&, bool) const override { return {}; }
};

/// Is reported where alpha passes 3.05.
class OnlyReported final : public TestFunction {
 public:
  std::string name() const override { return "reported"; }
  TestValue evaluate(const TestedPoint& point) const override { return TestValue::of(point.orbit.par(0) - 3.05, 0.0); }
  bool is_only_reported() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override { return {}; }
};

}  // namespace

TEST_CASE("a summary names its family also where a branch that goes on with another mesh has no point of its own") {
  Branch branch;
  branch.settings.resumes = true;
  branch.settings.may_refine = true;
  branch.settings.error_bound = 1e-300;
  const BranchSummary summary = branch.run();
  CHECK(summary.reason == EndReason::outgrown);
  CHECK(branch.sink.points.empty());
  REQUIRE(summary.family != nullptr);
  CHECK(std::string(summary.family->solution) == "a periodic orbit");
}

TEST_CASE("a branch ends after NMX points, the first and the last labelled EP, every NPR-th labelled") {
  Branch branch;
  branch.settings.print_every = 4;
  const BranchSummary summary = branch.run();
  CHECK(summary.reason == EndReason::max_points);
  CHECK(summary.points == 12);
  CHECK(branch.labelled() == std::vector<int>{1, 4, 8, 12});
  CHECK(branch.sink.points.front().special.type == PointType::end);
  CHECK(branch.sink.points[3].special.type == PointType::regular);
  CHECK(branch.sink.points.back().special.type == PointType::end);
  for (std::size_t k = 0; k < branch.sink.points.size(); ++k)
    CHECK(branch.sink.points[k].number == static_cast<int>(k) + 1);
}

TEST_CASE("a restart does not label its first point again") {
  Branch branch;
  branch.settings.label_start = false;
  branch.run();
  CHECK(branch.labelled() == std::vector<int>{12});
}

TEST_CASE("bounds on the parameter and on the measure end a branch at the first point beyond") {
  Branch by_parameter;
  by_parameter.settings.parameter_max = 3.06;
  CHECK(by_parameter.run().reason == EndReason::beyond_bound);
  const std::vector<KeptPoint>& points = by_parameter.sink.points;
  CHECK(points.back().orbit.par(0) > 3.06);
  CHECK(points[points.size() - 2].orbit.par(0) <= 3.06);

  Branch by_measure;
  by_measure.settings.measure = 2;  // max x2
  by_measure.settings.measure_max = 2.2;
  by_measure.settings.max_points = 60;
  CHECK(by_measure.run().reason == EndReason::beyond_bound);
  CHECK(maximum_of(by_measure.sink.points.back().orbit, 2) > 2.2);
}

TEST_CASE("a special point counts up to the bound, also in the last step, beyond it the branch ends with EP") {
  // Steps that go far beyond alpha = 3.0526: with one user value before the bound, at it, beyond it, or both.
  const auto last_points = [](const std::vector<double>& values, double bound) {
    Branch branch;
    branch.settings.step.initial = branch.settings.step.maximum = 0.4;
    branch.settings.parameter_max = bound;
    for (const double value : values) branch.tests.push_back(std::make_unique<UserValueTest>(1, value, true, "alpha"));
    const BranchSummary summary = branch.run();
    return std::pair{summary.reason, branch.sink.points};
  };
  const auto [before, stopped] = last_points({3.0525, 3.0527}, 3.0526);
  CHECK(before == EndReason::special_point);
  CHECK(stopped.back().special.type == PointType::user);
  CHECK(stopped.back().orbit.par(0) == Approx(3.0525).epsilon(1e-9));
  const auto [at, on_bound] = last_points({3.0526}, 3.0526);
  CHECK(at == EndReason::special_point);
  CHECK(on_bound.back().special.type == PointType::user);
  const auto [beyond, ended] = last_points({3.0527}, 3.0526);
  CHECK(beyond == EndReason::beyond_bound);
  CHECK(ended.back().special.type == PointType::end);
  CHECK(ended.back().orbit.par(0) > 3.0526);
  for (const KeptPoint& p : ended) CHECK(p.special.type != PointType::user);
}

TEST_CASE("a stop condition, a user value that stops, an interruption") {
  Branch stopped;
  stopped.tests.push_back(std::make_unique<UserValueTest>(1, 3.05, false, "alpha"));
  stopped.tests.push_back(std::make_unique<UserValueTest>(1, 3.055, true, "alpha"));
  stopped.settings.max_points = 100;
  CHECK(stopped.run().reason == EndReason::special_point);
  REQUIRE(stopped.labelled().size() == 3);
  const KeptPoint& first = stopped.sink.points[static_cast<std::size_t>(stopped.labelled()[1] - 1)];
  CHECK(first.special.type == PointType::user);
  CHECK(first.orbit.par(0) == Approx(3.05).epsilon(1e-7));
  CHECK(stopped.sink.points.back().orbit.par(0) == Approx(3.055).epsilon(1e-7));

  Branch counted;
  counted.tests.push_back(std::make_unique<UserValueTest>(1, 3.05, false, "alpha"));
  counted.settings.stop_at = [](const SpecialPoint& special) { return special.type == PointType::user; };
  CHECK(counted.run().reason == EndReason::special_point);

  Branch interrupted;
  interrupted.settings.interrupted = [&] { return interrupted.sink.points.size() >= 4; };
  const BranchSummary summary = interrupted.run();
  CHECK(summary.reason == EndReason::interrupted);
  CHECK(summary.points == 5);
  CHECK(interrupted.sink.points.back().special.type == PointType::end);
}

TEST_CASE("two user values within one step are both found, in the order of the branch") {
  Branch branch;
  branch.settings.step.initial = 0.2;
  branch.tests.push_back(std::make_unique<UserValueTest>(1, 3.0530, false, "alpha"));
  branch.tests.push_back(std::make_unique<UserValueTest>(1, 3.0525, false, "alpha"));
  branch.run();
  std::vector<double> found;
  for (const KeptPoint& p : branch.sink.points)
    if (p.special.type == PointType::user) found.push_back(p.orbit.par(0));
  REQUIRE(found.size() == 2);
  CHECK(found[0] == Approx(3.0525).epsilon(1e-8));
  CHECK(found[1] == Approx(3.0530).epsilon(1e-8));
}

TEST_CASE("no convergence ends a branch with MX and says what was tried") {
  Branch branch;
  branch.settings.step.initial = 0.05;
  branch.settings.step.maximum = 1e6;
  branch.settings.step.adapt_every = 0;
  branch.settings.step.initial = 1e5;  // no orbit of this signature is anywhere near
  const BranchSummary summary = branch.run();
  CHECK(summary.reason == EndReason::first_step_failed);
  CHECK_FALSE(summary.detail.empty());
  CHECK(branch.sink.points.back().special.type == PointType::no_convergence);
  REQUIRE_FALSE(branch.sink.notes.empty());
  CHECK_THAT(branch.sink.notes.back(), Contains("fixed step size"));
}

TEST_CASE("MX is the last point as it was accepted: its mesh, its multipliers, its test values") {
  const OrbitShape shape{3, 1, 10, 4};
  PeriodicOrbits orbits(system_of<Breakable>(), {{1, 1, 1}}, 1, shape);
  Breakable::broken = false;
  const PathPoint start = orbits.corrected(NormalForms::orbit(pi, 0.0, -0.3, 9.0, 10));
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(shape, 1, 0.02, 0.05, 40);
  settings.adapt_mesh_every = 1;
  std::vector<std::unique_ptr<TestFunction>> tests;
  tests.push_back(std::make_unique<Breaking>());
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, std::move(tests), sink);
  REQUIRE(run.run(start).reason == EndReason::no_convergence);
  REQUIRE(sink.points.size() > 4);
  const KeptPoint& end = sink.points.back();
  const KeptPoint& last = sink.points[sink.points.size() - 2];
  CHECK(end.special.type == PointType::no_convergence);
  CHECK(end.orbit.mesh == last.orbit.mesh);
  CHECK(end.orbit.states == last.orbit.states);
  CHECK(end.multipliers.values == last.multipliers.values);
  CHECK(end.tests.front().value == 1.0);
  // That of z at z = 0, to the accuracy of the mesh.
  double nearest = 1.0;
  for (const auto& mu : end.multipliers.values)
    nearest = std::min(nearest, std::abs(mu - std::exp(2 * pi * end.orbit.par(0))));
  CHECK(nearest < 1e-6);
}

TEST_CASE("where the mesh resolves no further orbit, the last point is written again as it was accepted") {
  const auto followed = [](double bound) {
    Branch branch;
    branch.settings.step.initial = -0.05;
    branch.settings.adapt_mesh_every = 1;
    branch.settings.error_bound = bound;
    branch.run();
    return branch.sink.points;
  };
  const std::vector<KeptPoint> all = followed(0.0);
  std::size_t k = 3;  // the first orbit with a larger error than all before
  double before = 0.0;
  for (std::size_t i = 0; i < k; ++i) before = std::max(before, all[i].estimated_error);
  while (k < all.size() && all[k].estimated_error <= before) ++k;
  REQUIRE(k < all.size());

  const std::vector<KeptPoint> points = followed(0.5 * (before + all[k].estimated_error));
  REQUIRE(points.size() == k + 1);
  const KeptPoint& end = points.back();
  const KeptPoint& last = points[k - 1];
  CHECK(end.special.type == PointType::end);
  CHECK(end.number == last.number + 1);
  CHECK(end.orbit.mesh == last.orbit.mesh);
  CHECK(end.orbit.states == last.orbit.states);
  CHECK(end.multipliers.values == last.multipliers.values);
}

TEST_CASE("what a step has passed is reported with the parameter at both of its ends") {
  Branch branch;
  branch.settings.adapt_mesh_every = 1;
  branch.tests.push_back(std::make_unique<OnlyReported>());
  branch.run();
  REQUIRE(branch.sink.passed_points.size() == 1);
  const LostPoint& passed = branch.sink.passed_points.front();
  const auto parameter = [&](int number) {
    return branch.sink.points.at(static_cast<std::size_t>(number - 1)).orbit.par(0);
  };
  CHECK(passed.from == parameter(passed.number - 1));
  CHECK(passed.to == parameter(passed.number));
  CHECK((passed.from - 3.05) * (passed.to - 3.05) < 0.0);
}

TEST_CASE("with clip a branch ends on its bounds") {
  const auto ended = [](const std::function<void(ContinuationSettings&)>& change,
                        std::vector<std::unique_ptr<TestFunction>> tests = {}) {
    Branch branch;
    branch.settings.clip = true;
    branch.settings.step.initial = branch.settings.step.maximum = 0.4;
    branch.settings.max_points = 60;
    branch.tests = std::move(tests);
    change(branch.settings);
    const BranchSummary summary = branch.run();
    return std::pair{summary, branch.sink.points.back()};
  };
  const auto [above, last] = ended([](ContinuationSettings& s) { s.parameter_max = 3.06; });
  CHECK(above.reason == EndReason::on_bound);
  CHECK_THAT(above.detail, Contains("RL1"));
  CHECK(last.special.type == PointType::end);
  CHECK(last.orbit.par(0) == Approx(3.06).epsilon(1e-10));
  const auto [measure, at_measure] = ended([](ContinuationSettings& s) {
    s.measure = 2;  // max x2
    s.measure_max = 2.4;
  });
  CHECK(measure.reason == EndReason::on_bound);
  CHECK(maximum_of(at_measure.orbit, 2) == Approx(2.4).epsilon(1e-8));
  // A user value on the bound keeps its name, and the branch ends there.
  std::vector<std::unique_ptr<TestFunction>> tests;
  tests.push_back(std::make_unique<UserValueTest>(1, 3.06, false, "alpha"));
  const auto [both, user] = ended([](ContinuationSettings& s) { s.parameter_max = 3.06; }, std::move(tests));
  CHECK(both.reason == EndReason::special_point);
  CHECK(user.special.type == PointType::user);
  CHECK(user.orbit.par(0) == Approx(3.06).epsilon(1e-10));
}

TEST_CASE("the summary counts unstable and inadmissible points") {
  Branch branch;
  branch.settings.step.initial = -0.05;
  branch.settings.monitored = {{1}};
  branch.settings.max_points = 30;
  const BranchSummary summary = branch.run();
  int unstable = 0, inadmissible = 0;
  for (const KeptPoint& p : branch.sink.points) {
    const double v = p.orbit.end(0)[1];
    unstable += !p.multipliers.stable();
    inadmissible += v < -1e-9;
  }
  CHECK(summary.unstable_points == unstable);
  CHECK(summary.inadmissible_points == inadmissible);
  CHECK(inadmissible > 0);
  CHECK(unstable > 0);
  CHECK(summary.worst_structural < 1e-6);
}
