#include "model/hybrid_system.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "hand_differentiated.hpp"
#include "linear_oscillator.hpp"
#include "model/parameter_vector.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const tchat_problem& linosc_table() { return *ProblemTable<LinearOscillator>::get("linosc"); }
const tchat_problem& nonlinear_table() { return *ProblemTable<NonlinearProblem>::get("nonlinear"); }

struct RefusedTable {
  const char* message;
  std::function<void(tchat_problem&)> spoil;
};

}  // namespace

TEST_CASE("names of states, parameters and functions") {
  const HybridSystem linosc(linosc_table());
  CHECK(linosc.name() == "linosc");
  CHECK(linosc.dimension() == 4);
  CHECK(linosc.parameters() == 4);
  CHECK(linosc.count(FunctionKind::field) == 1);
  CHECK(linosc.count(FunctionKind::event) == 3);
  CHECK(linosc.count(FunctionKind::jump) == 2);
  CHECK(linosc.state_name(3) == "y1");
  CHECK(linosc.parameter_name(2) == "omega");
  CHECK(linosc.parameter_name(61) == "T1");
  CHECK(linosc.function_name(FunctionKind::event, 2) == "maximum of x1");
  CHECK(linosc.function_name(FunctionKind::jump, 1) == "impact");
  CHECK(linosc.parameter_index("omega") == 2);
  CHECK(linosc.parameter_index("Omega") == 0);

  const HybridSystem unnamed(nonlinear_table());
  CHECK(unnamed.state_name(2) == "U(2)");
  CHECK(unnamed.parameter_name(4) == "PAR(4)");
  CHECK(unnamed.function_name(FunctionKind::field, 1) == "field 1");
  CHECK(unnamed.function_name(FunctionKind::event, 1) == "event 1");
  CHECK(unnamed.function_name(FunctionKind::jump, 1) == "jump 1");
  CHECK(unnamed.parameter_index("PAR(1)") == 0);
}

TEST_CASE("names may be left out one by one") {
  const char* const some[] = {nullptr, "omega", nullptr, "r"};
  tchat_problem table = linosc_table();
  table.parameter_names = table.state_names = some;
  const HybridSystem system(table);
  CHECK(system.parameter_name(1) == "PAR(1)");
  CHECK(system.state_name(3) == "U(3)");
  CHECK(system.parameter_index("omega") == 2);
  CHECK(system.parameter_index("r") == 4);
  CHECK(system.parameter_index("alpha") == 0);
}

TEST_CASE("an unusable table is refused") {
  const std::vector<RefusedTable> cases = {
      {"interface version is 99", [](tchat_problem& t) { t.abi_version = 99; }},
      {"bytes", [](tchat_problem& t) { t.struct_size = 12; }},
      {"no name", [](tchat_problem& t) { t.name = nullptr; }},
      {"dimension is 0", [](tchat_problem& t) { t.dimension = 0; }},
      {"dimension is -3", [](tchat_problem& t) { t.dimension = -3; }},
      {"dimension is 100001", [](tchat_problem& t) { t.dimension = 100001; }},
      {"1000001 parameters", [](tchat_problem& t) { t.parameters = 1000001; }},
      {"-1 parameters", [](tchat_problem& t) { t.parameters = -1; }},
      {"0 fields", [](tchat_problem& t) { t.fields = 0; }},
      {"-1 events", [](tchat_problem& t) { t.events = -1; }},
      {"-1 jumps", [](tchat_problem& t) { t.jumps = -1; }},
      {"no function `value`", [](tchat_problem& t) { t.value = nullptr; }},
      {"no function `first`", [](tchat_problem& t) { t.first = nullptr; }},
      {"no function `second`", [](tchat_problem& t) { t.second = nullptr; }},
      {"no function `user_value`", [](tchat_problem& t) { t.user_values = 1, t.user_value = nullptr; }},
  };
  for (const RefusedTable& refused : cases) {
    tchat_problem table = linosc_table();
    refused.spoil(table);
    CHECK_THROWS_WITH(HybridSystem(table), Contains(refused.message));
    CHECK_THROWS_AS(HybridSystem(table), std::invalid_argument);
  }
  CHECK_NOTHROW(HybridSystem(linosc_table()));
}

TEST_CASE("central differences where the table has no derivatives") {
  Point7 z;
  z << 0.7, -0.4, 1.3, 1.9, 0.8, -1.1, 2.3;
  const VectorXd x = z.head(3);
  VectorXd par = VectorXd::Zero(ParameterLayout().room());
  par.head(4) = z.tail(4);
  const std::vector<int> active = {1, 2, 3, 4};
  VectorXd direction(7);
  direction << 0.3, -1.2, 0.5, 0.9, -0.6, 1.4, 0.2;
  const Exact exact[] = {exact_field_1(z), exact_field_2(z), exact_field_3(z)};

  tchat_problem table = nonlinear_table();
  for (const int order : {0, 1}) {
    table.derivative_order = order;
    const HybridSystem system(table);
    VectorXd f(3), d(3);
    MatrixXd first(3, 7), second(3, 7);
    system.first(FunctionKind::field, 1, x.data(), par.data(), active, f.data(), first.data(), first.data() + 9);
    system.second(FunctionKind::field, 1, x.data(), par.data(), active, direction.data(), d.data(), second.data(),
                  second.data() + 9);
    for (int r = 0; r < 3; ++r) {
      CHECK(f[r] == Approx(exact[r].value).epsilon(1e-14));
      CHECK((first.row(r).transpose() - exact[r].gradient).lpNorm<Eigen::Infinity>() < (order == 0 ? 3e-9 : 1e-13));
      CHECK(d[r] == Approx(exact[r].gradient.dot(direction)).margin(order == 0 ? 1e-8 : 1e-13));
      const Point7 expected = exact[r].hessian * direction;
      CHECK((second.row(r).transpose() - expected).lpNorm<Eigen::Infinity>() < (order == 0 ? 2e-4 : 3e-9));
    }
  }
}

TEST_CASE("differences are exact for linear functions and reach all parameters of linosc") {
  tchat_problem table = linosc_table();
  table.derivative_order = 0;
  const HybridSystem system(table);
  VectorXd x(4), par = VectorXd::Zero(ParameterLayout().room());
  x << 0.4, -0.7, 0.6, -0.9;
  par.head(4) << 3.0, 1.7, 0.05, 0.8;
  const std::vector<int> active = {4};
  VectorXd g(4);
  MatrixXd first(4, 5);
  system.first(FunctionKind::jump, 1, x.data(), par.data(), active, g.data(), first.data(), first.data() + 16);
  MatrixXd expected = MatrixXd::Identity(4, 5);
  expected(1, 1) = -0.8;
  expected(1, 4) = 0.7;
  CHECK((first - expected).lpNorm<Eigen::Infinity>() < 1e-9);
  double h = 0.0;
  VectorXd hx(4);
  double hp = 5.0;
  system.first(FunctionKind::event, 3, x.data(), par.data(), active, &h, hx.data(), &hp);
  CHECK(h == Approx(0.7));
  CHECK((hx - VectorXd(-VectorXd::Unit(4, 1))).lpNorm<Eigen::Infinity>() < 1e-9);
  CHECK(std::abs(hp) < 1e-9);
}

namespace {

struct Awkward {
  static constexpr int dimension = 2, parameters = 1, fields = 3, events = 1, jumps = 1;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = x[1] * p[0];
    if (i == 2) throw 1;  // not evaluable
    if (i == 1) f[1] = x[0];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

}  // namespace

TEST_CASE("an output left unset, or an exception, becomes NaN") {
  const HybridSystem system(*ProblemTable<Awkward>::get("awkward"));
  const VectorXd x = VectorXd::Constant(2, 1.5), par = VectorXd::Constant(ParameterLayout().room(), 2.0);
  VectorXd f(2);
  MatrixXd fx(2, 2);
  system.value(FunctionKind::field, 1, x.data(), par.data(), f.data());
  CHECK(all_finite(f.data(), 2));
  system.value(FunctionKind::field, 3, x.data(), par.data(), f.data());
  CHECK(f[0] == 3.0);
  CHECK(std::isnan(f[1]));
  system.value(FunctionKind::field, 2, x.data(), par.data(), f.data());
  CHECK(std::isnan(f[0]));
  CHECK_NOTHROW(system.first(FunctionKind::field, 2, x.data(), par.data(), {}, f.data(), fx.data(), nullptr));
  CHECK_FALSE(all_finite(f.data(), 2));
}

namespace {

/// A ball that sticks when it lands slowly: what follows the impact depends on the velocity after it.
struct Landing {
  static constexpr int dimension = 2, parameters = 1, fields = 2, events = 1, jumps = 1;
  template <class T>
  void field(int i, const T* x, const T*, T* f) const {
    f[0] = i == 1 ? x[1] : T(0.0), f[1] = T(i == 1 ? -1.0 : 0.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0], g[1] = -p[0] * x[1];
  }
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double* par) const {
    if (from[0] == 0) return {};
    if (std::isnan(x[1])) throw 1;
    if (from[0] == 3) return std::vector<std::array<int, 3>>(100, from);
    double g[2];
    jump(from[2], x, par, g);
    if (g[1] > 0.1) return {{1, 1, 1}};
    return {{2, 1, 1}, {1, 1, 1}};
  }
};

}  // namespace

TEST_CASE("index jump function of the state, and of the index vector alone") {
  const HybridSystem landing(*ProblemTable<Landing>::get("landing"));
  const double par[] = {0.5}, fast[] = {0.0, -1.0}, slow[] = {0.0, -0.1}, broken[] = {0.0, NAN};
  REQUIRE(landing.has_successors());
  using Next = std::vector<IndexVector>;
  CHECK(landing.successors({1, 1, 1}, fast, par) == Next{{1, 1, 1}});
  CHECK(landing.successors({1, 1, 1}, slow, par) == Next{{2, 1, 1}, {1, 1, 1}});
  CHECK(landing.successors({0, 0, 0}, fast, par) == Next{});
  CHECK(landing.successors({3, 1, 1}, fast, par) == Next(100, {3, 1, 1}));
  CHECK_FALSE(landing.successors({1, 1, 1}, broken, par).has_value());

  const HybridSystem linosc(linosc_table());
  const double x[] = {1.0, 0.5, 0.0, 1.0};
  CHECK(linosc.successors({1, 1, 1}, x, par) == Next{{1, 1, 1}, {1, 2, 2}});
  const HybridSystem silent(nonlinear_table());
  CHECK_FALSE(silent.has_successors());
  CHECK_FALSE(silent.successors({1, 1, 1}, x, par).has_value());
}

TEST_CASE("all_finite") {
  const double values[] = {1.0, 1e308, 1e308, -1e308, INFINITY, NAN, -INFINITY};
  CHECK(all_finite(values, 4));
  CHECK_FALSE(all_finite(values, 5));
  CHECK_FALSE(all_finite(values + 5, 1));
  CHECK_FALSE(all_finite(values + 4, 3));
  CHECK(all_finite(values, 0));
}
