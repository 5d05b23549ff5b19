// The rows of IPS and ISW: at which labels they start and how many parameters they free, compared with a table by hand.
// A curve of codimension c has c + 1 free parameters, of which ISW = 1 counts the first.
#include <algorithm>
#include <catch2/catch.hpp>

#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

using namespace tchat;

namespace {

struct Expected {
  int number;
  int branch_mode;
  PointType label;
  int curve;            // tens digit of its points
  int free_parameters;  // of the problem
};

std::vector<const ProblemType*> starting_at(const Expected& row) {
  std::vector<const ProblemType*> found = problem_types_of(row.number, row.branch_mode);
  const auto starts = [&row](const ProblemType* type) { return type->begins_at(static_cast<int>(row.label)); };
  found.erase(std::remove_if(found.begin(), found.end(), std::not_fn(starts)), found.end());
  return found;
}

}  // namespace

TEST_CASE("a curve in two parameters is that of its label") {
  const Expected rows[] = {{180, 2, PointType::fold, 5, 2},
                           {180, 2, PointType::branch_point, 6, 2},
                           {180, 2, PointType::period_doubling, 7, 2},
                           {180, 2, PointType::torus, 8, 2},
                           {180, 3, PointType::torus, 8, 3},
                           {180, 3, PointType::branch_point, 6, 3},
                           {1, 2, PointType::equilibrium_fold, 2, 2},
                           {1, 2, PointType::hopf, 3, 2}};
  for (const Expected& row : rows) {
    CAPTURE(row.number, row.branch_mode, static_cast<int>(row.label));
    const auto found = starting_at(row);
    REQUIRE(found.size() == 1);
    const ProblemFacts& facts = found.front()->facts();
    CHECK(facts.curve == row.curve);
    CHECK(facts.free_parameters == row.free_parameters);
    CHECK(facts.in_two_parameters);
  }
}

TEST_CASE("no curve of critical multipliers starts at a regular point") {
  constexpr int of_contacts = 4;  // BE, where an event function is zero
  for (const int number : {180, 1})
    for (const PointType label : {PointType::regular, PointType::end})
      for (const ProblemType* type : starting_at({number, 2, label, 0, 0}))
        CHECK((type->facts().curve == 0 || (number == 1 && type->facts().curve == of_contacts)));
}

TEST_CASE("branches in one parameter start at any label, and switches where branches cross") {
  for (const PointType label : {PointType::regular, PointType::fold, PointType::period_doubling}) {
    CHECK(starting_at({180, 1, label, 0, 0}).size() == 1);
    CHECK(starting_at({1, 1, label, 0, 0}).size() == 1);
  }
  for (const PointType label : {PointType::period_doubling, PointType::branch_point, PointType::hopf})
    CHECK(starting_at({180, -1, label, 0, 0}).size() == 1);
  CHECK(starting_at({182, -1, PointType::torus, 0, 0}).size() == 1);
  CHECK(starting_at({182, -1, PointType::fold, 0, 0}).empty());
}

TEST_CASE("a switch goes on as the type that ISW = 1 names, of the same family") {
  int switches = 0;
  for (const ProblemType* type : problem_types()) {
    if (!type->facts().switches_branch) continue;
    ++switches;
    CAPTURE(type->facts().title);
    CHECK(type->facts().branch_mode == -1);
    const auto onward = problem_types_of(type->facts().number, 1);
    REQUIRE(onward.size() == 1);
    CHECK(&onward.front()->family() == &type->family());
  }
  CHECK(switches >= 4);
}
