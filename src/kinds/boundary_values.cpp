/// Boundary value problems: segments with conditions of the problem's own, and their problem types.
#include "continuation/orbit_trend.hpp"
#include "files/orbit_trace.hpp"
#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "orbit/boundary_value_system.hpp"
#include "orbit/condensed_system.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "settings/settings_type.hpp"

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

// The problem types of boundary value problems (IPS = 4), with conditions of the problem's own: the equations are
// those of orbit/boundary_value_system.hpp (5.6).

namespace {

std::unique_ptr<BoundaryValueSystem> chain(const HybridSystem& system, const RunSettings& settings,
                                           std::vector<int> free) {
  return std::make_unique<BoundaryValueSystem>(system, settings.signature(), std::move(free), free_durations(settings));
}

BranchCurve branch(const BoundaryValueSystem& system, const RunSettings&, const SelectedStart&) {
  return {nullptr, [&system](const RunSettings& settings) {
            TestList tests;
            add_bifurcations(tests, system, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

ProblemFacts boundary_value_facts(int branch_mode, const char* title) {
  return {.number = boundary_value.number,
          .branch_mode = branch_mode,
          .curve = 0,
          .family = boundary_value_family,
          .solutions = "boundary value problems",
          .title = title,
          .free_parameters = 0,
          .stability = StabilityMeaning::none,
          .switches_branch = branch_mode < 0,
          .starts_at = "a period doubling (PD) or a branch point (BP)",
          .start_example = "PD"};
}

}  // namespace

std::vector<const ProblemType*> boundary_value_types() {
  static const ProblemRow<BoundaryValueSystem> branches(
      boundary_value_facts(boundary_value.branch_mode,
                           "boundary value problems, NBC + NINT conditions of the problem's own"),
      {}, chain, branch);
  static const SwitchRow switches(
      boundary_value_facts(branch_switch.branch_mode,
                           "the branch of boundary value problems that crosses at a BP label"),
      branch_switch_labels(), switch_branch);
  return {&branches, &switches};
}

}  // namespace tchat
