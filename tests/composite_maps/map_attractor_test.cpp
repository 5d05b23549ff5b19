// What iterates settle on, of maps in closed form.
#include "maps/composite_map.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <utility>

using namespace tchat;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A state of which nothing but its size is known.
class WholeLine : public SmoothMap {
 public:
  VectorXd image(const VectorXd& x, const ParameterVector&) const override { return x; }
  MatrixXd derivative(const VectorXd&, const ParameterVector&) const override { return MatrixXd::Identity(1, 1); }
  double time(const VectorXd&) const override { return 1.0; }
  const VectorXd& extent() const override { return extent_; }
  double distance(const VectorXd& x) const override { return std::abs(x(0)) / 100.0; }

 private:
  VectorXd extent_ = VectorXd::Ones(1);
};

/// x -> f(x), without contact.
class MapOfLine : public IteratedMap {
 public:
  using Function = std::function<double(double)>;
  MapOfLine(Function f, Function derivative) : f_(std::move(f)), derivative_(std::move(derivative)) {}

  Iterate step(const VectorXd& x, const ParameterVector&) const override {
    Iterate iterate;
    iterate.image = VectorXd::Constant(1, f_(x(0)));
    iterate.time = 1.0;
    return iterate;
  }
  MatrixXd tangent(const VectorXd& x, const ParameterVector&) const override {
    return MatrixXd::Constant(1, 1, derivative_(x(0)));
  }
  Eigen::Index coordinates() const override { return 1; }
  Eigen::Index exponents() const override { return 1; }
  const SmoothMap& smooth() const override { return line_; }

 private:
  Function f_, derivative_;
  WholeLine line_;
};

/// x -> r x (1 - x)
MapOfLine logistic(double r) {
  return {[r](double x) { return r * x * (1.0 - x); }, [r](double x) { return r * (1.0 - 2.0 * x); }};
}

MapAttractor attractor_from(const MapOfLine& map, double x) {
  return iterate_to_attractor(map, VectorXd::Constant(1, x), ParameterVector(), MapIteration{});
}

}  // namespace

TEST_CASE("iterates that leave an unstable fixed point slowly are not called chaotic") {
  // x -> x + g x (1 - x) has the fixed points 0 of multiplier 1 + g, unstable, and 1 of multiplier 1 - g, stable.
  const double growth = GENERATE(1.5e-3, 2e-3, 3e-3);
  const MapOfLine map([=](double x) { return x + growth * x * (1.0 - x); },
                      [=](double x) { return 1.0 + growth * (1.0 - 2.0 * x); });
  // The transient, 1000 returns that are kept and 2000 whose exponent is measured are near 0.
  const double start = 0.5 * std::exp(-4200.0 * growth);
  const MapAttractor leaving = attractor_from(map, start);
  INFO(growth << ": " << to_string(leaving.kind) << ", " << leaving.message);
  REQUIRE(leaving.spectrum);
  CHECK(leaving.spectrum->exponents(0) > 0.5 * growth);
  CHECK(leaving.spectrum->exponents(0) > 3.0 * leaving.spectrum->errors(0));
  CHECK(leaving.kind == AttractorKind::none);
  CHECK(leaving.message.find("leaves something unstable") != std::string::npos);
}

TEST_CASE("iterates on an unstable periodic orbit have no attractor, beside it they find the stable one") {
  const MapOfLine map = logistic(1.5);
  const MapAttractor on_it = attractor_from(map, 0.0);
  CHECK(on_it.kind == AttractorKind::none);
  CHECK(on_it.period == 0);
  CHECK(on_it.message.find("an unstable orbit of 1 returns, with a multiplier of modulus 1.5;") != std::string::npos);
  const MapAttractor beside = attractor_from(map, 1e-9);
  CHECK(beside.kind == AttractorKind::periodic);
  CHECK(beside.period == 1);
  CHECK(beside.last(0) == Approx(1.0 / 3.0));
}

TEST_CASE("weak chaos of the logistic map just beyond its accumulation of doublings is chaos") {
  // The exponent is about 0.02 at r = 3.58 (the bands have merged to 4).
  const MapAttractor weak = attractor_from(logistic(3.58), 0.3);
  INFO(weak.message);
  CHECK(weak.kind == AttractorKind::chaotic);
}
