// The search for special points, with test functions that are known functions of the parameter. On the branch z = 0 of
// the pitchfork the orbit stays the same, so that arclength is the change of the parameter.
#include "continuation/special_point_search.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "normal_forms.hpp"
#include "recorded_branch.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Function = std::function<std::optional<double>(double)>;

class FunctionOfParameter final : public TestFunction {
 public:
  FunctionOfParameter(std::string name, Function function, bool oscillates)
      : name_(std::move(name)), function_(std::move(function)), oscillates_(oscillates) {}
  std::string name() const override { return name_; }
  std::optional<double> value(const TestedPoint& point) const override { return function_(point.orbit.par(0)); }
  double zero_level(const TestedPoint&) const override { return 1e-9; }
  bool oscillates() const override { return oscillates_; }
  SpecialPoint classify(const TestedPoint&, bool rising) const override {
    return {PointType::user, {}, false, name_ + (rising ? " rising" : " falling")};
  }

 private:
  std::string name_;
  Function function_;
  bool oscillates_;
};

struct Named {
  std::string name;
  Function function;
  bool oscillates = false;
};

/// From mu = `from` in steps of at most 0.1 for `points` points.
RecordedBranch searched(double from, double ds, int points, const std::vector<Named>& functions) {
  const Orbit start = NormalForms::orbit(pi, 0.0, from, 0.0, 10);
  PeriodicOrbits orbits(system_of<NormalForms>(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, ds, std::abs(ds), points);
  settings.location_tolerance = 1e-10;
  settings.max_location = 20;
  settings.multipliers = false;
  Tests tests;
  for (const Named& f : functions)
    tests.push_back(std::make_unique<FunctionOfParameter>(f.name, f.function, f.oscillates));
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
}

TEST_CASE("search: a start at a zero raises no alarm") {
  const RecordedBranch simple = searched(0.2, 0.1, 5, {{"f", [](double p) { return p - 0.2; }}});
  check_labels(simple, {});
  CHECK(simple.notes.empty());
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

TEST_CASE("search: a jump through zero is no zero, and the search goes on after it") {
  const auto jumping = [](double p) { return p < 0.23 ? -1.0 : 0.54 - p; };
  const RecordedBranch branch = searched(0.0, 0.1, 10, {{"f", jumping}});
  check_labels(branch, {0.54});
  REQUIRE(branch.notes.size() == 1);
  CHECK(branch.notes[0].find("Possible special point") != std::string::npos);
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
}

TEST_CASE("search: two zeros of an oscillating function within a step") {
  // A narrow dip out of a flat run, and the bottom of a parabola, which goes on exactly as it began.
  const auto dip = [](double p) { return 1 - 1.2 * std::exp(-std::pow((p - 0.62) / 0.12, 2)); };
  const double half_width = 0.12 * std::sqrt(std::log(1.2));
  check_labels(searched(0.0, 0.1, 60, {{"dip", dip, true}}), {0.62 - half_width, 0.62 + half_width});
  const auto parabola = [](double p) { return (p - 0.531) * (p - 0.571); };
  check_labels(searched(0.0, 0.1, 60, {{"parabola", parabola, true}}), {0.531, 0.571});
  const auto inverted = [](double p) { return -(p + 0.531) * (p + 0.571); };
  check_labels(searched(0.0, -0.1, 60, {{"inverted", inverted, true}}), {-0.531, -0.571});
  const auto wave = [](double p) { return std::sin(40 * (p + 0.013)); };
  std::vector<double> zeros;
  for (int k = 1; k * pi / 40 - 0.013 < 1.0; ++k) zeros.push_back(k * pi / 40 - 0.013);
  const RecordedBranch branch = searched(0.0, 0.1, 200, {{"wave", wave, true}});
  std::vector<double> found = labelled(branch);
  REQUIRE(found.size() >= zeros.size());
  for (std::size_t i = 0; i < zeros.size(); ++i) CHECK(found[i] == Approx(zeros[i]).margin(1e-8));
}
