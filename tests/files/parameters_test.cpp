// Names and values of parameters that constants and the command line give.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "plugin/problem_setup.hpp"
#include "run/solver_settings.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// A ball: height and velocity, gravity g and restitution r.
struct Ball {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  static constexpr const char* parameter_names[] = {"g", "r"};
  static constexpr double initial_parameters[] = {9.81, 0.75};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = -p[0];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* y) const {
    y[0] = x[0];
    y[1] = -p[1] * x[1];
  }
};

const HybridSystem& ball() { return system_of<Ball>(); }

RunSettings ball_settings() {
  RunSettings settings;
  settings.dimension = 2;
  settings.free_parameters = {1};
  settings.segments = {{1, {1, 1, 1}, {}}};
  return settings;
}

}  // namespace

TEST_CASE("the plugin's values are there, and zeros behind them") {
  const ParameterVector par = initial_parameters(ball());
  CHECK(par(0) == 9.81);
  CHECK(par(1) == 0.75);
  CHECK(par.tail(par.size() - 2).isZero(0.0));
}

TEST_CASE("the command line has the last word, by index or name") {
  RunSettings settings;
  ParameterVector par = initial_parameters(ball());
  settings.parameter_values = {{"2", 0.75}};
  CHECK_FALSE(apply_command_line(ball(), settings, par));  // it is what was there
  settings.parameter_values = {{"r", 0.5}, {"1", 1.62}};
  CHECK(apply_command_line(ball(), settings, par));
  CHECK(par(0) == 1.62);
  CHECK(par(1) == 0.5);
  settings.parameter_values = {{"mass", 1.0}};
  CHECK_THROWS_WITH(apply_command_line(ball(), settings, par), Catch::StartsWith("command line"));
}

TEST_CASE("the command line may set the duration of a segment behind the room that one segment has") {
  RunSettings settings = ball_settings();
  settings.segments.resize(502, settings.segments.front());
  settings.parameter_values = {{"562", 2.5}};
  ParameterVector par = initial_parameters(ball());
  REQUIRE(par.size() < 562);
  CHECK(apply_command_line(ball(), settings, par));
  CHECK(par.duration(501) == 2.5);
  CHECK(par(0) == 9.81);
}

TEST_CASE("lines of a .dat file hold the problem's parameters, and what else is not zero") {
  ParameterVector par = initial_parameters(ball());
  CHECK(parameter_lines(ball(), par) == "# PAR(1) = 9.81\n# PAR(2) = 0.75\n");
  par(1) = 0.0;
  par(4) = -2.0;
  par(ParameterLayout().first_duration() - 1) = 3.0;  // a duration
  CHECK(parameter_lines(ball(), par) == "# PAR(1) = 9.81\n# PAR(2) = 0\n# PAR(5) = -2\n");
}

TEST_CASE("names in ICP become indices of parameters, durations and monitors") {
  RunSettings settings = ball_settings();
  settings.names = {{"r", "ICP", {}}, {"T1", "ICP", {}}, {"max(U(1))", "ICP", {}}};
  settings.free_parameters = {name_index(0), name_index(1), name_index(2)};
  resolve_names(settings, ball());
  CHECK(settings.free_parameters == std::vector<int>{2, ParameterLayout().first_duration(), first_monitor(settings)});
  CHECK(settings.monitors == std::vector<std::string>{"max(U(1))"});

  settings.names = {{"mass", "ICP", {}}};
  settings.free_parameters = {name_index(0)};
  CHECK_THROWS_WITH(resolve_names(settings, ball()), Catch::Contains("mass") && Catch::Contains("g, r"));
}

TEST_CASE("constants that the problem does not fit are refused") {
  const SettingsSource source{"gc.ball", {"NDIM=3"}};
  CHECK(source.of("NDIM") == "command line");
  CHECK(source.of("ICP") == "gc.ball");
  CHECK(check_settings_against(ball(), ball_settings(), source).empty());
  RunSettings settings = ball_settings();
  settings.dimension = 3;
  CHECK_THROWS_AS(check_settings_against(ball(), settings, source), UserError);
  settings = ball_settings();
  settings.segments.front().index.event = 2;
  CHECK_THROWS_AS(check_settings_against(ball(), settings, source), UserError);
  settings = ball_settings();
  settings.segments.front().type = 0;  // an identity jump, which this one is not
  CHECK(check_settings_against(ball(), settings, source).size() == 1);
}

TEST_CASE("weights of THU are those of their states, 1 for the others") {
  RunSettings settings = ball_settings();
  settings.state_weights = {{2, 0.25}};
  CHECK(state_weights(settings) == Eigen::Vector2d(1.0, 0.25));
}
