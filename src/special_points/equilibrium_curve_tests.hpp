/// Codimension-two points on curves of folds and of Hopf bifurcations of equilibria. They read the curve's condition at
/// the tested point, an EquilibriumFold or a HopfPair. All are relative and without poles.
#pragma once

#include "special_points/test_function.hpp"

namespace tchat {

/// CP: w^T f_xx v v = 0 on a fold curve.
class EquilibriumCuspTest final : public TestFunction {
 public:
  std::string name() const override { return "cusp"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }
};

/// BT on a fold curve: the eigenvalue 0 is a double one.
class DoubleZeroTest final : public TestFunction {
 public:
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, false, "Bogdanov-Takens point: the eigenvalue 0 is a double one"};
  }
};

/// BT on a Hopf curve: omega^2 = 0. The curve ends there.
class ZeroFrequencyTest final : public TestFunction {
 public:
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, true, "Bogdanov-Takens point: omega = 0, where the Hopf curve ends"};
  }
};

/// ZH on a fold curve: a pair of the other eigenvalues is on the imaginary axis.
class FoldHopfTest final : public TestFunction {
 public:
  std::string name() const override { return "zero-Hopf"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;
};

/// ZH on a Hopf curve: one of the other eigenvalues is zero.
class HopfFoldTest final : public TestFunction {
 public:
  std::string name() const override { return "zero-Hopf"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;
};

/// GH on a Hopf curve: the first Lyapunov coefficient is zero (Bautin).
class BautinTest final : public TestFunction {
 public:
  std::string name() const override { return "first Lyapunov coefficient"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::generalized_hopf, {}, false, "generalised Hopf point: the first Lyapunov coefficient is 0"};
  }
};

}  // namespace tchat
