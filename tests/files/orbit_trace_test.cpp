// Labels as lines in physical time, and how they are drawn.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "files/orbit_trace.hpp"
#include "model/parameter_vector.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;

namespace {

/// A ball with g = 1 that is thrown up with velocity 1, caught after a time of 2 and held for 1/2: (height, velocity);
/// the velocity jumps twice.
LabelledSolution ball() {
  LabelledSolution label;
  label.label = 4;
  label.dimension = 2;
  label.tau = {0.0, 0.5, 1.0};
  label.states.resize(4, 3);
  label.states << 0.0, 0.5, 0.0,  //
      1.0, 0.0, -1.0,             //
      0.0, 0.0, 0.0,              //
      0.0, 0.0, 0.0;
  label.parameters.assign(100, 0.0);
  label.parameters[0] = 1.0;
  label.parameters[ParameterLayout().first_duration() - 1] = 2.0;
  label.parameters[ParameterLayout().first_duration()] = 0.5;
  label.free_parameters = {1, ParameterLayout().first_duration(), ParameterLayout().first_duration() + 1};
  return label;
}

DiagnosticPoint point_with(std::complex<double> multiplier) {
  DiagnosticPoint point;
  point.multipliers = {1.0, multiplier};
  return point;
}

}  // namespace

TEST_CASE("segments follow each other in time") {
  const OrbitTrace trace = orbit_trace(ball(), "UZ1", 0, "q.ball");
  REQUIRE(trace.segments.size() == 2);
  CHECK(trace.segments[0].times == std::vector<double>{0.0, 1.0, 2.0});
  CHECK(trace.segments[1].times == std::vector<double>{2.0, 2.25, 2.5});
  CHECK(trace.period() == 2.5);
  CHECK(trace.dimension() == 2);
  CHECK(trace.segments[0].states(0, 1) == 0.5);
  CHECK(trace.free_parameters == std::vector<std::pair<int, double>>{{1, 1.0}});
}

TEST_CASE("states jump where their values differ, each by its own size") {
  OrbitTrace trace = orbit_trace(ball(), "UZ1", 0, "q.ball");
  CHECK(trace.jumps_after(0));
  CHECK_FALSE(trace.jumps_after(0, 0));
  CHECK(trace.jumps_after(0, 1));
  CHECK(trace.jumps_after(1));
  trace.is_closed = false;
  CHECK_FALSE(trace.jumps_after(1));  // nothing follows
  trace.segments[1].states(0, 0) = 1e-8;
  CHECK_FALSE(trace.jumps_after(0, 0));
  trace.segments[1].states(0, 0) = 1e-6;
  CHECK(trace.jumps_after(0, 0));  // two millionths of the height
}

TEST_CASE("files that do not say how many states a segment has need the dimension") {
  LabelledSolution label = ball();
  label.dimension = 0;
  label.free_parameters = {1};  // durations would tell
  CHECK_THROWS_AS(orbit_trace(label, "UZ1", 0, "q.ball"), UserError);
  CHECK_THROWS_AS(orbit_trace(label, "UZ1", 3, "q.ball"), UserError);
  CHECK(orbit_trace(label, "UZ1", 2, "q.ball").segments.size() == 2);
  label.tau = {0.0};
  CHECK_THROWS_WITH(orbit_trace(label, "UZ1", 2, "q.ball"), Catch::Contains("is an equilibrium"));
}

TEST_CASE("orbits of AUTO last PAR(11)") {
  LabelledSolution label = ball();
  label.problem_type = 2;
  label.parameters.resize(36);
  label.parameters[10] = 7.0;
  CHECK(orbit_trace(label, "UZ1", 4, "q.ball").period() == 7.0);
}

TEST_CASE("a multiplier outside the unit circle by more than 1e-4 makes an orbit unstable") {
  CHECK(line_kind(point_with({0.0, 1.00005})) == LineKind::stable);
  CHECK(line_kind(point_with({0.0, -1.0002})) == LineKind::unstable);
  DiagnosticPoint inadmissible = point_with(-3.0);
  inadmissible.admissible = false;
  CHECK(line_kind(inadmissible) == LineKind::inadmissible);
}

TEST_CASE("a solution file alone says nothing of stability") {
  const test_support::TemporaryFolder folder;
  CHECK(label_kinds(folder.write("q.x", "")).empty());
}
