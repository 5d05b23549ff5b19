/// Equilibria: eigenvalues of f_x, test functions on branches, and test functions on curves in two parameters.
#pragma once

#include "orbit/defining_system.hpp"
#include "orbit/equilibrium_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Eigenvalues of f_x at an equilibrium, in the place of the multipliers of an orbit.

/// The n x n matrix f_x of the field of the one segment at the equilibrium x.
Eigen::MatrixXd equilibrium_jacobian(const DefiningSystem& system, const Orbit& x);

/// Of the states that the mode has. Those with the largest real part first; of a conjugate pair the one in the upper
/// half plane first. Not valid where f_x is not finite.
FloquetMultipliers equilibrium_eigenvalues(const DefiningSystem& system, const Orbit& x);

/// How many real eigenvalues are zero where the least of them is.
long eigenvalues_at_zero(const TestedPoint& point);

/// Two eigenvalues and how far they are from a sum of zero.
struct EigenvaluePair {
  std::complex<double> first, second;
  double distance = 1.0;  ///< |first + second| / (|first| + |second|)

  /// i omega and -i omega, if the sum is zero; else two real eigenvalues of opposite sign (neutral saddle).
  bool is_oscillation() const { return first.imag() != 0.0 && first == std::conj(second); }
};

/// The pair whose sum is nearest to zero, and the sign of the product of all sums of two: it changes where a pair is on
/// the imaginary axis, and at a neutral saddle. No pair: distance 1, sign 1.
struct HopfPairs {
  EigenvaluePair nearest;
  int sign = 1;
};
HopfPairs hopf_pairs(const std::vector<std::complex<double>>& eigenvalues);

// Test functions of equilibria: Hopf bifurcation, two eigenvalues at once and boundary equilibrium. Fold and branch
// point are those of orbits (bifurcation_tests.hpp).

class DefiningSystem;

/// HB: of all pairs of eigenvalues the least |a + b| / (|a| + |b|), with the sign of the product of all sums a + b.
/// Relative, without poles, and defined where eigenvalues meet or vanish. At a zero with real a and b, a neutral
/// saddle, nothing happens.
class HopfTest final : public TestFunction {
 public:
  explicit HopfTest(bool stop) : stop_(stop) {}
  std::string name() const override { return "Hopf"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool stop_;
};

/// BP where two real eigenvalues go through 0 together, as a symmetry makes them do: then no determinant changes sign.
/// With the real ones in order of size, x_1 >= x_2 >= ...: the least |x_2i|, negative when an odd number of the x_2i
/// are positive. It vanishes with one eigenvalue, too, which is no such point.
class EigenvaluePairTest final : public TestFunction {
 public:
  explicit EigenvaluePairTest(bool stop) : stop_(stop) {}
  std::string name() const override { return "a pair of eigenvalues 0"; }
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override { return Resolution::any; }
  bool singular_at_zero() const override { return true; }
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool stop_;
};

/// BE: h_j = 0 for a monitored event function. Where h_j falls below zero the equilibrium is none of the model: `stop`
/// ends the branch there.
class BoundaryEquilibriumTest final : public TestFunction {
 public:
  BoundaryEquilibriumTest(const DefiningSystem& system, int event, bool stop)
      : system_(system), event_(event), stop_(stop) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const DefiningSystem& system_;
  int event_;
  bool stop_;
};

// Codimension-two points on curves of folds, Hopf bifurcations and boundary equilibria. The test functions of the
// first two read the curve's condition, which must outlive them and is evaluated at the tested point. All are relative
// and without poles.

class DefiningSystem;

/// CP, BT and ZH.
TestList equilibrium_fold_tests(const EquilibriumFold& fold);

/// BT, also where the curve meets its mirror image or omega passes 0; ZH and GH.
TestList hopf_curve_tests(const HopfPair& pair);

/// LP on a curve of boundary equilibria of `system`, which outlives it: f_x has the eigenvalue 0, and its range does
/// not contain f_p for both parameters, as at a branch point.
std::unique_ptr<TestFunction> zero_eigenvalue_test(const DefiningSystem& system);

}  // namespace tchat
