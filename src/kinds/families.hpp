/// The families of solutions and their problem types, and what families of segments share.
#pragma once

#include <vector>

#include "continuation/orbit_trend.hpp"
#include "files/solution_file.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "run/data_start.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

// The families there are. Problem types name theirs; nobody else needs to know them one by one.

const SolutionFamily& periodic_orbit_family();
const SolutionFamily& torus_family();
const SolutionFamily& equilibrium_family();
const SolutionFamily& boundary_value_family();

// The problem types of each family, in the order in which help and messages name them.

std::vector<const ProblemType*> periodic_orbit_types();
std::vector<const ProblemType*> grazing_types();
std::vector<const ProblemType*> torus_types();
std::vector<const ProblemType*> boundary_value_types();
std::vector<const ProblemType*> equilibrium_types();

// What families of segments share: their sizes, how they start and restart, and the words of summaries.

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

// The analysis of branches of closed orbits, rings of segments.

class RingAnalysis : public BranchAnalysis {
 public:
  RingAnalysis(const DefiningSystem& system, const OrbitShape& shape)
      : system_(system), floquet_(shape), rule_(shape.collocation) {}

  const FamilyFacts& facts() const override;
  void find_multipliers(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) override {
    floquet_.compute(condensed, x, result);
    result.of_conserved = system_.conserved_quantities();
    result.is_at_border = is_at_border_of_chatter(system_.system(), system_.signature(), x);
    if (result.is_at_border) result.leave_out();
  }
  /// Events fix it.
  bool has_fixed_phase() const override;
  bool may_shrink() const override { return true; }
  /// To an equilibrium; a Hopf bifurcation where the flow is smooth there and the period that of its oscillation.
  SpecialPoint shrunk(const Orbit& x, bool are_folds) const override;
  std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds) const override;
  std::string passed_zero(const Orbit& from, const Orbit& to) const override;
  std::string passed_zero_segment(const Orbit& from, const Orbit& to) const override;
  int like_parts(const Orbit& x) const override;
  /// A homoclinic or heteroclinic orbit.
  std::string tendency(const Orbit& x, const PeriodGrowth& growth, const std::string& parameter_name) const override;
  /// An orbit that takes no time, or on which no state moves, is none.
  std::string why_no_solution(const Orbit& first, const Orbit& start, const std::string& source) const override;
  std::string start_advice(const Orbit& start) const override;

 private:
  const DefiningSystem& system_;
  FloquetSolver floquet_;
  CollocationRule rule_;
};

}  // namespace tchat
