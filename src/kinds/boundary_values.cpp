/// Boundary value problems: segments that conditions of the problem tie.
#include "continuation/branch_analysis.hpp"
#include "files/orbit_trace.hpp"
#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "kinds/segment_family.hpp"
#include "orbit/boundary_value_system.hpp"
#include "orbit/condensed_system.hpp"

namespace tchat {

namespace {

class BoundaryValueFamily final : public SegmentFamily {
 public:
  BoundaryValueFamily()
      : SegmentFamily({.solution = "a solution of a boundary value problem",
                       .signature = {.most_segments = 64,
                                     .why_most = "conditions and integrands know 64 durations",
                                     .ends_in_events = false,
                                     .why_no_events = "the problem's boundary conditions tie the segments",
                                     .counts_conditions = true},
                       .summary = {.contact = "grazing point",
                                   .advice = orbit_advice,
                                   .lost_advice = lost_orbit_advice,
                                   .structural_advice = mesh_advice},
                       .has_return_map = false}) {}

  OrbitCheck check(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                   const std::vector<std::complex<double>>&, double tolerance,
                   const CriticalMultipliers&) const override {
    return check_boundary_values(system, settings, x, tolerance);
  }
  OrbitTrace trace(const LabelledSolution& label, const std::string& name, int dimension,
                   const std::string& path) const override {
    OrbitTrace trace = orbit_trace(label, name, dimension, path);
    trace.is_closed = false;
    return trace;
  }
  std::string why_not(Analysis analysis, const std::string&) const override {
    if (analysis == Analysis::resegmentation)
      return ": its segments have no signature that could change; `tchat run` restarts from it";
    return no_periodic_orbit;
  }
};

class BoundaryValueAnalysis final : public BranchAnalysis {
 public:
  const FamilyFacts& facts() const override { return boundary_value_family().facts(); }
  void find_multipliers(const CondensedSystem&, const Orbit&, FloquetMultipliers& result) override { result = {}; }
};

}  // namespace

const SolutionFamily& boundary_value_family() {
  static const BoundaryValueFamily family;
  return family;
}

std::unique_ptr<BranchAnalysis> BoundaryValueSystem::make_analysis(const OrbitShape&) const {
  return std::make_unique<BoundaryValueAnalysis>();
}

}  // namespace tchat
