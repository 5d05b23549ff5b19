// What each family decides of constants and labels, asked as the other rooms ask it.
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "files/solution_file.hpp"
#include "orbit/orbit.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using namespace test_support;

namespace {

/// Three states on segments from event to event.
RunSettings settings_of(const ProblemId& id, std::size_t segments) {
  RunSettings settings;
  settings.problem_type = id.number;
  settings.branch_mode = id.branch_mode;
  settings.dimension = 3;
  settings.segments.assign(segments, {1, {1, 1, 1}, {}});
  settings.free_parameters = {1};
  return settings;
}

/// So many states at each of `times` times.
LabelledSolution label_of(const ProblemId& id, Eigen::Index states, std::size_t times) {
  LabelledSolution label;
  label.problem_type = id.number;
  label.label = 7;
  label.tau.assign(times, 0.0);
  label.states = Eigen::MatrixXd::Zero(states, static_cast<Eigen::Index>(times));
  return label;
}

int restart_segments(const RunSettings& settings, const LabelledSolution& label) {
  return family_of(settings).restart_shape(settings, label, "q.x").segments;
}

}  // namespace

TEST_CASE("an IPS has one family, and numbers that are not tchat's have that of periodic orbits") {
  CHECK(&family_of(150) == &family_of(180));
  CHECK(&family_of(152) == &family_of(182));
  CHECK(&family_of(2) == &family_of(180));  // of AUTO
  for (const ProblemType* type : problem_types()) CHECK(&type->family() == &family_of(type->facts().number));
}

TEST_CASE("a torus restarts with as many orbits as its label has, from no other label") {
  const RunSettings torus = settings_of(invariant_torus, 2);
  CHECK(restart_segments(torus, label_of(invariant_torus, 3 * 2 * 5, 81)) == 10);
  CHECK(restart_segments(torus, label_of({0, 1}, 3 * 2 * 5, 81)) == 10);  // a file that does not know
  for (const Eigen::Index orbits : {1, 4})
    CHECK_THROWS_AS(restart_segments(torus, label_of(invariant_torus, 3 * 2 * orbits, 81)), UserError);
  CHECK_THROWS_AS(restart_segments(torus, label_of(periodic_orbit, 3 * 2 * 5, 81)), UserError);
  CHECK(restart_segments(settings_of(torus_birth, 2), label_of(periodic_orbit, 6, 81)) == 2);
}

TEST_CASE("only tori restart from tori") {
  const LabelledSolution torus = label_of(invariant_torus, 15, 81);
  const SolutionFamily& family = family_of(torus.problem_type);
  CHECK_NOTHROW(family.check_restart(torus, settings_of(grazing_torus, 1), "q.x"));
  const std::string message =
      message_of<UserError>([&] { family.check_restart(torus, settings_of(periodic_orbit, 5), "q.x"); });
  CHECK_THAT(message, Catch::Contains("label 7 is a torus (IPS = 182)") && Catch::Contains("IPS = 180"));
}

TEST_CASE("a switch at a label that is one state starts from an equilibrium") {
  const LabelledSolution state = label_of(equilibrium, 3, 1);
  const RunSettings switching = settings_of(branch_switch, 1);
  CHECK(family_of(switching).restart_shape(switching, state, "q.x") == OrbitShape::point(3));
  const RunSettings going_on = settings_of(periodic_orbit, 1);
  CHECK(family_of(going_on).restart_shape(going_on, state, "q.x").intervals == going_on.mesh_intervals);
  const RunSettings equilibria = settings_of(equilibrium, 1);
  CHECK(family_of(equilibria).shape(equilibria) == OrbitShape::point(3));
}

TEST_CASE("a label that is no solution of the constants is told apart by its states and its IPS") {
  const RunSettings ring = settings_of(periodic_orbit, 2);
  CHECK(family_of(ring).mismatch(label_of(periodic_orbit, 6, 81), ring) == "");
  CHECK_THAT(family_of(ring).mismatch(label_of(periodic_orbit, 9, 81), ring), Catch::Contains("has 9 states"));
  CHECK_THAT(family_of(ring).mismatch(label_of(boundary_value, 6, 81), ring), Catch::Contains("IPS = 4"));
  const RunSettings torus = settings_of(invariant_torus, 2);
  CHECK(family_of(torus).mismatch(label_of(invariant_torus, 18, 81), torus) == "");
  CHECK_THAT(family_of(torus).mismatch(label_of(invariant_torus, 24, 81), torus), Catch::Contains("no odd number"));
}

TEST_CASE("each analysis says of which labels it cannot be made") {
  for (const Analysis analysis : {Analysis::grazing, Analysis::resegmentation, Analysis::composite_map}) {
    CHECK(family_of(180).why_not(analysis, "q.x:1") == "");
    CHECK(family_of(1).why_not(analysis, "q.x:1") != "");
    CHECK(family_of(4).why_not(analysis, "q.x:1") != "");
  }
  CHECK_THAT(family_of(182).why_not(Analysis::grazing, "q.x:1"), Catch::Contains("tchat sweep --map q.x:1"));
  CHECK(family_of(182).why_not(Analysis::composite_map, "q.x:1") == "");
}

TEST_CASE("the numbers of point types are read back as their letters, on every curve") {
  for (const PointTypeFacts& row : point_types()) {
    CAPTURE(row.name, row.number, row.kind);
    CHECK(type_name(row.number, {row.kind}) == row.name);
    REQUIRE(find_point_type(row.name) != nullptr);
    if (!row.is_whole && row.number != 4)
      for (const int curve : {5, 7, 8}) {
        const int number = file_type(static_cast<PointType>(row.number), curve);
        const int on_curve = row.number < 0 ? row.number - 10 * curve : row.number + 10 * curve;
        const auto is_code = [=](const PointTypeFacts& other) { return other.is_whole && other.number == on_curve; };
        const bool is_taken = std::any_of(point_types().begin(), point_types().end(), is_code);  // by AUTO's own codes
        CHECK(type_name(number, {row.kind}) == (is_taken ? "EP" : row.name));
      }
  }
  CHECK(type_name(0) == "");
  CHECK(find_point_type("QQ") == nullptr);
}
