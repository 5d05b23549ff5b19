// The words that start a born branch, which a run and a page for browsers print.
#include <catch2/catch.hpp>

#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

using namespace tchat;

TEST_CASE("what is born at a label, by its type and the branch that it is on") {
  const auto words = [](PointType type, int number) {
    return shell_words(birth_words(static_cast<int>(type), number, false, "a"));
  };
  CHECK(words(PointType::period_doubling, 180) == " ISW=-1");
  CHECK(words(PointType::branch_point, 180) == " ISW=-1");
  CHECK(words(PointType::equilibrium_branch_point, 1) == " ISW=-1");
  CHECK(words(PointType::hopf, 1) == " IPS=180 ISW=-1");
  CHECK(words(PointType::torus, 180) == " IPS=182 ISW=-1 'ICP=[a,rho]'");
  // An orbit that has shrunk to a point, and a torus that has shrunk to an orbit, are where branches end.
  CHECK(words(PointType::hopf, 180).empty());
  CHECK(words(PointType::torus, 182).empty());
  CHECK(words(PointType::fold, 180).empty());
  CHECK(words(PointType::regular, 180).empty());
}

TEST_CASE("what begins at a label of a curve in two parameters") {
  const auto words = [](PointType type, int number) {
    return shell_words(birth_words(static_cast<int>(type), number, true, "a"));
  };
  CHECK(words(PointType::generalized_doubling, 180) == " ISW=-1");
  CHECK(words(PointType::resonance_2, 180) == " ISW=-1");
  CHECK(words(PointType::generalized_hopf, 1) == " IPS=180 ISW=-1");
  CHECK(words(PointType::zero_hopf, 1) == " IPS=180 ISW=-1");
  CHECK(words(PointType::double_hopf, 1) == " IPS=180 ISW=-1");
  CHECK(words(PointType::hopf, 1).empty());
  CHECK(words(PointType::period_doubling, 180).empty());
}
