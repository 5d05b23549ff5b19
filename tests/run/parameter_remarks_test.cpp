// What a user must know of free parameters and their bounds before a run.
#include <catch2/catch.hpp>

#include "run/run_remarks.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

RunSettings settings_with(std::vector<int> free) {
  RunSettings settings;
  settings.free_parameters = std::move(free);
  settings.segments = {{1, {1, 1, 1}, {}}};
  return settings;
}

SelectedStart start_at(PointType type) {
  SelectedStart start;
  start.type = static_cast<int>(type);
  start.types = {start.type};
  return start;
}

}  // namespace

TEST_CASE("bounds of the file for another ICP(1) are pointed out, unless the command line gives them") {
  RunSettings file = settings_with({1});
  file.parameter_max = 4.5;
  RunSettings used = file;
  CHECK(inherited_bounds(linosc(), file, used, {}, "gc.x").empty());
  used.free_parameters = {2};
  const std::string text = inherited_bounds(linosc(), file, used, {"ICP=[2]"}, "gc.x");
  CHECK_THAT(text, Catch::Contains("RL1 = 4.5") && Catch::Contains("given for " + linosc().parameter_name(1)) &&
                       Catch::Contains("bounds " + linosc().parameter_name(2)));
  CHECK_THAT(text, !Catch::Contains("RL0 ="));
  CHECK(inherited_bounds(linosc(), file, used, {"ICP=[2]", "RL1=5"}, "gc.x").empty());
}

TEST_CASE("a second parameter is idle with ISW = 1, which matters at a point that starts a curve") {
  const RunSettings settings = settings_with({1, 2});
  CHECK_THAT(idle_parameters(linosc(), settings, start_at(PointType::fold), 1),
             Catch::StartsWith(linosc().parameter_name(2)) && Catch::Contains("the curve of LP in two parameters"));
  CHECK(idle_parameters(linosc(), settings, start_at(PointType::regular), 1).empty());
  CHECK(idle_parameters(linosc(), settings_with({1}), start_at(PointType::fold), 1).empty());
  CHECK(idle_parameters(linosc(), settings_with({1, ParameterLayout().first_duration()}), start_at(PointType::fold), 1)
            .empty());
}
