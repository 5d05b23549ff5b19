/// Periodic orbits: rings of segments.
#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "kinds/segment_family.hpp"

namespace tchat {

namespace {

class PeriodicOrbitFamily final : public SegmentFamily {
 public:
  PeriodicOrbitFamily()
      : SegmentFamily({.solution = "a periodic orbit",
                       .summary = {.contact = "grazing point",
                                   .advice = orbit_advice,
                                   .lost_advice = lost_orbit_advice,
                                   .structural_advice = mesh_advice}}) {}

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
