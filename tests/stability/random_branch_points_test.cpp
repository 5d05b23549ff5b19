// 200 random linear and weakly nonlinear systems in 2 to 8 dimensions, along branches on which the period changes up to
// twentyfold and the determinant of the boundary value problem by hundreds of decades: every branch point is found, and
// nothing else is taken for one, in both directions, on meshes of 10 to 400 intervals.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "random_forms.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr int systems = 200;

/// `hybrid` shows the form.
void follow(const HybridSystem& hybrid, const RandomForm& form, int number, int intervals, double direction) {
  CAPTURE(number, form.n, intervals, direction, form.branch_points, form.epsilon, form.kappa, form.pitchfork);
  const double from = direction > 0.0 ? form.least_mu : form.most_mu;
  const Orbit start = form.orbit(from, intervals, 4);
  const PeriodicOrbitSystem system(hybrid, {{1, 1, 1}}, {1});
  ParameterVector weights{ParameterLayout()};
  weights(0) = 1.0;
  PathFollower follower(system, start.shape, WeightedNorm(Eigen::VectorXd::Ones(form.n), weights), tight_newton(), 1);
  PathPoint point = follower.make_point(start);
  const bool started = follower.start_at_fixed_parameter(point).converged();
  CHECK(started);
  if (!started) return;
  ContinuationSettings settings = branch_settings(start.shape, 1, 0.05 * direction, 0.4, 300);
  settings.step.max_newton = 12;
  settings.parameter_min = form.least_mu;
  settings.parameter_max = form.most_mu;
  settings.multipliers = false;
  settings.adapt_mesh_every = 3;
  Tests tests;
  tests.push_back(std::make_unique<FoldTest>(1, system.free_parameters(), ParameterLayout(), 1, false));
  tests.push_back(std::make_unique<BranchPointTest>(false));
  const RecordedBranch branch = record(follower, system, point, settings, std::move(tests));
  CAPTURE(branch.notes);
  CHECK(branch.summary.reason == EndReason::beyond_bound);

  std::vector<double> expected = form.branch_points;
  if (direction < 0.0) std::reverse(expected.begin(), expected.end());
  std::vector<double> found;
  for (const RecordedPoint* p : branch.special()) {
    CHECK(p->special.type == PointType::branch_point);
    found.push_back(p->orbit.par(0));
  }
  CAPTURE(found);
  CHECK(found.size() == expected.size());
  if (found.size() != expected.size()) return;
  const double accuracy = intervals < 20 ? 1e-2 : intervals < 50 ? 1e-4 : 1e-6;
  for (std::size_t k = 0; k < found.size(); ++k) CHECK(std::abs(found[k] - expected[k]) < accuracy);
}

/// Those systems whose number leaves `first` when divided by `every`.
template <int N>
void follow_systems(int intervals, int every, int first) {
  std::mt19937 random(1000 + N);
  for (int number = 0; number < systems; ++number) {
    if (2 + number % 7 != N) continue;
    const RandomForm form(N, random, number);
    if (number % every != first) continue;
    RandomSystem<N>::form = &form;
    for (const double direction : {1.0, -1.0}) follow(system_of<RandomSystem<N>>(), form, number, intervals, direction);
  }
}

void follow_all(int intervals, int every = 1, int first = 0) {
  follow_systems<2>(intervals, every, first);
  follow_systems<3>(intervals, every, first);
  follow_systems<4>(intervals, every, first);
  follow_systems<5>(intervals, every, first);
  follow_systems<6>(intervals, every, first);
  follow_systems<7>(intervals, every, first);
  follow_systems<8>(intervals, every, first);
}

}  // namespace

TEST_CASE("random branch points: systems in both directions on coarse meshes", "[slow]") {
  follow_all(10, std::getenv("TCHAT_ALL_TESTS") != nullptr ? 1 : 3);  // a third of them but for scripts/test --all
  follow_all(20, 4, 1);
}

TEST_CASE("random branch points: some of the systems on fine meshes", "[slow]") {
  follow_all(50, 40, 3);
  follow_all(100, 100, 7);
  if (std::getenv("TCHAT_ALL_TESTS") != nullptr) follow_all(400, 100, 11);
}

// The whole matrix takes an hour: test_special_points '[every mesh]'.
TEST_CASE("random branch points: 200 systems on every mesh", "[.][every mesh]") {
  const int intervals = GENERATE(10, 20, 30, 50, 100, 200, 400);
  follow_all(intervals);
}
