/// The analysis of branches of closed orbits, rings of segments.
#pragma once

#include "continuation/branch_analysis.hpp"
#include "orbit/defining_system.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

class RingAnalysis : public BranchAnalysis {
 public:
  RingAnalysis(const DefiningSystem& system, const OrbitShape& shape) : system_(system), floquet_(shape) {}

  const FamilyFacts& facts() const override;
  void find_multipliers(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) override {
    floquet_.compute(condensed, x, result);
    result.of_conserved = system_.conserved_quantities();
  }
  /// Events fix it.
  bool has_fixed_phase() const override;
  bool may_shrink() const override { return true; }
  /// To an equilibrium; a Hopf bifurcation where the flow is smooth there and the period that of its oscillation.
  SpecialPoint shrunk(const Orbit& x) const override;
  std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds) const override;
  std::string passed_zero(const Orbit& from, const Orbit& to) const override;
  std::string passed_zero_segment(const Orbit& from, const Orbit& to) const override;
  /// A homoclinic or heteroclinic orbit.
  std::string tendency(const Orbit& x, const PeriodGrowth& growth, const std::string& parameter_name) const override;
  /// An orbit that takes no time, or on which no state moves, is none.
  std::string why_no_solution(const Orbit& first, const Orbit& start, const std::string& source) const override;
  std::string start_advice(const Orbit& start) const override;

 private:
  const DefiningSystem& system_;
  FloquetSolver floquet_;
};

}  // namespace tchat
