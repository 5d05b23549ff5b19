// What a sweep records of iterated maps whose attractors are known: the logistic map, and rotations of the circle.
#include "maps/map_sweep_problem.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double return_time = 0.5;

/// What it stands for: states of size 1, never far away.
struct UnitSize : SmoothMap {
  explicit UnitSize(bool is_circle) : is_circle(is_circle) {}
  VectorXd image(const VectorXd& x, const ParameterVector&) const override { return x; }
  MatrixXd derivative(const VectorXd&, const ParameterVector&) const override { return MatrixXd::Identity(1, 1); }
  double time(const VectorXd&) const override { return return_time; }
  VectorXd difference(const VectorXd& x, const VectorXd& y) const override {
    return VectorXd::Constant(1, is_circle ? std::remainder(x(0) - y(0), 1.0) : x(0) - y(0));
  }
  const VectorXd& extent() const override { return one; }
  double distance(const VectorXd& x) const override { return std::abs(x(0)); }

  bool is_circle;
  VectorXd one = VectorXd::Ones(1);
};

struct ScalarMap : IteratedMap {
  explicit ScalarMap(bool is_circle) : size(is_circle) {}
  Eigen::Index coordinates() const override { return 1; }
  Eigen::Index exponents() const override { return 1; }
  const SmoothMap& smooth() const override { return size; }

  UnitSize size;
};

/// x -> a x (1 - x), in contact where x > 1/2; PAR(1) = a.
struct LogisticMap : ScalarMap {
  LogisticMap() : ScalarMap(false) {}
  Iterate step(const VectorXd& x, const ParameterVector& par) const override {
    Iterate next;
    next.image = VectorXd::Constant(1, par(0) * x(0) * (1.0 - x(0)));
    next.penetration = x(0) - 0.5;
    next.contact = x(0) > 0.5;
    next.time = return_time;
    return next;
  }
  MatrixXd tangent(const VectorXd& x, const ParameterVector& par) const override {
    return MatrixXd::Constant(1, 1, par(0) * (1.0 - 2.0 * x(0)));
  }
};

/// x -> x + Omega modulo 1; PAR(1) = Omega.
struct Rotation : ScalarMap {
  Rotation() : ScalarMap(true) {}
  Iterate step(const VectorXd& x, const ParameterVector& par) const override {
    Iterate next;
    const double further = x(0) + par(0);
    next.image = VectorXd::Constant(1, further - std::floor(further));
    next.time = return_time;
    return next;
  }
  MatrixXd tangent(const VectorXd&, const ParameterVector&) const override { return MatrixXd::Identity(1, 1); }
};

/// The sample of one value of PAR(1), from the given state.
AttractorSample sampled(const std::shared_ptr<const IteratedMap>& map, double parameter, double x, int exponents = 0) {
  MapModel model;
  model.par = ParameterVector::Zero(2);
  model.free = {1, 0, 0};
  model.contact = {1, 1, 1};
  MapSamplerSetup setup;
  setup.over = {{SweptQuantity{"a", 0, 4, 5, false}, 1}};
  setup.starts = {VectorXd::Constant(1, x)};
  setup.iteration.exponents = exponents;
  const MapSampler sampler(setup, model, map);
  return sampler({0, VectorXd::Constant(1, parameter), 1, {}}, {});
}

}  // namespace

TEST_CASE("logistic map: a cycle of two states, both in contact") {
  const double a = 3.2;
  const AttractorSample sample = sampled(std::make_shared<LogisticMap>(), a, 0.3, 1);
  CHECK(sample.kind == AttractorKind::periodic);
  const double root = std::sqrt((a - 3.0) * (a + 1.0));
  const double low = (a + 1.0 - root) / (2.0 * a), high = (a + 1.0 + root) / (2.0 * a);
  CHECK(low > 0.5);  // so that both are in contact
  REQUIRE(sample.sections.cols() == 2);
  CHECK(sample.sections(0, 0) == Approx(low).epsilon(1e-9));
  CHECK(sample.sections(0, 1) == Approx(high).epsilon(1e-9));
  CHECK(sample.signature == Signature{{1, 1, 1}, {1, 1, 1}});
  CHECK(sample.impacts == 2);
  CHECK(sample.period == Approx(2.0 * return_time).epsilon(1e-15));
  CHECK(sample.penetration == Approx(high - 0.5).epsilon(1e-9));
  CHECK(sample.last.x(0) == Approx(low).epsilon(1e-9));
  // The multiplier of the cycle is 4 + 2 a - a^2.
  REQUIRE(sample.exponents.size() == 1);
  CHECK(sample.exponents(0) == Approx(std::log(std::abs(4.0 + 2.0 * a - a * a)) / sample.period).epsilon(1e-6));
}

TEST_CASE("logistic map: a period begins with the return without contact") {
  // Period 3 exists from a = 1 + sqrt(8) on; two of its states are below 1/2.
  const AttractorSample sample = sampled(std::make_shared<LogisticMap>(), 3.84, 0.3);
  REQUIRE(sample.kind == AttractorKind::periodic);
  REQUIRE(sample.signature.size() == 3);
  CHECK(sample.signature.front() == IndexVector{1, 0, 0});
  CHECK(sample.signature.back() == IndexVector{1, 1, 1});
  CHECK(sample.impacts == 1);
  double x = sample.sections(0, 0);
  for (Eigen::Index k = 0; k < 3; ++k) {
    CHECK(sample.sections(0, k) == Approx(x).epsilon(1e-6));
    CHECK((sample.sections(0, k) > 0.5) == (sample.signature[static_cast<std::size_t>(k)].event == 1));
    x = 3.84 * x * (1.0 - x);
  }
  CHECK(sample.sections(0, 0) < sample.sections(0, 1));
}

TEST_CASE("logistic map: chaos with the exponent ln 2 per return") {
  const AttractorSample sample = sampled(std::make_shared<LogisticMap>(), 4.0, 0.3, 1);
  CHECK(sample.kind == AttractorKind::chaotic);
  CHECK(std::isnan(sample.period));
  CHECK(sample.impacts == -1);
  REQUIRE(sample.exponents.size() == 1);
  CHECK(std::abs(sample.exponents(0) - std::log(2.0) / return_time) <= 4.0 * sample.errors(0));
  CHECK(sample.errors(0) < 0.1);
}

TEST_CASE("logistic map: iterates that leave are an escape, with nothing to go on from") {
  const AttractorSample sample = sampled(std::make_shared<LogisticMap>(), 4.5, 0.45);
  CHECK(sample.kind == AttractorKind::escape);
  CHECK(sample.last.x.size() == 0);
  CHECK_FALSE(sample.message.empty());
}

TEST_CASE("rotations of the circle: periodic when rational, quasi-periodic when golden") {
  for (const int q : {1, 3, 8}) {
    CAPTURE(q);
    const AttractorSample sample = sampled(std::make_shared<Rotation>(), 1.0 / q, 0.123);
    CHECK(sample.kind == AttractorKind::periodic);
    CHECK(static_cast<int>(sample.signature.size()) == q);
    CHECK(sample.impacts == 0);
    CHECK(sample.period == Approx(q * return_time).epsilon(1e-14));
  }
  const AttractorSample golden = sampled(std::make_shared<Rotation>(), 0.5 * (std::sqrt(5.0) - 1.0), 0.123, 1);
  CHECK(golden.kind == AttractorKind::quasi_periodic);
  CHECK(golden.signature.empty());
  REQUIRE(golden.exponents.size() == 1);
  CHECK(std::abs(golden.exponents(0)) < 1e-12);
}
