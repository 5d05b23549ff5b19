// What the numbers IPS and ISW say, compared with the documented list (src/docs/files.md) and AUTO-07p's manual.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "settings/problem_type.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using namespace test_support;

TEST_CASE("ISW = 0 stands for 1") {
  CHECK(problem_types_of(180, 0) == problem_types_of(180, 1));
  CHECK(problem_types_of(180, 0) != problem_types_of(180, 2));
  CHECK(standard_branch_mode(-1) == -1);
}

TEST_CASE("a problem that tchat does not solve is refused with a list of those it does") {
  CHECK(problem_types_of(180, 7).empty());
  CHECK(nearest_problem_type(180, 7) == problem_types_of(180, 1).front());
  CHECK(nearest_problem_type(99, 1) == nullptr);
  const std::string message = message_of<UserError>([] { problem_type(99, 1); });
  for (const char* part : {"IPS = 99 with ISW = 1", "IPS = 180, ISW = 1", "IPS = 150, ISW = 1", "IPS = 182, ISW = 1"})
    CHECK_THAT(message, Catch::Contains(part));
}

TEST_CASE("numbers that are AUTO's too") {
  CHECK(is_shared_problem_type(1));
  CHECK(is_shared_problem_type(4));
  CHECK_FALSE(is_shared_problem_type(180));
  CHECK_FALSE(is_own_problem_type(2));
  CHECK(auto_period(2) == 11);  // periodic orbits
  CHECK(auto_period(7) == 11);
  CHECK_FALSE(auto_period(180).has_value());
}

TEST_CASE("files of the older generation, which hold 0, may be of any problem") {
  CHECK(is_same_problem_type(0, 182));
  CHECK(is_same_problem_type(150, 0));
  CHECK_FALSE(is_same_problem_type(150, 180));
}

TEST_CASE("curves in two parameters: ISW = 2, and grazing orbits with any ISW") {
  CHECK(is_two_parameter_curve(180, 2));
  CHECK(is_two_parameter_curve(150, 1));
  CHECK_FALSE(is_two_parameter_curve(180, 1));
  CHECK_FALSE(is_two_parameter_curve(180, -1));
  CHECK(has_two_parameter_curves(180));
  CHECK_FALSE(has_two_parameter_curves(150));
}

TEST_CASE("which problems have multipliers, and where one of them is critical") {
  CHECK(has_multipliers(180));
  CHECK(has_multipliers(2));
  CHECK_FALSE(has_multipliers(4));
  CHECK(has_critical_multiplier(180, 2));
  CHECK_FALSE(has_critical_multiplier(180, 1));
  CHECK(keeps_contact(150));
  CHECK_FALSE(keeps_contact(180));
  CHECK(may_double_segments(-1));
  CHECK_FALSE(may_double_segments(2));
}
