// Sliding modes that tchat makes: Filippov's field and the event functions at its ends, with first and second
// derivatives, against the same formulas with the gradient of h worked out by hand.
#include <Eigen/Dense>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>
#include <tchat/problem.hpp>
#include <vector>

#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;
using Eigen::VectorXd;

namespace {

/// Two fields and a curved surface that moves with the parameters.
struct Sides {
  static constexpr int dimension = 3, parameters = 2, jumps = 1;

  template <class T>
  static void side(int i, const T* x, const T* p, T* f) {
    f[0] = i == 1 ? T(-p[0] + x[1] * x[2]) : T(1.5 + sin(x[2]));
    f[1] = x[0] * p[1] + (i == 1 ? cos(x[1]) : -x[1] * x[1]);
    f[2] = i == 1 ? T(exp(-x[0])) : T(p[0] * x[2] - 0.3);
  }
  template <class T>
  static T surface(const T* x, const T* p) {
    return x[0] * x[0] + p[0] * x[1] - sin(p[1] * x[2]);
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int k = 0; k < dimension; ++k) g[k] = x[k];
  }
};

struct ByTchat : Sides {
  static constexpr int fields = 3, events = 4;
  static constexpr tchat::Sliding sliding{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3, .to_plus = 4};
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    side(i, x, p, f);
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? surface(x, p) : -surface(x, p);
  }
};

struct ByHand : Sides {
  static constexpr int fields = 3, events = 4;
  template <class T>
  static T rate(const T* f, const T* x, const T* p) {
    return 2.0 * x[0] * f[0] + p[0] * f[1] - p[1] * cos(p[1] * x[2]) * f[2];
  }
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    if (i < 3) return side(i, x, p, f);
    std::array<T, 3> plus, minus;
    side(1, x, p, plus.data());
    side(2, x, p, minus.data());
    const T below = rate(minus.data(), x, p), above = rate(plus.data(), x, p);
    for (std::size_t k = 0; k < 3; ++k) f[k] = (below * plus[k] - above * minus[k]) / (below - above);
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    if (j < 3) return j == 1 ? surface(x, p) : T(-surface(x, p));
    std::array<T, 3> f;
    side(j == 3 ? 2 : 1, x, p, f.data());
    return j == 3 ? rate(f.data(), x, p) : T(-rate(f.data(), x, p));
  }
};

/// F, all its derivatives and those of its derivative in a direction, one after the other.
VectorXd all_of(const HybridSystem& system, FunctionKind kind, int index) {
  const double x[] = {0.7, -0.4, 1.1};
  std::vector<double> par(TCHAT_PAR_LENGTH);
  par[0] = 0.9, par[1] = 1.3;
  const int active[] = {2, 1};
  const double direction[] = {0.3, -1.2, 0.5, 0.8, -0.6};
  const int r = system.rows(kind);
  VectorXd all(12 * r);
  double* out = all.data();
  system.first(kind, index, x, par.data(), active, out, out + r, out + 4 * r);
  out += 6 * r;
  system.second(kind, index, x, par.data(), active, direction, out, out + r, out + 4 * r);
  return all;
}

/// Forward: b (h), backward: a; x = (h, y).
struct Plane {
  static constexpr int dimension = 2, parameters = 2, fields = 3, events = 4, jumps = 1;
  static constexpr tchat::Sliding sliding[] = {
      {.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3, .to_plus = 4}};
  template <class T>
  void field(int i, const T*, const T* p, T* f) const {
    f[0] = i == 1 ? p[0] : p[1];
    f[1] = T(1.0);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : -2.0 * x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

int next(std::array<int, 3> from, double h, double above, double below) {
  const double x[] = {h, 0.3}, par[] = {above, below};
  return next_field(Plane{}, Plane::sliding[0], from, x, par);
}

Orbit orbit_at(double h, double above, double below) {
  Orbit x;
  x.shape = {2, 2, 1, 2};
  x.mesh = uniform_mesh(1);
  x.states = Eigen::MatrixXd::Zero(2, x.shape.columns());
  x.states.row(0).setConstant(h);
  x.par = ParameterVector(ParameterLayout());
  x.par(0) = above, x.par(1) = below;
  x.duration(0) = x.duration(1) = 1.0;
  return x;
}

std::vector<std::string> told(const Signature& signature, double h, double above, double below,
                              const std::vector<int>& monitored = {}) {
  const HybridSystem& system = system_of<Plane>();
  std::vector<Violation> found;
  add_sliding_violations(found, system, signature, monitored, orbit_at(h, above, below), 1, 1e-9);
  std::vector<std::string> texts;
  for (const Violation& violation : found) texts.push_back(describe(violation, system));
  return texts;
}

}  // namespace

TEST_CASE("sliding: the field, where it ends, and their first and second derivatives are those of the formulas") {
  const HybridSystem &made = system_of<ByTchat>(), &written = system_of<ByHand>();
  const auto check = [&](FunctionKind kind, int index) {
    const VectorXd expected = all_of(written, kind, index);
    CAPTURE(static_cast<int>(kind), index, expected.transpose());
    CHECK((all_of(made, kind, index) - expected).cwiseAbs().maxCoeff() < 1e-13 * expected.cwiseAbs().maxCoeff());
  };
  for (const int i : {1, 2, 3}) check(FunctionKind::field, i);
  for (const int j : {1, 2, 3, 4}) check(FunctionKind::event, j);
  REQUIRE(made.sliding_modes().size() == 1);
  CHECK(made.sliding_mode(3)->surface == 1);
  CHECK(made.sliding_mode(2) == nullptr);
  CHECK(written.sliding_modes().empty());
}

TEST_CASE("sliding leaves h as it is: the field is tangent to every level of it") {
  const double x[] = {0.7, -0.4, 1.1}, par[TCHAT_PAR_LENGTH] = {0.9, 1.3};
  const EventAt at = event_at(system_of<ByTchat>(), 1, 3, x, par);
  CHECK(std::abs(at.rate()) < 1e-15 * at.sizes());
}

TEST_CASE("at a two-fold the sliding field has no value, and its ends have theirs") {
  const double x[] = {0.0, 0.0};
  double par[TCHAT_PAR_LENGTH] = {0.0, 0.0};
  double f[2];
  system_of<Plane>().value(FunctionKind::field, 3, x, par, f);
  CHECK(!std::isfinite(f[0]));
  CHECK(system_of<Plane>().event(3, x, par) == 0.0);
  CHECK(system_of<Plane>().event(4, x, par) == 0.0);
}

TEST_CASE("the field that comes next at a surface on which orbits may slide") {
  const std::array<int, 3> start{0, 0, 0}, from_above{1, 1, 1}, from_below{2, 2, 1};
  CHECK(next(start, 0.5, -1, 1) == 1);
  CHECK(next(start, -0.5, -1, 1) == 2);
  CHECK(next(start, 0.0, -1, 1) == 3);
  CHECK(next(start, 0.0, 1, 1) == 1);
  CHECK(next(start, 0.0, -1, -1) == 2);
  CHECK_THROWS_AS(next(start, 0.0, 1, -1), NoValue);
  CHECK(next(from_above, 1e-13, -1, 1) == 3);
  CHECK(next(from_above, 1e-13, -1, -1) == 2);
  CHECK(next(from_below, -1e-13, 1, 1) == 1);
  CHECK(next(from_below, -1e-13, -1, 1) == 3);
  // What would follow the event of the surface, asked elsewhere: event 2 is -2 h.
  CHECK(next(from_below, -0.5, -1, 1) == 3);
  // A grazing orbit comes back to the surface with h_x f = 0: the side it comes from does not count.
  CHECK(next(from_above, 0.0, 1e-12, 1) == 3);
  CHECK(next({3, 3, 1}, 0.0, -1, 0.0) == 2);
  CHECK(next({3, 4, 1}, 0.0, 0.0, 1) == 1);
}

TEST_CASE("a segment that must not slide where it does, or slides where it must not") {
  const Signature slides{{1, 1, 1}, {3, 3, 1}}, crosses{{1, 1, 1}, {2, 2, 1}};
  CHECK(told(slides, 0.0, -1.0, 1.0).empty());
  const auto away = told(slides, 0.0, 0.5, 1.0);  // event 3 ends the segment, so that it says nothing of the other side
  REQUIRE(away.size() == 1);
  CHECK_THAT(away[0], Contains("segment 2 slides where field 1 (field 1) leads away from the surface, |h_x f| = 0.5"));
  CHECK(told(slides, 0.0, 0.5, 1.0, {3, 4}).empty());  // told as the value of event function 4
  const auto beside = told(slides, 0.25, -1.0, 1.0);
  REQUIRE(beside.size() == 1);
  CHECK_THAT(beside[0], Contains("segment 2 slides beside its surface: h1 (event 1) = 0.25 at its start"));
  CHECK(told(crosses, 0.0, -1.0, -1.0).empty());
  const auto back = told(crosses, 0.0, -1.0, 0.5);
  REQUIRE(back.size() == 1);
  CHECK_THAT(back[0], Contains("segment 2 begins on a surface that its field 2 (field 2) leads back to") &&
                          Contains("the orbit slides there"));
  CHECK(told(crosses, 0.25, -1.0, 0.5).empty());  // the field changes for another reason
}
