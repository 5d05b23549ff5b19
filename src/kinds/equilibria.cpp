/// Equilibria: one state each, with eigenvalues in the place of multipliers.
#include <fmt/format.h>

#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "kinds/segment_family.hpp"
#include "run/data_start.hpp"

namespace tchat {

namespace {

class EquilibriumFamily final : public SolutionFamily {
 public:
  EquilibriumFamily()
      : SolutionFamily({.solution = "an equilibrium",
                        .signature = {.most_segments = 1,
                                      .why_most = "an equilibrium is one state of one vector field",
                                      .ends_in_events = false,
                                      .why_no_events = "nothing ends a segment; events to watch are in GCHGRZIND",
                                      .durations = "an equilibrium has no duration",
                                      .parameters = "an equilibrium has no duration",
                                      .example = "1",
                                      .has_contacts_to_choose = false},
                        .headings = {.maximum = "", .has_period = false, .has_mesh = false},
                        .summary = {.contact = "boundary equilibrium",
                                    .advice = "  tried: halving the step down to DSMIN, Newton with ITNW iterations, "
                                              "NWTN of them with a new Jacobian.\n"
                                              "  you might: lower DSMIN (0 goes to 1e-10 DSMAX) or DSMAX; raise ITNW, "
                                              "NWTN; loosen EPSL and EPSU if they\n"
                                              "  are near rounding.\n",
                                    .lost_advice = "  you might: lower DSMAX; EPSL and EPSU smaller than EPSS\n",
                                    .structural_advice = ""},
                        .doubles_mesh = false,
                        .reports_stability = false,
                        .has_return_map = false}) {}

  OrbitShape shape(const RunSettings& settings) const override { return OrbitShape::point(settings.dimension); }
  SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                const HybridSystem& system) const override {
    return start_from_state(path, settings, system);
  }
  OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution&, const std::string&) const override {
    return shape(settings);
  }

  std::string why_unverifiable(const RunSettings& settings) const override {
    return fmt::format(
        "these are equilibria (IPS = {}), with nothing to integrate; their eigenvalues are in the d-file",
        settings.problem_type);
  }
  OrbitCheck check(const HybridSystem&, const RunSettings&, const Orbit&, const std::vector<std::complex<double>>&,
                   double, const CriticalMultipliers&) const override {
    return {};
  }
  std::string why_not(Analysis analysis, const std::string&) const override {
    if (analysis == Analysis::resegmentation)
      return ": it has no signature that could change; `tchat run` restarts from it";
    return no_periodic_orbit;
  }
};

}  // namespace

const SolutionFamily& equilibrium_family() {
  static const EquilibriumFamily family;
  return family;
}

}  // namespace tchat
