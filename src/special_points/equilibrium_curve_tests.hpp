/// Codimension-two points on curves of folds and of Hopf bifurcations of equilibria. They read the curve's condition at
/// the tested point, an EquilibriumFold or a HopfPair. All are relative and without poles.
#pragma once

#include "bvp/equilibrium_fold.hpp"
#include "bvp/hopf_pair.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// CP: w^T f_xx v v = 0 on a fold curve.
class EquilibriumCuspTest final : public TestFunction {
 public:
  explicit EquilibriumCuspTest(const EquilibriumFold& condition) : condition_(condition) {}
  std::string name() const override { return "cusp"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }

 private:
  const EquilibriumFold& condition_;
};

/// BT on a fold curve: the eigenvalue 0 is a double one.
class DoubleZeroTest final : public TestFunction {
 public:
  explicit DoubleZeroTest(const EquilibriumFold& condition) : condition_(condition) {}
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, false, "Bogdanov-Takens point: the eigenvalue 0 is a double one"};
  }

 private:
  const EquilibriumFold& condition_;
};

/// BT on a Hopf curve: omega^2 = 0. The curve ends there. By symmetry omega^2 may touch zero, omega going through it:
/// MirroredFrequencyTest, PassedFrequencyTest.
class ZeroFrequencyTest final : public TestFunction {
 public:
  explicit ZeroFrequencyTest(const HopfPair& condition) : condition_(condition) {}
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override { return Resolution::direction; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, true, "Bogdanov-Takens point: omega = 0, where the Hopf curve ends"};
  }

 private:
  const HopfPair& condition_;
};

/// BT where the Hopf curve of an equilibrium without the symmetry of the problem meets its mirror image at an
/// equilibrium that has it: omega is proportional to the arclength. The Hopf curve of the symmetric equilibria goes
/// through the same point, so the bordered determinant changes sign; with its sign omega goes through zero.
class MirroredFrequencyTest final : public TestFunction {
 public:
  explicit MirroredFrequencyTest(const HopfPair& condition) : condition_(condition) {}
  std::string name() const override { return "Bogdanov-Takens at the mirror image"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  bool singular_at_zero() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens,
            {},
            true,
            "Bogdanov-Takens point: omega = 0, where the Hopf curve ends: it meets its mirror image"};
  }

 private:
  const HopfPair& condition_;
};

/// BT that omega passes, the eigenvalue 0 having two eigenvectors: the curve goes on. Reported without a label.
class PassedFrequencyTest final : public TestFunction {
 public:
  explicit PassedFrequencyTest(const HopfPair& condition) : condition_(condition) {}
  std::string name() const override { return "omega through 0"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_only_reported() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, false, "omega passes 0: two eigenvectors, the Hopf curve goes on"};
  }

 private:
  const HopfPair& condition_;
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
  explicit HopfFoldTest(const HopfPair& condition) : condition_(condition) {}
  std::string name() const override { return "zero-Hopf"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const HopfPair& condition_;
};

/// GH on a Hopf curve: the first Lyapunov coefficient is zero (Bautin).
class BautinTest final : public TestFunction {
 public:
  explicit BautinTest(const HopfPair& condition) : condition_(condition) {}
  std::string name() const override { return "first Lyapunov coefficient"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::generalized_hopf, {}, false, "generalised Hopf point: the first Lyapunov coefficient is 0"};
  }

 private:
  const HopfPair& condition_;
};

}  // namespace tchat
