#include "model/derivative_check.hpp"

#include <CLI/CLI.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>

#include "../plugin/plugin_folder.hpp"
#include "app/problem_commands.hpp"
#include "base/messages.hpp"
#include "model/checked_function.hpp"
#include "model/hand_differentiated.hpp"
#include "model/linear_oscillator.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using Eigen::VectorXd;

namespace {

/// A problem whose parts can be replaced; two states, one parameter.
struct Sound {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  static constexpr const char* state_names[] = {"a", "b"};
  static constexpr const char* parameter_names[] = {"mu"};
  static constexpr double initial_parameters[] = {0.7};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1] * x[1];
    f[1] = p[0] * sin(x[0]);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0] - x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = -x[1];
  }
};

struct WrongByHand : Sound {
  void field_derivatives(int, const double* x, const double* p, double* dx, double* dp) const {
    dx[1] = p[0] * std::cos(x[0]);
    dx[2] = 2 * x[1];
    dp[1] = std::sin(x[0]) * (1 + 1e-6);  // should be sin(x[0])
  }
};

struct RightByHand : Sound {
  void field_derivatives(int, const double* x, const double* p, double* dx, double* dp) const {
    dx[1] = p[0] * std::cos(x[0]);
    dx[2] = 2 * x[1];
    dp[1] = std::sin(x[0]);
  }
};

/// A pendulum whose angle is counted in millions of turns, and a wall at 2e-9 of them.
struct Small {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  static constexpr double initial_parameters[] = {2e-9};
  static constexpr double initial_state[] = {1e-9, 3e7};
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = 1e-16 * x[1];
    f[1] = -1e7 * sin(1e9 * x[0]);
  }
  template <class T>
  T event(int, const T* x, const T* p) const {
    return p[0] - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = -0.8 * x[1];
  }
};

struct SmallButWrong : Small {
  void field_derivatives(int, const double* x, const double*, double* dx, double*) const {
    dx[1] = -1e16 * std::cos(1e9 * x[0]) * (1.0 + 1e-6);
    dx[2] = 1e-16;
  }
};

/// Nothing says how small its states are.
struct Oscillating {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    using std::sin;
    f[0] = x[1];
    f[1] = -1e7 * sin(1e9 * x[0]);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

struct OscillatingButWrong : Oscillating {
  void field_derivatives(int, const double* x, const double*, double* dx, double* dp) const {
    dx[0] = dx[3] = dp[0] = dp[1] = 0.0;
    dx[1] = -1e16 * std::cos(1e9 * x[0]) * (1.0 + 1e-3);
    dx[2] = 1.0;
  }
};

/// Its derivatives by the parameter vanish, but for the rounding of terms up to 1e24.
struct Cancelling {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  static constexpr double initial_parameters[] = {7e-13};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = sin(par[0] * x[0] / (par[0] + 0.3 * par[0])) - x[0];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

struct Unset : Sound {
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1];
  }
};

struct WritesTooMuch : Sound {
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    Sound::field(i, x, p, f);
    if constexpr (std::is_same_v<T, double>) f[2] = 0.0;  // would spoil the stack with dual numbers
  }
};

struct ReadsTooMuch : Sound {
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    Sound::field(i, x, p, f);
    if constexpr (std::is_same_v<T, double>) f[0] += p[1];
  }
};

struct Remembers : Sound {
  mutable int calls = 0;
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0] * (1.0 + 1e-3 * ++calls);
  }
};

struct SquareRoot : Sound {
  template <class T>
  T event(int, const T* x, const T*) const {
    return sqrt(x[0]);
  }
};

struct TwiceNamed : Sound {
  static constexpr const char* state_names[] = {"a", "a"};
};

template <class Problem>
std::string report(const DerivativeCheckOptions& options = {}) {
  const HybridSystem system(*ProblemTable<Problem>::get("tested"));
  const DerivativeCheck check = check_derivatives(system, options);
  const std::string text = to_text(system, check);
  INFO(text);
  CHECK(check.fine() == (text.find("fault:") == std::string::npos));
  return text;
}

/// `tchat check ...` in this process: exit status, output dropped.
int run_check(const std::vector<std::string>& words) {
  CLI::App app;
  std::function<int()> chosen;
  add_check_command(app, chosen);
  std::vector<std::string> reversed(words.rbegin(), words.rend());
  reversed.emplace_back("check");
  app.parse(reversed);
  REQUIRE(chosen);
  return chosen();
}

}  // namespace

TEST_CASE("extrapolated differences know how good they are") {
  const auto phi = [](double t) {
    VectorXd out(3);
    out << std::exp(3.0 * t), std::tan(t + 0.3), t > 0.015 ? NAN : std::cos(t + 1.0);
    return out;
  };
  const ExtrapolatedDifference d = extrapolated_difference(phi, 0.02);
  const double exact[] = {3.0, 1.0 / (std::cos(0.3) * std::cos(0.3)), -std::sin(1.0)};
  for (int i = 0; i < 3; ++i) {
    CHECK(std::abs(d.value[i] - exact[i]) < 1e-11);
    CHECK(std::abs(d.value[i] - exact[i]) < 20 * d.error[i]);
    CHECK(d.error[i] < 1e-10);
  }
  const ExtrapolatedDifference never = extrapolated_difference([](double) { return VectorXd::Constant(1, NAN); }, 0.1);
  CHECK(std::isnan(never.value[0]));
}

TEST_CASE("sound problems pass") {
  CHECK_THAT(report<Sound>(), Contains("No fault found"));
  CHECK_THAT(report<RightByHand>(), Contains("No fault found"));
  CHECK_THAT(report<Small>(), Contains("No fault found"));
  CHECK_THAT(report<LinearOscillator>(), Contains("parameters alpha omega zeta r"));
  CHECK_THAT(report<LinearOscillator>(), Contains("No fault found"));
  DerivativeCheckOptions options;
  options.states = {VectorXd(3)};
  options.states[0] << 0.7, -0.4, 1.3;
  CHECK_THAT(report<NonlinearProblem>(options), Contains("No fault found"));
}

TEST_CASE("a wrong derivative is named") {
  const std::string text = report<WrongByHand>();
  CHECK_THAT(text, Contains("fault: d f_1[b] / d mu is "));
  CHECK_THAT(text, !Contains("fault: d2"));
  CHECK_THAT(text, !Contains("fault: d h_1"));
}

TEST_CASE("a wrong second derivative is named") {
  tchat_problem table = *ProblemTable<Sound>::get("tested");
  table.second = [](const void*, int32_t kind, int32_t, const double* x, const double* par, const int32_t*, int32_t,
                    const double* v, double* out, double* dx, double* dp) {
    const int32_t active[] = {1};
    const tchat_problem& right = *ProblemTable<Sound>::get("tested");
    right.second(right.self, kind, 1, x, par, active, 1, v, out, dx, dp);
    if (kind == TCHAT_FIELD && v[0] == 1.0) dx[1] *= 1.001;  // d2 f_2 / d a d a
  };
  const HybridSystem system(table);
  const DerivativeCheck check = check_derivatives(system);
  CHECK_FALSE(check.fine());
  CHECK_THAT(to_text(system, check), Contains("fault: d2 f_1[b] / d a d a is "));
  CHECK(check.functions[1].faults.empty());
}

TEST_CASE("wrong derivatives are found whatever the units of states are") {
  CHECK_THAT(report<SmallButWrong>(), Contains("fault: d f_1[U(2)] / d U(1)"));
}

TEST_CASE("functions that oscillate within the step of differences are believed, and faults in them found") {
  CHECK_THAT(report<Oscillating>(), Contains("No fault found"));
  CHECK_THAT(report<OscillatingButWrong>(), Contains("fault: d f_1[U(2)] / d U(1)"));
}

TEST_CASE("rounding of supplied derivatives is no fault") {
  CHECK_THAT(report<Cancelling>(), Contains("No fault found"));
}

TEST_CASE("directional derivatives that contradict the first ones are named") {
  tchat_problem table = *ProblemTable<Sound>::get("tested");
  table.first = [](const void*, int32_t kind, int32_t, const double* x, const double* par, const int32_t* active,
                   int32_t count, double* out, double* dx, double* dp) {
    const tchat_problem& right = *ProblemTable<Sound>::get("tested");
    right.first(right.self, kind, 1, x, par, active, count, out, dx, dp);
    if (kind == TCHAT_JUMP) dx[0] += 1e-10;  // too small for differences to see
  };
  const HybridSystem system(table);
  CHECK_THAT(to_text(system, check_derivatives(system)),
             Contains("fault: d g_1[a] / d a is 1.0000000001 from the first derivatives but 1 from the second ones"));
}

TEST_CASE("mistakes other than derivatives are named") {
  CHECK_THAT(report<Unset>(), Contains("f_1[b] is NaN or infinite at every state tried: is it left unset?"));
  CHECK_THAT(report<WritesTooMuch>(), Contains("field 1 writes more than 2 outputs"));
  CHECK_THAT(report<ReadsTooMuch>(), Contains("field 1 reads beyond its 2 states or 1 parameters"));
  CHECK_THAT(report<Remembers>(), Contains("h_1 changes from call to call"));
  CHECK_THAT(report<TwiceNamed>(), Contains("the state name 'a' is used twice"));
}

TEST_CASE("not being evaluable somewhere is a fault only at a given state") {
  const std::string near_zero = report<SquareRoot>();
  CHECK_THAT(near_zero, Contains("not evaluable at "));
  CHECK_THAT(near_zero, Contains("No fault found"));
  DerivativeCheckOptions options;
  options.states = {VectorXd::Constant(2, -1.0), VectorXd::Constant(2, 2.0)};
  CHECK_THAT(report<SquareRoot>(options), Contains("at x = (-1, -1)"));
}

TEST_CASE("wrong states and parameters are refused") {
  const HybridSystem system(*ProblemTable<Sound>::get("tested"));
  DerivativeCheckOptions options;
  options.states = {VectorXd::Zero(3)};
  CHECK_THROWS_AS(check_derivatives(system, options), UserError);
  options.states = {VectorXd::Constant(2, NAN)};
  CHECK_THROWS_AS(check_derivatives(system, options), UserError);
  options.states.clear();
  options.parameters = VectorXd::Zero(1000);
  CHECK_THROWS_AS(check_derivatives(system, options), UserError);
  options.parameters.resize(0);
  options.random_states = 0;
  CHECK(check_derivatives(system, options).fine());
}

TEST_CASE("tchat check") {
  const PluginFolder folder;
  std::filesystem::copy(TCHAT_TEST_PROBLEMS "/linosc/linosc.cpp", folder / "linosc.cpp");
  const std::string linosc = folder / "linosc";
  CHECK(run_check({linosc}) == 0);
  CHECK(run_check({linosc, "PAR(omega)=2.1", "PAR(1)=3", "--state", "1,-0.4,0.1,-0.99", "--random", "2"}) == 0);
  CHECK(run_check({"anything", "-p", linosc + ".cpp", "--state=1,0,0,1", "--state=0,0,0,1"}) == 0);
  CHECK_THROWS_WITH(run_check({linosc, "PAR(omeha)=2.1"}), Contains("alpha, omega, zeta, r"));
  CHECK_THROWS_WITH(run_check({linosc, "PAR(5)=2.1"}), Contains("no parameter '5'"));
  CHECK_THROWS_WITH(run_check({linosc, "omega=2.1"}), Contains("not understood"));
  CHECK_THROWS_WITH(run_check({linosc, "PAR(1)=2.1x"}), Contains("not a number"));
  CHECK_THROWS_WITH(run_check({linosc, "--state", "1,2"}), Contains("needs 4 finite numbers"));
  CHECK_THROWS_WITH(run_check({linosc, "--state", "1,,2,3"}), Contains("not a number"));
  CHECK_THROWS_WITH(run_check({"no_such_problem"}), Contains("no_such_problem.cpp"));
}
