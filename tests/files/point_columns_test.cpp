#include "files/point_file.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace tchat;

TEST_CASE("IPLT of any size is a measure") {
  const ProblemNames names{{"x1", "x2"}, {}, {}};
  using Limits = std::numeric_limits<int>;
  for (const int selector : {Limits::min(), Limits::min() + 1, -7, -3, 0, 7, Limits::max()})
    CHECK(measure_column(selector, 2, names).kind == PointColumn::Kind::l2_norm);
  CHECK(measure_column(-2, 2, names).name == "MIN x2");
  CHECK(measure_column(2, 2, names).name == "MAX x2");
  CHECK(measure_column(4, 2, names).name == "INTEGRAL x2");
  CHECK(measure_column(6, 2, names).name == "L2-NORM x2");
}
