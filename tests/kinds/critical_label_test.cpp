// Which multipliers a label must have.
#include "kinds/verify_solutions.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;

namespace {

using Multipliers = std::vector<std::complex<double>>;

Multipliers critical(int type, int problem_type = 180, const std::vector<UserPointKind>& kinds = {}) {
  LabelledSolution solution;
  solution.type = type;
  solution.problem_type = problem_type;
  if (!kinds.empty()) solution.kind = kinds.front();
  if (kinds.size() > 1) solution.further.assign(kinds.begin() + 1, kinds.end());
  // A pair outside the circle, angle 2.1; one further from it; a real multiplier nearest to it.
  const std::complex<double> pair = std::polar(1.001, 2.1), far = std::polar(0.5, 0.3);
  return critical_multipliers(solution, {pair, std::conj(pair), far, std::conj(far), 1.0}, {});
}

}  // namespace

TEST_CASE("labels of a branch and of two-parameter curves have their critical multipliers, others none") {
  for (const int fold : {5, 6, 59, -54, 54, -52}) CHECK(critical(fold) == Multipliers{1.0});
  for (const int doubling : {7, 79, -74, 74, -76}) CHECK(critical(doubling) == Multipliers{-1.0});
  for (const int torus : {8, 89, -84, -87}) {
    REQUIRE(critical(torus).size() == 1);
    CHECK(std::abs(critical(torus).front() - std::polar(1.0, 2.1)) < 1e-14);
  }
  for (const int other : {0, 4, -4, 9, -9}) CHECK(critical(other).empty());
}

TEST_CASE("folds along a held quantity are none in a parameter") {
  LabelledSolution solution;
  solution.problem_type = 180;
  for (const int type : {5, 6, 7}) {
    solution.type = type;
    CHECK(critical_multipliers(solution, {}, {}, false).size() == (type == 7 ? 1U : 0U));
  }
}

TEST_CASE("a contact that is a fold too, grazing-flips, folds of grazing curves") {
  const UserPointKind contact{UserPointKind::contact, 1, 1, 0.5};
  CHECK(critical(-4, 180, {contact, {UserPointKind::other_type, 0, 5, 0.0}}) == Multipliers{1.0});
  CHECK(critical(-4, 150, {{UserPointKind::grazing_codimension_two, 0, -1, 1.0}}) == Multipliers{-1.0});
  CHECK(critical(-4, 150, {{UserPointKind::grazing_codimension_two, 1, 0, 1.0}}).empty());  // a* = 0
  CHECK(critical(5, 150).empty());
}
