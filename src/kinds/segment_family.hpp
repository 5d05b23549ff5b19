/// What families of segments share: their sizes, how they start and restart, and the words of summaries.
#pragma once

#include "files/solution_file.hpp"
#include "run/data_start.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

inline constexpr const char* orbit_advice =
    "  tried: halving the step down to DSMIN, Newton with ITNW iterations, NWTN of them with a new Jacobian.\n"
    "  you might: lower DSMIN (0 goes to 1e-10 DSMAX); raise NTST, NCOL or ITNW, NWTN; adapt the mesh more often\n"
    "  (IAD = 1); lower DSMAX; loosen EPSL and EPSU if they are near rounding; look at the last orbit\n"
    "  (tchat orbit) for an event that the signature misses.\n";
inline constexpr const char* lost_orbit_advice =
    "  you might: lower DSMAX; raise NTST or NCOL; EPSL and EPSU smaller than EPSS\n";

/// Why an analysis of periodic orbits is not made of another kind of solution.
inline constexpr const char* no_periodic_orbit =
    ", no periodic orbit; choose a GR label of periodic orbits (IPS = 180) or a label of a grazing curve (IPS = 150)";

/// Does the run switch to another branch at a label that is one state, an equilibrium? Which of them it may start from
/// the problem type says.
inline bool switches_at_state(const RunSettings& settings, const LabelledSolution& label) {
  return problem_type(settings).facts().switches_branch && label.tau.size() == 1;
}

/// A solution that consists of the segments of the signature on a mesh of NTST intervals, or on own ones (OWNMESH).
class SegmentFamily : public SolutionFamily {
 public:
  using SolutionFamily::SolutionFamily;

  OrbitShape shape(const RunSettings& settings) const override { return shape_of_segments(settings); }
  SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                const HybridSystem& system) const override {
    return start_from_orbit(path, settings, system);
  }
  OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution& label,
                           const std::string& /*path*/) const override {
    return switches_at_state(settings, label) ? OrbitShape::point(settings.dimension) : shape(settings);
  }
};

}  // namespace tchat
