#include "plugin/problem_library.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/messages.hpp"
#include "model/function_values.hpp"
#include "model/parameter_vector.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

const PluginBuildOptions build_options = {"", TCHAT_TEST_INCLUDE};

struct BadPlugin {
  const char* source;
  std::vector<const char*> message;  // parts of it
};

}  // namespace

TEST_CASE("a C++ plugin is compiled, loaded and evaluated") {
  const PluginFolder folder;
  const std::string source = folder.write("ball.cpp", R"(#include <tchat/problem.hpp>
struct Ball {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T> void field(int, const T* x, const T* par, T* f) const { f[0] = x[1]; f[1] = -par[0]; }
  template <class T> T event(int, const T* x, const T*) const { return x[0]; }
  template <class T> void jump(int, const T* x, const T* par, T* g) const { g[0] = x[0]; g[1] = -par[1] * x[1]; }
};
TCHAT_PROBLEM(Ball)
)");
  const ProblemLibrary library(resolve_plugin(source, build_options));
  const HybridSystem& system = library.system();
  CHECK(system.name() == "Ball");
  CHECK(system.dimension() == 2);
  const double x[] = {0.5, -3.0}, par[TCHAT_PAR_LENGTH] = {9.81, 0.8};
  double g[2], gx[4], gp[2];
  const int active[] = {2};
  system.first(FunctionKind::jump, 1, x, par, active, g, gx, gp);
  CHECK(g[1] == Approx(2.4));
  CHECK(gx[3] == Approx(-0.8));
  CHECK(gp[1] == Approx(3.0));
}

TEST_CASE("a small C plugin is loaded, its derivatives are differences") {
  const PluginFolder folder;
  const ProblemLibrary library(resolve_plugin(folder.write("small.cpp", small_plugin()), build_options));
  const double x[] = {0.5, -3.0}, par[TCHAT_PAR_LENGTH] = {2.0};
  double f[2], fx[4];
  library.system().first(FunctionKind::field, 1, x, par, {}, f, fx, nullptr);
  CHECK(f[0] == 1.0);
  CHECK(std::abs(fx[0] - 2.0) < 1e-9);
}

TEST_CASE("two plugins of the same class name live side by side") {
  const PluginFolder folder;
  const ProblemLibrary two(resolve_plugin(folder.write("a.cpp", small_plugin()), build_options));
  const ProblemLibrary three(
      resolve_plugin(folder.write("b.cpp", small_plugin("table.dimension = 3;")), build_options));
  CHECK(two.system().dimension() == 2);
  CHECK(three.system().dimension() == 3);
}

TEST_CASE("files that are no plugins") {
  const PluginFolder folder;
  CHECK_THROWS_WITH(ProblemLibrary(folder / "none.so"), Contains("none.so") && Contains("no such file"));
  CHECK_THROWS_WITH(ProblemLibrary(folder / "."), Contains("this is a folder"));
  CHECK_THROWS_WITH(ProblemLibrary(folder.write("text.so", std::string(200, 'x'))),
                    Contains("text.so") && Contains("invalid ELF header") && Contains("not a shared library"));
  CHECK_THROWS_WITH(ProblemLibrary(folder.write("empty.so", "")), Contains("file too short"));
  CHECK_THROWS_WITH(ProblemLibrary("/dev/null"), Contains("not a regular file"));
  CHECK_THROWS_AS(ProblemLibrary(folder / "none.so"), UserError);

  const std::string whole = resolve_plugin(folder.write("small.cpp", small_plugin()), build_options);
  const std::string contents = folder.read("small.so");
  for (const std::size_t length : {contents.size() / 2, contents.size() / 5, std::size_t{100}, std::size_t{10}})
    CHECK_THROWS_AS(ProblemLibrary(folder.write("part.so", contents.substr(0, length))), UserError);
}

TEST_CASE("libraries that are no usable plugins") {
  const std::vector<BadPlugin> cases = {
      {"int answer = 42;", {"does not export tchat_problem_table", "TCHAT_PROBLEM(YourClass)"}},
      {R"(void elsewhere(); extern "C" void* tchat_problem_table() { elsewhere(); return 0; })",
       {"undefined symbol", "elsewhere", "not defined"}},
      {R"(extern "C" __attribute__((visibility("default"))) void* tchat_problem_table() { return 0; })",
       {"returned no table"}},
      {R"(#include <stdexcept>
          extern "C" __attribute__((visibility("default"))) void* tchat_problem_table() {
            throw std::runtime_error("table.txt is missing"); })",
       {"threw an exception: table.txt is missing", "constructor"}},
      {R"(extern "C" __attribute__((visibility("default"))) void* tchat_problem_table() { throw 1; })",
       {"threw an exception"}},
      {R"(extern "C" __attribute__((visibility("default"))) const char tchat_problem_instructions[] = "avx9";
          extern "C" __attribute__((visibility("default"))) void* tchat_problem_table() { __builtin_trap(); })",
       {"compiled for processors with avx9 instructions", "Delete it and give its source"}},
  };
  const PluginFolder folder;
  int number = 0;
  for (const BadPlugin& bad : cases) {
    const std::string name = "bad" + std::to_string(++number);
    const std::string library = resolve_plugin(folder.write(name + ".cpp", bad.source), build_options);
    for (const char* part : bad.message) CHECK_THROWS_WITH(ProblemLibrary(library), Contains(part) && Contains(name));
    CHECK_THROWS_AS(ProblemLibrary(library), UserError);
  }
}

TEST_CASE("a table made before there were boundary value problems still loads, without conditions") {
  const PluginFolder folder;
  // What stands behind its end is not part of it.
  const std::string spoil =
      "table.struct_size = TCHAT_PROBLEM_FIRST_SIZE; table.boundary_conditions = 7; table.integral_conditions = 3;";
  const ProblemLibrary library(resolve_plugin(folder.write("older.cpp", small_plugin(spoil)), build_options));
  CHECK(library.system().boundary_conditions() == 0);
  CHECK(library.system().integral_conditions() == 0);
  const double x[] = {0.5, 0.25}, par[TCHAT_PAR_LENGTH] = {3.0};
  double f[2] = {};
  library.system().value(FunctionKind::field, 1, x, par, f);
  CHECK(f[0] == 1.5);
}

TEST_CASE("a table made before it told of sliding modes still loads, without any") {
  const PluginFolder folder;
  const std::string spoil = "table.struct_size = TCHAT_PROBLEM_SECOND_SIZE; table.sliding_modes = 3;";
  const ProblemLibrary library(resolve_plugin(folder.write("second.cpp", small_plugin(spoil)), build_options));
  CHECK(library.system().sliding_modes().empty());
}

namespace {

/// `first` of a field at each of four points against all of them at once: to the last bit, NaN where one is NaN.
void check_points_at_once(const HybridSystem& system, const std::vector<double>& par, const std::vector<int>& active) {
  constexpr int points = 4;
  const auto n = static_cast<std::size_t>(system.dimension()), q = active.size();
  std::vector<double> x(points * n), f(points * n, 7.0), fx(points * n * n, 7.0), fp(points * n * q, 7.0);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.3 * static_cast<double>(i) - 0.8;
  system.first_at_points(FunctionKind::field, 1, points, x.data(), par.data(), active, f.data(), fx.data(), fp.data());
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> out(n), dx(n * n), dp(n * q);
    system.first(FunctionKind::field, 1, &x[k * n], par.data(), active, out.data(), dx.data(), dp.data());
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    CHECK(std::equal(out.begin(), out.end(), &f[k * n], same));
    CHECK(std::equal(dx.begin(), dx.end(), &fx[k * n * n], same));
    CHECK(std::equal(dp.begin(), dp.end(), &fp[k * n * q], same));
  }
}

const std::vector<double> some_par(TCHAT_PAR_LENGTH, 0.7);

}  // namespace

TEST_CASE("many points at once: what each gives alone, where one cannot be evaluated too") {
  const PluginFolder folder;
  const ProblemLibrary library(resolve_plugin(folder.write("root.cpp", R"(#include <stdexcept>
#include <tchat/problem.hpp>
struct Root {
  static constexpr int dimension = 3, parameters = 2, fields = 1;
  template <class T> void field(int, const T* x, const T* par, T* f) const {
    if (x[1] > 0.0 && x[1] < 0.5) throw std::domain_error("not there");
    f[0] = par[0] * sin(x[1]), f[1] = x[2] * x[0] / par[1], f[2] = sqrt(x[2] + 0.5);
  }
};
TCHAT_PROBLEM(Root)
)"),
                                              build_options));
  REQUIRE(library.system().table().first_at_points != nullptr);
  check_points_at_once(library.system(), some_par, {2});
  check_points_at_once(library.system(), some_par, {});
}

TEST_CASE("a table made before it could be asked for many points at once still loads, and is asked for each") {
  const PluginFolder folder;
  // What stands behind its end is not part of it.
  const std::string spoil = R"(
  table.struct_size = TCHAT_PROBLEM_THIRD_SIZE;
  table.derivative_order = 1;
  table.first = [](const void*, int32_t, int32_t, const double* x, const double* par, const int32_t*, int32_t count,
                   double* out, double* dx, double* dp) {
    out[0] = par[0] * x[0] * x[1], out[1] = x[1];
    dx[0] = par[0] * x[1], dx[1] = 0.0, dx[2] = par[0] * x[0], dx[3] = 1.0;
    for (int32_t k = 0; k < count; ++k) dp[2 * k] = x[0] * x[1], dp[2 * k + 1] = 0.0;
  };
  table.first_at_points = reinterpret_cast<decltype(table.first_at_points)>(table.first);
)";
  const ProblemLibrary library(resolve_plugin(folder.write("third.cpp", small_plugin(spoil)), build_options));
  CHECK(library.system().table().first_at_points == nullptr);
  check_points_at_once(library.system(), some_par, {1});
  const double x[] = {0.5, 0.25, 3.0, -2.0};
  double f[4], fx[8], fp[4];
  library.system().first_at_points(FunctionKind::field, 1, 2, x, some_par.data(), std::vector<int>{1}, f, fx, fp);
  CHECK(f[2] == 0.7 * 3.0 * -2.0);
  CHECK(fx[6] == 0.7 * 3.0);
  CHECK(fp[2] == -6.0);
}

TEST_CASE("many points at once of a minimal table, which has no derivatives: differences at each") {
  const PluginFolder folder;
  const ProblemLibrary library(resolve_plugin(folder.write("plain.cpp", small_plugin()), build_options));
  check_points_at_once(library.system(), some_par, {1});
}

TEST_CASE("an exception on the way through many points makes all of them NaN") {
  const PluginFolder folder;
  const std::string spoil = R"(
  table.derivative_order = 1;
  table.first = [](const void*, int32_t, int32_t, const double*, const double*, const int32_t*, int32_t, double*,
                   double*, double*) {};
  table.first_at_points = [](const void*, int32_t, int32_t, int32_t, const double*, const double*, const int32_t*,
                             int32_t, double* out, double*, double*) { out[0] = 1.0; throw 1; };
)";
  const ProblemLibrary library(resolve_plugin(folder.write("throws.cpp", small_plugin(spoil)), build_options));
  const double x[] = {0.5, 0.25, 3.0, -2.0};
  double values[16] = {};
  library.system().first_at_points(FunctionKind::field, 1, 2, x, some_par.data(), std::vector<int>{1}, values,
                                   values + 4, values + 12);
  for (const double value : values) CHECK(std::isnan(value));
}

TEST_CASE("a table made before second derivatives could be asked for at many points still loads") {
  const PluginFolder folder;
  // What stands behind its end is not part of it.
  const std::string spoil = R"(
  table.struct_size = TCHAT_PROBLEM_FOURTH_SIZE;
  table.second_at_points = reinterpret_cast<decltype(table.second_at_points)>(table.value);
)";
  const ProblemLibrary library(resolve_plugin(folder.write("fourth.cpp", small_plugin(spoil)), build_options));
  CHECK(library.system().table().second_at_points == nullptr);
}

TEST_CASE("a table made before four points could be side by side still loads") {
  const PluginFolder folder;
  // What stands behind its end is not part of it.
  const std::string spoil = R"(
  table.struct_size = TCHAT_PROBLEM_FIFTH_SIZE;
  table.first_in_lanes = reinterpret_cast<decltype(table.first_in_lanes)>(table.value);
)";
  const ProblemLibrary library(resolve_plugin(folder.write("fifth.cpp", small_plugin(spoil)), build_options));
  CHECK_FALSE(library.system().has_first_in_lanes());
}

TEST_CASE("a table made before third derivatives could be asked for at many points still loads") {
  const PluginFolder folder;
  // What stands behind its end is not part of it.
  const std::string spoil = R"(
  table.struct_size = TCHAT_PROBLEM_EIGHTH_SIZE;
  table.third_at_points = reinterpret_cast<decltype(table.third_at_points)>(table.value);
)";
  const ProblemLibrary library(resolve_plugin(folder.write("eighth.cpp", small_plugin(spoil)), build_options));
  CHECK(library.system().table().third_at_points == nullptr);
}

TEST_CASE("an exception on the way through points side by side makes all of them NaN") {
  const PluginFolder folder;
  const std::string spoil = R"(
  table.derivative_order = 1;
  table.first = [](const void*, int32_t, int32_t, const double*, const double*, const int32_t*, int32_t, double*,
                   double*, double*) {};
  table.first_in_lanes = [](const void*, int32_t, int32_t, int32_t, const double*, const double*, const int32_t*,
                            int32_t, double* out, double*, double*) { out[0] = 1.0; throw 1; };
)";
  const ProblemLibrary library(resolve_plugin(folder.write("throws3.cpp", small_plugin(spoil)), build_options));
  REQUIRE(library.system().has_first_in_lanes());
  constexpr int sets = 2, n = 2, points = 4 * sets;
  const double x[points * n] = {};
  std::vector<double> values(points * n * (1 + n + 1), 0.0);
  double* const f = values.data();
  library.system().first_in_lanes(FunctionKind::field, 1, sets, x, some_par.data(), std::vector<int>{1}, f,
                                  f + points * n, f + points * n * (1 + n));
  for (const double value : values) CHECK(std::isnan(value));
}

TEST_CASE("an exception on the way through second derivatives at many points makes all of them NaN") {
  const PluginFolder folder;
  const std::string spoil = R"(
  table.derivative_order = 2;
  table.first = [](const void*, int32_t, int32_t, const double*, const double*, const int32_t*, int32_t, double*,
                   double*, double*) {};
  table.second = [](const void*, int32_t, int32_t, const double*, const double*, const int32_t*, int32_t,
                    const double*, double*, double*, double*) {};
  table.second_at_points = [](const void*, int32_t, int32_t, int32_t, int32_t, const double*, const double*,
                              const int32_t*, int32_t, const double*, const double*, const double*, double* out,
                              double*) { out[0] = 1.0; throw 1; };
)";
  const ProblemLibrary library(resolve_plugin(folder.write("throws2.cpp", small_plugin(spoil)), build_options));
  constexpr int points = 2, directions = 2, n = 2;
  WeightedSecond sums(library.system(), FunctionKind::field, {1}, points, directions);
  sums.compute(1, points, some_par.data());
  for (int i = 0; i < points; ++i) {
    for (int c = 0; c <= n; ++c) CHECK(std::isnan(sums.gradient(i)[c]));
    for (int k = 0; k < directions; ++k)
      for (int a = 0; a < n; ++a) CHECK(std::isnan(sums.directional(i, k)[a]));
  }
}

TEST_CASE("tables that cannot be used") {
  const std::vector<BadPlugin> cases = {
      {"table.sliding_modes = 1;", {"1 sliding modes", "does not list them"}},
      {"static const tchat_sliding mode{1, 2, 3, 1, 1, 1}; table.sliding_modes = 1; table.sliding = &mode;",
       {"a sliding mode of it has the fields 1, 2 and 3, there are 1..1"}},
      {"table.abi_version = 77;", {"interface version is 77", "another tchat", "delete it"}},
      {"table.struct_size = 8;", {"table has 8 bytes", "another tchat"}},
      {"table.dimension = 0;", {"dimension is 0", "allowed are 1..1000"}},
      {"table.dimension = 2000000000;", {"dimension is 2000000000"}},
      {"table.parameters = 1000001;", {"1000001 parameters", "allowed are 0..1000000"}},
      {"table.fields = 0;", {"0 fields", "at least one field"}},
      {"table.name = 0;", {"no name"}},
      {"table.value = 0;", {"no function `value`"}},
      {"table.derivative_order = 1;", {"no function `first`"}},
      {"table.user_values = 2;", {"no function `user_value`"}},
      {"table.boundary_conditions = 2;", {"no function `boundary`"}},
      {"table.integral_conditions = -1;", {"-1 integral conditions", "allowed are 0..1000"}},
  };
  const PluginFolder folder;
  int number = 0;
  for (const BadPlugin& bad : cases) {
    const std::string name = "table" + std::to_string(++number);
    const std::string library = resolve_plugin(folder.write(name + ".cpp", small_plugin(bad.source)), build_options);
    for (const char* part : bad.message) CHECK_THROWS_WITH(ProblemLibrary(library), Contains(part) && Contains(name));
    CHECK_THROWS_AS(ProblemLibrary(library), UserError);
  }
}

TEST_CASE("a plugin that writes NaN is seen by its values") {
  const PluginFolder folder;
  const std::string source = folder.write(
      "nan.cpp", small_plugin("table.value = [](const void*, int32_t, int32_t, const double*, const double*, "
                              "double* out) { out[0] = 0.0 / 0.0; };"));
  const ProblemLibrary library(resolve_plugin(source, build_options));
  const double x[] = {0.5, -3.0}, par[TCHAT_PAR_LENGTH] = {};
  CHECK(std::isnan(library.system().event(1, x, par)));
}
