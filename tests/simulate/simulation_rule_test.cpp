// What a simulation watches and where it starts, by the command line and the constants.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "simulate/simulation_start.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// A ball: height and velocity; it meets the ground, and passes the top of its flight.
struct Ball {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 2, jumps = 2;
  static constexpr const char* state_names[] = {"height", "velocity"};
  static constexpr double initial_parameters[] = {9.81};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = -p[0];
  }
  template <class T>
  T event(int k, const T* x, const T*) const {
    return x[k - 1];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* y) const {
    y[0] = x[0];
    y[1] = k == 1 ? T(-x[1]) : x[1];
  }
};

const HybridSystem& ball() { return system_of<Ball>(); }

SimulationConstants with_segments(const std::vector<SegmentSettings>& segments) {
  SimulationConstants constants;
  constants.settings.dimension = 2;
  constants.settings.segments = segments;
  constants.path = "gc.ball";
  constants.has_signature = true;
  return constants;
}

const SegmentSettings fall{1, {1, 1, 1}, {1, 2}};
const SegmentSettings rise{1, {1, 2, 2}, {2}};

}  // namespace

TEST_CASE("modes are index vectors, each once") {
  CHECK(parse_modes("1,2,1; 1,3,2; 1,2,1") == std::vector<IndexVector>{{1, 2, 1}, {1, 3, 2}});
  CHECK_THROWS_WITH(parse_modes("1,2"), Catch::StartsWith("--mode"));
  CHECK(parse_modes(modes_text({{1, 2, 1}, {1, 3, 2}})) == std::vector<IndexVector>{{1, 2, 1}, {1, 3, 2}});
}

TEST_CASE("a given signature replaces the file's, and keeps what known segments monitor") {
  SimulationRequest request;
  const SimulationConstants file = with_segments({rise, fall});
  CHECK(with_signature(request, file).settings.segments.size() == 2);
  request.signature = "1,1,1";
  const SimulationConstants given = with_signature(request, file);
  REQUIRE(given.settings.segments.size() == 1);
  CHECK(given.settings.segments[0].monitor == std::vector<int>{1, 2});
  SimulationConstants none;
  none.settings.segments.resize(1);
  CHECK_FALSE(with_signature({}, none).has_signature);
  CHECK(with_signature(request, none).has_signature);
}

TEST_CASE("without an index jump function the signature is followed, from --mode on") {
  const Eigen::VectorXd x = Eigen::Vector2d(1.0, 0.0);
  const Eigen::VectorXd par = Eigen::VectorXd::Constant(1, 9.81);
  SimulationRequest request;
  const SimulationConstants constants = with_segments({rise, fall});
  ModeRule rule = simulation_rule(request, constants, ball(), x, par);
  CHECK(rule.is_cyclic());
  CHECK(rule.first(x, par).index_vectors == std::vector<IndexVector>{{1, 2, 2}});
  CHECK(rule.next({1, 2, 2}, x, par).index_vectors == std::vector<IndexVector>{{1, 1, 1}});

  request.modes = "1,1,1";
  ModeRule from_fall = simulation_rule(request, constants, ball(), x, par);
  const Mode first = from_fall.first(x, par);
  CHECK(first.index_vectors == std::vector<IndexVector>{{1, 1, 1}});
  CHECK(first.monitored == std::vector<int>{2});  // event 1 ends the segment

  request.modes = "1,1,2";
  CHECK_THROWS_WITH(simulation_rule(request, constants, ball(), x, par), Catch::Contains("give one of its index"));
  SimulationConstants none;
  none.settings.segments.resize(1);
  CHECK_THROWS_WITH(simulation_rule({}, none, ball(), x, par), Catch::Contains("no index jump function"));
}

TEST_CASE("a state of --state is named or in order, and has priority over the zeros") {
  SimulationRequest request;
  const SimulationConstants constants = with_segments({rise, fall});
  request.state = "velocity=2, height=1";
  CHECK(simulation_start(request, constants, ball()).state == Eigen::Vector2d(1.0, 2.0));
  request.state = "3,4";
  const SimulationStart start = simulation_start(request, constants, ball());
  CHECK(start.state == Eigen::Vector2d(3.0, 4.0));
  CHECK(start.par(0) == 9.81);
  CHECK(state_index(ball(), "velocity", "--state") == 2);
  CHECK_THROWS_WITH(state_index(ball(), "depth", "--state"), Catch::StartsWith("--state") && Catch::Contains("height"));
  request.state = "1,2,3";
  CHECK_THROWS_AS(simulation_start(request, constants, ball()), UserError);
}
