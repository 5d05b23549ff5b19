// Formulas compiled and evaluated: every operator, function and awkward name against the same expressions in C++, and
// their derivatives against finite differences.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "../plugin/plugin_folder.hpp"
#include "base/messages.hpp"
#include "model/derivative_check.hpp"
#include "plugin/problem_library.hpp"

using namespace tchat;

namespace {

constexpr const char* everything = R"(# every function, and names that are none in C++
par new=2, EOF=0.5, T=3, par=0.25, i=7, M_PIf=1.5, errno=4, a__b=0.125
number state=2
init x=0.3, index=0.2
f(x, y) = x^2*y + new*index   # its x is not the state
g(q) = f(q, 2) - f(2, q)
mix = g(x)*h
h = sin(x) + cos(index)*tan(x/4)
x' = mix + asin(x/2) + acos(x/2) + atan(x) + sinh(x) + cosh(x) + tanh(x) + exp(-x)
index' = log(x + 2) + ln(x + 3) + log10(x + 4) + log2(x + 5) + sqrt(x + 6) + cbrt(x + 7) + asinh(x) \
  + acosh(x + 2) + atanh(x/2) + atan2(x, index) + hypot(x, index) + pow(x + 1, index) + (x + 1)^state
field other
x' = x^2 + x^3 + x^4 + x^5 + x^-1 + (x + 1)^0.5 - -x - 2^x - T^2^0.5/par + i*EOF*M_PIf*errno*a__b
index' = max(x, 0) + max(0, 1) - min(x, index) + abs(-x) + mod(T, 2) + sign(new) + heav(par) + floor(T/2)
event class = x - new/3*(1/2)
event constant = 1
jump both: x -> index, index -> x
jump steps: x -> sign(x) + heav(x) + floor(x) + mod(x, index)
aux sum = f(x, 1) + max(x, index), energy = mix
after both if f(x, 1) > 0.5 or index >= 1: other until class -> both
after any: flow2 until class -> both, constant -> steps
field flow2
)";

struct Evaluated {
  const HybridSystem& system;
  std::vector<double> par;
  std::array<double, 2> operator()(FunctionKind kind, int index, double x, double y) const {
    const std::array<double, 2> state = {x, y};
    std::array<double, 2> out{};
    system.value(kind, index, state.data(), par.data(), out.data());
    return out;
  }
};

}  // namespace

TEST_CASE("formulas compute what they say", "[compiles]") {
  const PluginFolder folder;
  folder.write("all.tch", everything);
  const ProblemLibrary library(resolve_plugin(folder / "all", folder.counting_compiler()));
  const HybridSystem& system = library.system();
  CHECK(system.name() == "All");
  CHECK(system.parameter_name(1) == "new");
  CHECK(system.state_name(2) == "index");
  CHECK(system.function_name(FunctionKind::field, 2) == "flow2");
  CHECK(system.table().initial_state[0] == 0.3);

  Evaluated at{system, std::vector<double>(TCHAT_PAR_LENGTH, 0.0)};
  std::copy_n(system.table().initial_parameters, system.parameters(), at.par.begin());
  const double x = 0.3, y = 0.2, new_ = 2;
  const auto f = [&](double a, double b) { return a * a * b + new_ * y; };
  const double h = std::sin(x) + std::cos(y) * std::tan(x / 4), mix = (f(x, 2) - f(2, x)) * h;

  const double pi = std::acos(-1.0);
  const auto other = at(FunctionKind::field, 1, x, y);
  CHECK(other[0] == Approx(x * x + x * x * x + std::pow(x, 4) + std::pow(x, 5) + 1 / x + std::sqrt(x + 1) + x -
                           std::pow(2, x) - std::pow(3, std::sqrt(2.0)) / 0.25 + 7 * 0.5 * 1.5 * 4 * 0.125)
                        .epsilon(1e-14));
  CHECK(other[1] == Approx(x + 1 - y + x + 1 + 1 + 1 + 1).epsilon(1e-14));
  const auto flow = at(FunctionKind::field, 2, x, y);
  CHECK(flow[0] ==
        Approx(mix + pi / 2 + std::atan(x) + std::sinh(x) + std::cosh(x) + std::tanh(x) + std::exp(-x)).epsilon(1e-14));
  CHECK(flow[1] == Approx(std::log(x + 2) + std::log(x + 3) + std::log10(x + 4) + std::log2(x + 5) + std::sqrt(x + 6) +
                          std::cbrt(x + 7) + std::asinh(x) + std::acosh(x + 2) + std::atanh(x / 2) + std::atan2(x, y) +
                          std::hypot(x, y) + std::pow(x + 1, y) + (x + 1) * (x + 1))
                       .epsilon(1e-14));
  CHECK(at(FunctionKind::event, 1, x, y)[0] == Approx(x - 1.0 / 3).epsilon(1e-14));
  CHECK(at(FunctionKind::event, 2, x, y)[0] == 1.0);
  CHECK(at(FunctionKind::jump, 1, x, y) == std::array<double, 2>{y, x});
  CHECK(at(FunctionKind::jump, 2, x, y)[0] == Approx(1 + 1 + 0 + 0.1).epsilon(1e-14));
  CHECK(at(FunctionKind::jump, 2, -x, y)[0] == Approx(-1 + 0 - 1 + 0.1).epsilon(1e-14));
  CHECK(at(FunctionKind::jump, 3, x, y) == std::array<double, 2>{x, y});

  std::array<double, 2> values{}, state = {x, y};
  system.table().user_value(system.table().self, state.data(), at.par.data(), values.data());
  CHECK(values[0] == Approx(f(x, 1) + x).epsilon(1e-14));
  CHECK(values[1] == Approx(mix).epsilon(1e-14));

  const auto next = [&](const IndexVector& from, double a, double b) {
    const std::array<double, 2> s = {a, b};
    return system.successors(from, s.data(), at.par.data()).value();
  };
  CHECK(next({0, 0, 0}, x, y) == std::vector<IndexVector>{{2, 1, 1}, {2, 2, 2}});
  CHECK(next({2, 1, 1}, 0.0, 0.0) == std::vector<IndexVector>{{2, 1, 1}, {2, 2, 2}});
  CHECK(next({2, 1, 1}, 0.0, 1.0) == std::vector<IndexVector>{{1, 1, 1}});
  CHECK(next({2, 1, 1}, 0.0, 0.3) == std::vector<IndexVector>{{1, 1, 1}});
}

TEST_CASE("derivatives of formulas are those of finite differences", "[compiles]") {
  const PluginFolder folder;
  folder.write("smooth.tch",
               "par a=2, b=0.7\nx' = a*x^3 - x^b + y^2/(1 + x^2) + exp(-b*x)*hypot(x, y)\n"
               "y' = sin(a*y)^2 + max(x, 0)*abs(y) + atan2(y, x)\n"
               "event e = x^4 - b\njump j: y -> -b*y*sqrt(x)\n");
  const ProblemLibrary library(resolve_plugin(folder / "smooth", folder.counting_compiler()));
  DerivativeCheckOptions options;
  options.states = {Eigen::Vector2d(0.9, 0.4)};
  options.parameters = Eigen::Vector2d(2, 0.7);
  options.random_states = 0;
  CHECK(check_derivatives(library.system(), options).fine());
}

TEST_CASE("a plugin of formulas belongs to its text", "[compiles]") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  const std::string text = "par a=1\nx' = a\nevent e = x\n";
  folder.write("dir/mine.tch", text);
  const std::string library = folder / "dir/mine.tch.so";
  CHECK(resolve_plugin(folder / "dir/mine", options) == library);
  CHECK(resolve_plugin(folder / "dir/mine.tch", options) == library);
  CHECK(folder.compilations() == 1);
  CHECK(folder.entries("dir") == 2);

  const auto states = [&] { return ProblemLibrary(resolve_plugin(folder / "dir/mine", options)).system().dimension(); };
  folder.write("dir/mine.tch", text + "y' = a\n");
  CHECK(states() == 2);
  CHECK(folder.compilations() == 2);
  folder.write("dir/mine.tch", "# the same formulas\n" + text + "y' = a\n");
  std::filesystem::last_write_time(folder / "dir/mine.tch", std::filesystem::last_write_time(library));
  CHECK(states() == 2);

  // A copy of the folder has its own; a mistake is told, whatever the library was made from.
  std::filesystem::copy(folder / "dir", folder / "copy");
  CHECK(resolve_plugin(folder / "copy/mine", options) == folder / "copy/mine.tch.so");
  folder.write("dir/mine.tch", text + "y' = \n");
  CHECK_THROWS_WITH(states(), Catch::Matchers::Contains("dir/mine.tch:4:6: "));

  // C++ of the same name goes first, and has another library.
  folder.write("dir/mine.cpp", small_plugin());
  CHECK(resolve_plugin(folder / "dir/mine", options) == folder / "dir/mine.so");
  CHECK(named_problem(folder / "dir/mine.tch").plugin == folder / "dir/mine.tch");
  CHECK(named_problem(folder / "dir/mine.cpp").name == folder / "dir/mine");
  CHECK_FALSE(named_problem(folder / "dir/mine.cpp").plugin);
  CHECK_FALSE(named_problem(folder / "copy/mine.tch").plugin);
  CHECK(named_problem("none.tch").name == "none.tch");
}
