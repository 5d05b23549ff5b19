/// Test functions of equilibria: Hopf bifurcation and boundary equilibrium. Fold and branch point are those of orbits
/// (bifurcation_tests.hpp).
#pragma once

#include "stability/test_function.hpp"

namespace tchat {

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

}  // namespace tchat
