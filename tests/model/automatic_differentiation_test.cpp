#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>
#include <vector>

#include "hand_differentiated.hpp"
#include "linear_oscillator.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"

namespace {
long allocations = 0;
}  // namespace

// Counts the allocations of this test program; what is allocated and freed must match, so all are replaced. Inlined,
// g++ takes malloc and delete, or new and free, for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Evaluated {
  VectorXd value;
  MatrixXd derivative;  // by states, then by the active parameters
};

Evaluated first(const HybridSystem& system, FunctionKind kind, const VectorXd& x, const VectorXd& par,
                const std::vector<int>& active, int index = 1) {
  const int rows = kind == FunctionKind::event ? 1 : system.dimension();
  Evaluated e{VectorXd(rows), MatrixXd(rows, system.dimension() + active.size())};
  system.first(kind, index, x.data(), par.data(), active, e.value.data(), e.derivative.data(),
               e.derivative.data() + rows * system.dimension());
  return e;
}

Evaluated second(const HybridSystem& system, FunctionKind kind, const VectorXd& x, const VectorXd& par,
                 const std::vector<int>& active, const VectorXd& direction, int index = 1) {
  const int rows = kind == FunctionKind::event ? 1 : system.dimension();
  Evaluated e{VectorXd(rows), MatrixXd(rows, system.dimension() + active.size())};
  system.second(kind, index, x.data(), par.data(), active, direction.data(), e.value.data(), e.derivative.data(),
                e.derivative.data() + rows * system.dimension());
  return e;
}

VectorXd full(const VectorXd& par) {
  VectorXd all = VectorXd::Zero(ParameterLayout().room());
  all.head(par.size()) = par;
  return all;
}

/// |a - b| <= 1e-13 relative to the larger of 1 and |b|.
void check_close(double a, double b) { CHECK(a == Approx(b).epsilon(1e-13).margin(1e-13)); }

std::vector<Exact> exact_rows(FunctionKind kind, const Point7& z) {
  if (kind == FunctionKind::event) return {exact_event(z)};
  if (kind == FunctionKind::jump) return {exact_jump_1(z), exact_jump_2(z), exact_jump_3(z)};
  return {exact_field_1(z), exact_field_2(z), exact_field_3(z)};
}

constexpr FunctionKind kinds[] = {FunctionKind::field, FunctionKind::event, FunctionKind::jump};

}  // namespace

TEST_CASE("first and second derivatives of a nonlinear problem agree with hand-written ones") {
  const HybridSystem system(*ProblemTable<NonlinearProblem>::get("nonlinear"));
  std::vector<Point7> points(3);
  points[0] << 0.7, -0.4, 1.3, 1.9, 0.8, -1.1, 2.3;
  points[1] << -1.2, 0.9, 0.6, -0.7, 1.5, 0.4, -1.4;  // the other side of the conditionals
  points[2] << 0.3, 2.1, 1.7, 2.2, -0.9, 0.2, 0.5;
  const std::vector<int> active = {3, 1, 4, 2};  // any order
  const std::vector<int> columns = {X1, X2, X3, P3, P1, P4, P2};
  for (const Point7& z : points) {
    const VectorXd x = z.head(3);
    const VectorXd par = full(z.tail(4));
    for (const FunctionKind kind : kinds) {
      const std::vector<Exact> exact = exact_rows(kind, z);
      const Evaluated f = first(system, kind, x, par, active);
      for (std::size_t r = 0; r < exact.size(); ++r) {
        check_close(f.value[r], exact[r].value);
        for (std::size_t c = 0; c < 7; ++c) check_close(f.derivative(r, c), exact[r].gradient[columns[c]]);
      }
      VectorXd direction(7);
      direction << 0.3, -1.2, 0.5, 0.9, -0.6, 1.4, 0.2;
      const Evaluated d = second(system, kind, x, par, active, direction);
      Point7 v;
      for (std::size_t c = 0; c < 7; ++c) v[columns[c]] = direction[c];
      for (std::size_t r = 0; r < exact.size(); ++r) {
        check_close(d.value[r], exact[r].gradient.dot(v));
        const Point7 expected = exact[r].hessian * v;
        for (std::size_t c = 0; c < 7; ++c) check_close(d.derivative(r, c), expected[columns[c]]);
      }
    }
  }
}

TEST_CASE("derivatives by fewer parameters, none, and by parameters that the problem does not own") {
  const HybridSystem system(*ProblemTable<NonlinearProblem>::get("nonlinear"));
  Point7 z;
  z << 0.7, -0.4, 1.3, 1.9, 0.8, -1.1, 2.3;
  const VectorXd x = z.head(3);
  const VectorXd par = full(z.tail(4));
  const Exact exact = exact_field_1(z);
  const Evaluated none = first(system, FunctionKind::field, x, par, {});
  for (int c = 0; c < 3; ++c) check_close(none.derivative(0, c), exact.gradient[c]);
  const Evaluated foreign = first(system, FunctionKind::field, x, par, {61, 2, 5});
  CHECK(foreign.derivative(0, 3) == 0.0);
  check_close(foreign.derivative(0, 4), exact.gradient[P2]);
  CHECK(foreign.derivative(0, 5) == 0.0);
}

TEST_CASE("linear oscillator: derivatives agree with hand-written ones") {
  const HybridSystem system(*ProblemTable<LinearOscillator>::get("linosc"));
  VectorXd x(4), par(4);
  x << 0.4, -0.7, 0.6, -0.9;
  par << 3.0, 1.7, 0.05, 0.8;
  const double y1 = x[2], y2 = x[3], omega = par[1];
  const Evaluated f = first(system, FunctionKind::field, x, full(par), {1, 2, 3, 4});
  MatrixXd expected(4, 8);
  expected << 0, 1, 0, 0, 0, 0, 0, 0,                                     //
      -1, -2 * par[2], 0, par[0], y2, 0, -2 * x[1], 0,                    //
      0, 0, 1 - 3 * y1 * y1 - y2 * y2, omega - 2 * y1 * y2, 0, y2, 0, 0,  //
      0, 0, -omega - 2 * y1 * y2, 1 - y1 * y1 - 3 * y2 * y2, 0, -y1, 0, 0;
  CHECK((f.derivative - expected).lpNorm<Eigen::Infinity>() < 1e-14);

  const VectorXd e3 = VectorXd::Unit(8, 2);  // along y1
  const Evaluated d = second(system, FunctionKind::field, x, full(par), {1, 2, 3, 4}, e3);
  MatrixXd expected_second = MatrixXd::Zero(4, 8);
  expected_second(2, 2) = -6 * y1;
  expected_second(2, 3) = -2 * y2;
  expected_second(3, 2) = -2 * y2;
  expected_second(3, 3) = -2 * y1;
  expected_second(3, 5) = -1;
  CHECK((d.derivative - expected_second).lpNorm<Eigen::Infinity>() < 1e-14);
  CHECK((d.value - expected.col(2)).lpNorm<Eigen::Infinity>() < 1e-14);

  const Evaluated g = first(system, FunctionKind::jump, x, full(par), {4});
  CHECK(g.value[1] == Approx(-0.8 * x[1]));
  CHECK(g.derivative(1, 1) == Approx(-0.8));
  CHECK(g.derivative(1, 4) == Approx(-x[1]));
}

namespace {

/// More states than derivatives are carried at once.
struct LongChain {
  static constexpr int dimension = 19, parameters = 3, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    for (int i = 0; i < 19; ++i) f[i] = x[i] * x[(i + 1) % 19] * p[0] + sin(x[i]) * p[1];
  }
  template <class T>
  T event(int, const T* x, const T* p) const {
    T sum = p[2];
    for (int i = 0; i < 19; ++i) sum += x[i] * x[i];
    return sum;
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 19; ++i) g[i] = x[i];
  }
};

}  // namespace

TEST_CASE("more states than derivatives at once") {
  const HybridSystem system(*ProblemTable<LongChain>::get("chain"));
  constexpr int n = 19;
  VectorXd x(n), direction(n + 3), par(3);
  for (int i = 0; i < n; ++i) x[i] = 0.1 * i - 0.7;
  for (int i = 0; i < n + 3; ++i) direction[i] = std::cos(1.0 + i);
  par << 0.7, -1.3, 0.4;
  const Evaluated f = first(system, FunctionKind::field, x, full(par), {1, 2, 3});
  const Evaluated d = second(system, FunctionKind::field, x, full(par), {1, 2, 3}, direction);
  MatrixXd fx = MatrixXd::Zero(n, n + 3), dx = MatrixXd::Zero(n, n + 3);
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    fx(i, i) = x[j] * par[0] + std::cos(x[i]) * par[1];
    fx(i, j) = x[i] * par[0];
    fx(i, n) = x[i] * x[j];
    fx(i, n + 1) = std::sin(x[i]);
    dx(i, i) = par[0] * direction[j] - std::sin(x[i]) * par[1] * direction[i] + x[j] * direction[n] +
               std::cos(x[i]) * direction[n + 1];
    dx(i, j) = par[0] * direction[i] + x[i] * direction[n];
    dx(i, n) = x[j] * direction[i] + x[i] * direction[j];
    dx(i, n + 1) = std::cos(x[i]) * direction[i];
  }
  CHECK((f.derivative - fx).lpNorm<Eigen::Infinity>() < 1e-13);
  CHECK((d.derivative - dx).lpNorm<Eigen::Infinity>() < 1e-13);
  CHECK((d.value - fx * direction).lpNorm<Eigen::Infinity>() < 1e-13);
  const Evaluated h = first(system, FunctionKind::event, x, full(par), {1, 2, 3});
  for (int i = 0; i < n; ++i) check_close(h.derivative(0, i), 2 * x[i]);
  CHECK(h.derivative(0, n + 2) == 1.0);
}

TEST_CASE("evaluation does not allocate") {
  const HybridSystem chain(*ProblemTable<LongChain>::get("chain"));
  const HybridSystem nonlinear(*ProblemTable<NonlinearProblem>::get("nonlinear"));
  const VectorXd x = VectorXd::Constant(19, 0.5), par = full(VectorXd::Constant(4, 0.3)),
                 direction = VectorXd::Ones(30);
  const std::vector<int> active = {1, 2, 61};
  VectorXd out(19), dx(19 * 19), dp(19 * 3);
  const long before = allocations;
  for (const HybridSystem* system : {&chain, &nonlinear})
    for (const FunctionKind kind : kinds) {
      system->value(kind, 1, x.data(), par.data(), out.data());
      system->first(kind, 1, x.data(), par.data(), active, out.data(), dx.data(), dp.data());
      system->second(kind, 1, x.data(), par.data(), active, direction.data(), out.data(), dx.data(), dp.data());
    }
  CHECK(allocations == before);
  ::operator delete(::operator new(8));  // the counter counts
  CHECK(allocations > before);
}

namespace {

using Scalar = Dual<1, Dual<1>>;

/// phi, phi', phi'' at t by nested dual numbers, against given values.
template <class Function>
void check_function(const char* name, const Function& function, double t, double value, double slope,
                    double curvature) {
  INFO(name << " at " << t);
  Scalar x(t);
  x.value.derivative[0] = 1.0;
  x.derivative[0].value = 1.0;
  const Scalar y = function(x);
  check_close(y.value.value, value);
  check_close(y.value.derivative[0], slope);
  check_close(y.derivative[0].value, slope);
  check_close(y.derivative[0].derivative[0], curvature);
}

}  // namespace

TEST_CASE("every function of a dual number") {
  const double t = 0.37, ln2 = std::log(2.0), ln10 = std::log(10.0), q = 1 - t * t, c = std::cos(t);
  const double e = std::exp(t), th = std::tanh(t), r = std::sqrt(t);
#define CHECK_FUNCTION(F, ...) \
  check_function(              \
      #F, [](const Scalar& x) { return F; }, t, __VA_ARGS__)
  CHECK_FUNCTION(sin(x), std::sin(t), c, -std::sin(t));
  CHECK_FUNCTION(cos(x), c, -std::sin(t), -c);
  CHECK_FUNCTION(tan(x), std::tan(t), 1 / (c * c), 2 * std::tan(t) / (c * c));
  CHECK_FUNCTION(asin(x), std::asin(t), 1 / std::sqrt(q), t / (q * std::sqrt(q)));
  CHECK_FUNCTION(acos(x), std::acos(t), -1 / std::sqrt(q), -t / (q * std::sqrt(q)));
  CHECK_FUNCTION(atan(x), std::atan(t), 1 / (1 + t * t), -2 * t / ((1 + t * t) * (1 + t * t)));
  CHECK_FUNCTION(sinh(x), std::sinh(t), std::cosh(t), std::sinh(t));
  CHECK_FUNCTION(cosh(x), std::cosh(t), std::sinh(t), std::cosh(t));
  CHECK_FUNCTION(tanh(x), th, 1 - th * th, -2 * th * (1 - th * th));
  CHECK_FUNCTION(asinh(x), std::asinh(t), 1 / std::sqrt(1 + t * t), -t / std::pow(1 + t * t, 1.5));
  CHECK_FUNCTION(atanh(x), std::atanh(t), 1 / q, 2 * t / (q * q));
  CHECK_FUNCTION(acosh(x + 1.0), std::acosh(t + 1), 1 / std::sqrt(t * t + 2 * t),
                 -(t + 1) / std::pow(t * t + 2 * t, 1.5));
  CHECK_FUNCTION(exp(x), e, e, e);
  CHECK_FUNCTION(exp2(x), std::exp2(t), ln2 * std::exp2(t), ln2 * ln2 * std::exp2(t));
  CHECK_FUNCTION(expm1(x), std::expm1(t), e, e);
  CHECK_FUNCTION(log(x), std::log(t), 1 / t, -1 / (t * t));
  CHECK_FUNCTION(log2(x), std::log(t) / ln2, 1 / (t * ln2), -1 / (t * t * ln2));
  CHECK_FUNCTION(log10(x), std::log(t) / ln10, 1 / (t * ln10), -1 / (t * t * ln10));
  CHECK_FUNCTION(log1p(x), std::log1p(t), 1 / (1 + t), -1 / ((1 + t) * (1 + t)));
  CHECK_FUNCTION(sqrt(x), r, 0.5 / r, -0.25 / (r * t));
  CHECK_FUNCTION(cbrt(x), std::cbrt(t), std::cbrt(t) / (3 * t), -2 * std::cbrt(t) / (9 * t * t));
  CHECK_FUNCTION(pow(x, 2.5), t * t * r, 2.5 * t * r, 3.75 * r);
  CHECK_FUNCTION(pow(x, -2), 1 / (t * t), -2 / (t * t * t), 6 / (t * t * t * t));
  CHECK_FUNCTION(pow(3.0, x), std::pow(3, t), std::log(3.0) * std::pow(3, t),
                 std::pow(std::log(3.0), 2) * std::pow(3, t));
  CHECK_FUNCTION(pow(x, x), std::pow(t, t), std::pow(t, t) * (1 + std::log(t)),
                 std::pow(t, t) * (std::pow(1 + std::log(t), 2) + 1 / t));
  CHECK_FUNCTION(fabs(-x), t, 1, 0);
  CHECK_FUNCTION(atan2(x, 2.0), std::atan2(t, 2), 2 / (4 + t * t), -4 * t / ((4 + t * t) * (4 + t * t)));
  CHECK_FUNCTION(hypot(x, 2.0), std::sqrt(4 + t * t), t / std::sqrt(4 + t * t), 4 / std::pow(4 + t * t, 1.5));
  CHECK_FUNCTION(min(x * x, 3.0), t * t, 2 * t, 2);
  CHECK_FUNCTION(max(x * x, -3.0), t * t, 2 * t, 2);
  CHECK_FUNCTION(2.0 / x, 2 / t, -2 / (t * t), 4 / (t * t * t));
  CHECK_FUNCTION(3 - x * 2 + x / 4, 3 - 1.75 * t, -1.75, 0);
#undef CHECK_FUNCTION
}

TEST_CASE("powers at a zero base") {
  const auto at_zero = [](const char* name, auto function, double value, double slope, double curvature) {
    check_function(name, function, 0.0, value, slope, curvature);
  };
  at_zero(
      "x^1", [](const Scalar& x) { return pow(x, 1); }, 0, 1, 0);
  at_zero(
      "x^2", [](const Scalar& x) { return pow(x, 2); }, 0, 0, 2);
  at_zero(
      "x^3", [](const Scalar& x) { return pow(x, 3); }, 0, 0, 0);
  at_zero(
      "x^0", [](const Scalar& x) { return pow(x, 0); }, 1, 0, 0);
  at_zero(
      "x^p, p = 1", [](const Scalar& x) { return pow(x, Scalar(1.0)); }, 0, 1, 0);
  at_zero(
      "x^p, p = 2", [](const Scalar& x) { return pow(x, Scalar(2.0)); }, 0, 0, 2);
  at_zero(
      "x^p, p = 0", [](const Scalar& x) { return pow(x, Scalar(0.0)); }, 1, 0, 0);
}
