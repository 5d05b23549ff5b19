/// Periodic orbits: rings of segments.
#include <fmt/format.h>

#include "constants/run_settings.hpp"
#include "families/families.hpp"
#include "families/label_checks.hpp"
#include "start/data_start.hpp"
#include "traces/orbit_stability.hpp"
#include "traces/orbit_trace.hpp"
#include "verification/orbit_check.hpp"

namespace tchat {

namespace {

class PeriodicOrbitFamily final : public SolutionFamily {
 public:
  PeriodicOrbitFamily()
      : SolutionFamily({.solution = "a periodic orbit",
                        .summary = {.contact = "grazing point",
                                    .advice = orbit_advice,
                                    .lost_advice = lost_orbit_advice,
                                    .structural_advice = mesh_advice}}) {}

  OrbitShape shape(const RunSettings& settings) const override { return shape_of_segments(settings); }
  SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                const HybridSystem& system) const override {
    return start_from_orbit(path, settings, system);
  }
  OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution& label,
                           const std::string&) const override {
    return switches_at_state(settings, label) ? OrbitShape::point(settings.dimension) : shape(settings);
  }

  OrbitCheck check(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                   const std::vector<std::complex<double>>& stored, double tolerance,
                   const CriticalMultipliers& critical) const override {
    return check_orbit(system, settings, x, stored, tolerance, critical);
  }
  std::string why_not(Analysis, const std::string&) const override { return ""; }
};

}  // namespace

const SolutionFamily& periodic_orbit_family() {
  static const PeriodicOrbitFamily family;
  return family;
}

}  // namespace tchat
