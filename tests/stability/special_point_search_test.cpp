// The search for special points, with test functions that are known functions of the parameter. On the branch z = 0 of
// the pitchfork the orbit stays the same, so that arclength is the change of the parameter.
#include "continuation/special_point_search.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "normal_forms.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Function = std::function<std::optional<double>(double)>;

class FunctionOfParameter final : public TestFunction {
 public:
  FunctionOfParameter(std::string name, Function function, Resolution resolution)
      : name_(std::move(name)), function_(std::move(function)), resolution_(resolution) {}
  std::string name() const override { return name_; }
  TestValue evaluate(const TestedPoint& point) const override {
    const std::optional<double> value = function_(point.orbit.par(0));
    return value ? TestValue::of(*value, 1e-9) : TestValue::undefined();
  }
  Resolution resolution() const override { return resolution_; }
  SpecialPoint classify(const TestedPoint&, bool rising) const override {
    return {PointType::user, {UserPointKind::contact, 1, 1, 0.5}, false, name_ + (rising ? " rising" : " falling")};
  }

 private:
  std::string name_;
  Function function_;
  Resolution resolution_;
};

struct Named {
  std::string name;
  Function function;
  Resolution resolution = Resolution::crossings;
};

/// From mu = `from` in steps of at most 0.1 for `points` points.
RecordedBranch searched(double from, double ds, int points, const std::vector<Named>& functions, int most_trials = 20) {
  const Orbit start = NormalForms::orbit(pi, 0.0, from, 0.0, 10);
  PeriodicOrbits orbits(system_of<NormalForms>(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, ds, std::abs(ds), points);
  settings.location_tolerance = 1e-10;
  settings.max_location = most_trials;
  settings.multipliers = false;
  Tests tests;
  for (const Named& f : functions)
    tests.push_back(std::make_unique<FunctionOfParameter>(f.name, f.function, f.resolution));
  return record(orbits.follower, orbits.system, point, settings, std::move(tests));
}

std::vector<double> labelled(const RecordedBranch& branch) {
  std::vector<double> result;
  for (const RecordedPoint* p : branch.special()) result.push_back(p->orbit.par(0));
  return result;
}

void check_labels(const RecordedBranch& branch, const std::vector<double>& expected) {
  const std::vector<double> found = labelled(branch);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-8));
}

}  // namespace

TEST_CASE("search: zeros in both directions, rising and falling, in the order of the branch") {
  for (const double direction : {1.0, -1.0}) {
    CAPTURE(direction);
    const auto first = [=](double p) { return direction * p - 0.234; };
    const auto second = [=](double p) { return 0.271 - direction * p; };  // within the same step
    const auto third = [=](double p) { return std::cos(5 * p); };
    const RecordedBranch branch =
        searched(0.0, 0.1 * direction, 9, {{"second", second}, {"first", first}, {"third", third}});
    check_labels(branch, {0.234 * direction, 0.271 * direction, pi / 10 * direction});
    REQUIRE(branch.special().size() == 3);
    CHECK(branch.special()[0]->special.description == "first rising");
    CHECK(branch.special()[1]->special.description == "second falling");
    CHECK(branch.special()[2]->special.description == "third falling");
  }
}

TEST_CASE("search: functions that vanish together get one label") {
  const auto a = [](double p) { return p - 0.25; };
  const auto b = [](double p) { return std::expm1(3 * (0.25 - p)); };
  const auto other = [](double p) { return p - 0.36; };
  const RecordedBranch branch = searched(0.0, 0.1, 8, {{"a", a}, {"b", b}, {"other", other}});
  check_labels(branch, {0.25, 0.36});
  REQUIRE(!branch.special().empty());
  CHECK(branch.special()[0]->special.description == "a rising; b falling");
  CHECK(branch.special()[0]->special.further.size() == 1);
}

TEST_CASE("search: a start at a zero is noted and raises no alarm") {
  const RecordedBranch simple = searched(0.2, 0.1, 5, {{"f", [](double p) { return p - 0.2; }}});
  check_labels(simple, {});
  CHECK(simple.notes == std::vector<std::string>{"The run starts at a zero of f: no label of its own"});
  // Another zero of the same function further on is found.
  const RecordedBranch twice = searched(0.2, 0.1, 6, {{"f", [](double p) { return (p - 0.2) * (p - 0.45); }}});
  check_labels(twice, {0.45});
  // Not exactly at it: within the level that counts as zero, on the wrong side.
  const RecordedBranch beside = searched(0.2, 0.1, 5, {{"f", [](double p) { return p - 0.2 - 5e-10; }}});
  check_labels(beside, {});
}

TEST_CASE("search: a zero at an accepted point gets one label") {
  const RecordedBranch branch = searched(0.0, 0.125, 6, {{"f", [](double p) { return p - 0.25; }}});
  check_labels(branch, {0.25});
}

TEST_CASE("search: a touch without a change of sign gets no label") {
  // The points of the branch lie at the zero itself, and so near that the value counts as zero.
  const auto touches = [](double at) { return [=](double p) { return 1e-3 * (p - at) * (p - at); }; };
  const RecordedBranch branch =
      searched(0.0, 0.125, 8, {{"at a point", touches(0.25)}, {"beside one", touches(0.5004)}});
  check_labels(branch, {});
  CHECK(branch.notes.empty());
}

TEST_CASE("search: a flat zero is located, not met where its function has become small") {
  const auto flat = [](double at) { return [=](double p) { return 1e-2 * (p - at) * std::abs(p - at); }; };
  for (const double zero : {0.25, 0.2501, 0.2499})
    check_labels(searched(0.0, 0.125, 6, {{"flat", flat(zero)}}), {zero});
}

TEST_CASE("search: zeros a little before and behind the end of a step") {
  for (const double distance : {1e-10, 1e-9, 3e-9, 1e-8, 3e-8, -1e-10, -1e-9, -1e-8})
    for (const double slope : {1.0, -0.3, 7.0}) {
      CAPTURE(distance, slope);
      const double zero = 0.25 - distance;
      const RecordedBranch branch = searched(0.0, 0.125, 6, {{"f", [=](double p) { return slope * (p - zero); }}});
      check_labels(branch, {zero});
      CHECK(branch.notes.empty());
    }
}

TEST_CASE("search: two zeros on both sides of the first one that the step shows") {
  // `pair` has the same sign at both ends of the step and the other one in between.
  const auto pair = [](double p) { return (p - 0.223) * (p - 0.251); };
  const auto middle = [](double p) { return p - 0.236; };
  const auto last = [](double p) { return 0.262 - p; };
  for (const double ds : {0.1, 0.3}) {
    const RecordedBranch branch = searched(0.0, ds, 9, {{"last", last}, {"middle", middle}, {"pair", pair}});
    check_labels(branch, {0.223, 0.236, 0.251, 0.262});
  }
}

TEST_CASE("search: what a cut step has shown is found on the rest of it") {
  // After the first zero the branch would go farther than the step went, past both zeros of `pair`.
  const auto first = [](double p) { return p - 0.201; };
  const auto pair = [](double p) { return (p - 0.29) * (p - 0.305); };
  const RecordedBranch branch = searched(0.0, 0.1, 9, {{"first", first}, {"pair", pair}});
  check_labels(branch, {0.201, 0.29, 0.305});
}

TEST_CASE("search: few trials are repeated on smaller steps until the zero is found") {
  const auto steep = [](double p) { return std::atan(1e4 * (p - 0.234)); };
  const auto flat = [](double p) { return std::pow(p - 0.567, 3); };
  const RecordedBranch branch = searched(0.0, 0.1, 9, {{"steep", steep}, {"flat", flat}}, 3);
  check_labels(branch, {0.234, 0.567});
  CHECK(branch.notes.empty());
}

TEST_CASE("search: what vanishes at a branch point keeps its kind") {
  const Orbit start = NormalForms::orbit(pi, 0.0, -0.23, 0.0, 10);
  PeriodicOrbits orbits(system_of<NormalForms>(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, 0.1, 0.1, 6);
  settings.location_tolerance = 1e-9;
  Tests tests;
  tests.push_back(std::make_unique<FunctionOfParameter>(
      "contact", [](double p) { return p; }, Resolution::crossings));
  tests.push_back(std::make_unique<BranchPointTest>(false));
  const RecordedBranch branch = record(orbits.follower, orbits.system, point, settings, std::move(tests));
  check_labels(branch, {0.0});
  REQUIRE(!branch.special().empty());
  const SpecialPoint& special = branch.special()[0]->special;
  CHECK(special.type == PointType::branch_point);
  REQUIRE(special.further.size() == 1);
  CHECK(special.further[0] == UserPointKind{UserPointKind::contact, 1, 1, 0.5});
}

TEST_CASE("search: a change of sign whose zero cannot be located is told, with its place") {
  const auto gap = [](double p) -> std::optional<double> {
    if (p > 0.23 && p < 0.24) return std::nullopt;
    return p - 0.2371;
  };
  const RecordedBranch branch = searched(0.0, 0.1, 6, {{"gap", gap}});
  check_labels(branch, {});
  REQUIRE(branch.summary.lost.size() == 1);
  CHECK(branch.summary.lost[0].from <= 0.23);
  CHECK(branch.summary.lost[0].to >= 0.24);
  CHECK(branch.summary.lost[0].text.find("gap") != std::string::npos);
  CHECK(branch.notes == std::vector<std::string>{branch.summary.lost[0].text});
}

TEST_CASE("search: a jump through zero is no zero, and the search goes on after it") {
  const auto jumping = [](double p) { return p < 0.23 ? -1.0 : 0.54 - p; };
  const RecordedBranch branch = searched(0.0, 0.1, 10, {{"f", jumping}});
  check_labels(branch, {0.54});
  REQUIRE(branch.notes.size() == 1);
  CHECK(branch.notes[0].find("jump") != std::string::npos);
  CHECK(branch.summary.lost.empty());
}

TEST_CASE("search: a pole is no zero") {
  const RecordedBranch branch = searched(0.0, 0.1, 8, {{"f", [](double p) { return 1 / (p - 0.2371); }}});
  check_labels(branch, {});
}

TEST_CASE("search: undefined values change no sign, and what was the sign before is remembered") {
  const auto gap = [](double p) -> std::optional<double> {
    if (p > 0.15 && p < 0.35) return std::nullopt;
    return p - 0.42;
  };
  check_labels(searched(0.0, 0.1, 8, {{"f", gap}}), {0.42});
  const auto vanishing = [](double p) -> std::optional<double> {
    if (p > 0.15) return std::nullopt;
    return 0.16 - p;
  };
  const RecordedBranch branch = searched(0.0, 0.1, 8, {{"f", vanishing}});
  check_labels(branch, {});
  CHECK(branch.notes.empty());
  const auto no_number = [&](double p) -> std::optional<double> { return gap(p).value_or(NAN); };
  check_labels(searched(0.0, 0.1, 8, {{"f", no_number}}), {0.42});
}

TEST_CASE("search: two zeros within a step, where the last values tell of them") {
  const auto parabola = [](double p) { return (p - 0.531) * (p - 0.571); };
  check_labels(searched(0.0, 0.1, 60, {{"parabola", parabola}}), {0.531, 0.571});
  const auto inverted = [](double p) { return -(p + 0.531) * (p + 0.571) * (2 + p); };
  check_labels(searched(0.0, -0.1, 12, {{"inverted", inverted}}), {-0.531, -0.571});
  // None where it comes near to zero and turns: steps stay as they are.
  const auto above = [](double p) { return (p - 0.55) * (p - 0.55) + 1e-4; };
  const RecordedBranch branch = searched(0.0, 0.1, 11, {{"above", above}});
  check_labels(branch, {});
  CHECK(branch.points.back().orbit.par(0) == Approx(1.0).margin(1e-9));
}

TEST_CASE("search: two zeros of an oscillating function within a step") {
  // A narrow dip out of a flat run, and the bottom of a parabola, which goes on exactly as it began.
  const auto dip = [](double p) { return 1 - 1.2 * std::exp(-std::pow((p - 0.62) / 0.12, 2)); };
  const double half_width = 0.12 * std::sqrt(std::log(1.2));
  check_labels(searched(0.0, 0.1, 60, {{"dip", dip, Resolution::trend}}), {0.62 - half_width, 0.62 + half_width});
  const auto parabola = [](double p) { return (p - 0.531) * (p - 0.571); };
  check_labels(searched(0.0, 0.1, 60, {{"parabola", parabola, Resolution::trend}}), {0.531, 0.571});
  const auto inverted = [](double p) { return -(p + 0.531) * (p + 0.571); };
  check_labels(searched(0.0, -0.1, 60, {{"inverted", inverted, Resolution::trend}}), {-0.531, -0.571});
  const auto wave = [](double p) { return std::sin(40 * (p + 0.013)); };
  std::vector<double> zeros;
  for (int k = 1; k * pi / 40 - 0.013 < 1.0; ++k) zeros.push_back(k * pi / 40 - 0.013);
  const RecordedBranch branch = searched(0.0, 0.1, 200, {{"wave", wave, Resolution::trend}});
  std::vector<double> found = labelled(branch);
  REQUIRE(found.size() >= zeros.size());
  for (std::size_t i = 0; i < zeros.size(); ++i) CHECK(found[i] == Approx(zeros[i]).margin(1e-8));
}
