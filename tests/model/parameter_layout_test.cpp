// Where PAR has parameters, durations, the rotation number and monitors, for few and for many parameters.
#include <catch2/catch.hpp>
#include <set>

#include "model/parameter_vector.hpp"

using namespace tchat;

TEST_CASE("up to 60 parameters the durations are PAR(61), PAR(62), ...") {
  for (const int parameters : {0, 1, 59, 60}) {
    const ParameterLayout layout(parameters);
    CHECK(layout.first_duration() == 61);
    CHECK(layout.duration_of_name("T2") == 62);
    CHECK(layout.duration_name(62) == "T2");
    CHECK(layout.stored(1, false) == 100);
    CHECK(layout.stored(41, false) == 101);
    CHECK(layout.recorded(false) == 0);
    CHECK(layout.room() == 512);
  }
  CHECK(ParameterLayout(59).rotation() == 60);
  CHECK(ParameterLayout(59).recorded(true) == 0);
}

TEST_CASE("more parameters move the durations behind them") {
  const ParameterLayout layout(100);
  CHECK(layout.first_duration() == 101);
  CHECK_FALSE(layout.is_duration(100, 2));
  CHECK(layout.is_duration(102, 2));
  CHECK_FALSE(layout.is_duration(103, 2));
  CHECK(layout.duration_of_name("T3") == 103);
  CHECK(layout.stored(2, false) == 102);
  CHECK(layout.recorded(false) == 100);
}

TEST_CASE("nothing shares a place in PAR") {
  for (const int parameters : {0, 59, 60, 61, 200, 1000})
    for (const int segments : {1, 200, 256, 300, 1000}) {
      CAPTURE(parameters, segments);
      const ParameterLayout layout(parameters);
      std::set<int> used;
      for (int k = 1; k <= parameters; ++k) used.insert(k);
      for (int s = 0; s < segments; ++s) CHECK(used.insert(layout.duration(s)).second);
      if (segments <= max_torus_segments) CHECK(used.insert(layout.rotation()).second);
      for (int i = 0; i < max_monitors; ++i) CHECK(used.insert(layout.first_monitor(segments) + i).second);
      CHECK(used.insert(layout.unfolding(segments)).second);
      CHECK(*used.rbegin() <= layout.room(segments));
      CHECK(layout.is_parameter(layout.rotation(), max_torus_segments));
      CHECK_FALSE(layout.is_parameter(layout.duration(0), segments));
      CHECK_FALSE(layout.is_parameter(layout.first_monitor(segments), segments));
      CHECK(layout.stored(std::min(segments, max_torus_segments), true) >= layout.rotation());
    }
}

TEST_CASE("a vector keeps its layout when it gets other values and more room") {
  ParameterVector par(ParameterLayout(70), 2);
  par.duration(1) = 5.0;
  CHECK(par(71) == 5.0);
  const Eigen::VectorXd twice = 2.0 * par;
  par = twice;
  CHECK(par.duration(1) == 10.0);
  par.make_room(2000);
  CHECK(par.duration(1999) == 0.0);
  const ParameterVector copy = par;
  CHECK(copy.durations(2).sum() == 10.0);
  par(69) = 3.0;
  par.clear_durations();
  CHECK(par.sum() == 3.0);
}
