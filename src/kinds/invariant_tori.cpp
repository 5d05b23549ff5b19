/// Invariant tori: an odd number of orbits of one return each; the analysis of their branches and their problem types.
#include <fmt/format.h>

#include "base/messages.hpp"
#include "files/orbit_trace.hpp"
#include "kinds/families.hpp"
#include "kinds/verify_solutions.hpp"
#include "orbit/torus_system.hpp"
#include "run/branch_setup.hpp"
#include "run/torus_start.hpp"
#include "settings/problem_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

/// How many orbits of `segments` segments each there are among so many; 0 where they make no torus.
int orbits_of(Eigen::Index all, Eigen::Index segments) {
  const bool fits = segments > 0 && all % segments == 0 && (all / segments) % 2 == 1 && all / segments >= 3;
  return fits ? static_cast<int>(all / segments) : 0;
}

class TorusFamily final : public SegmentFamily {
 public:
  TorusFamily()
      : SegmentFamily(
            {.solution = "a torus",
             .signature = {.parameters = "rho, the rotation number, may be one of them, as in ICP=[a,rho]; durations "
                                         "are free in any case",
                           .watches_all_contacts = true},
             .summary = {.contact = "grazing point",
                         .advice = "  tried: halving the step down to DSMIN, Newton with ITNW iterations, NWTN of them "
                                   "with a new Jacobian.\n"
                                   "  you might: raise NHARM where the last harmonics are large; keep rho at an "
                                   "irrational value and free a\n"
                                   "  second parameter (ICP=[a,b]) where rho is near a fraction of small numbers and "
                                   "the motion locks; look by\n"
                                   "  simulation whether there is a torus beyond the last point; lower DSMIN or "
                                   "DSMAX, raise NTST or ITNW.\n",
                         .lost_advice = lost_orbit_advice,
                         .structural_advice =
                             "  the harmonics are too few where the trivial multiplier is off: raise NHARM, lower "
                             "HARMTOL, or stop before\n"
                             "  the torus loses its smoothness\n"},
             .has_rotation = true,
             .doubles_mesh = false,
             .reports_stability = false,
             .has_several_returns = true}) {}

  SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                const HybridSystem&) const override {
    throw UserError(fmt::format(
        "{}: a run of tori (IPS = {}) does not start from data. It restarts from a label of a torus (-s NAME), or "
        "starts at a torus bifurcation with ISW = -1 (-s NAME IRS=TR1); `tchat simulate --torus` makes the label of an "
        "attracting torus",
        path, settings.problem_type));
  }

  OrbitShape shape(const RunSettings& settings) const override { return SegmentFamily::shape(settings).in_common(); }

  /// A torus restarts with as many orbits as its label has. A switch starts from one periodic orbit.
  OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution& label,
                           const std::string& path) const override {
    if (problem_type(settings).facts().switches_branch) return SegmentFamily::restart_shape(settings, label, path);
    OrbitShape wanted = shape(settings);
    const int m = wanted.segments;
    wanted.segments = static_cast<int>(label.states.rows()) / settings.dimension;
    const bool is_known_otherwise = records_problem_type(label.problem_type) && &family_of(label.problem_type) != this;
    if (orbits_of(wanted.segments, m) > 0 && !is_known_otherwise) return wanted;
    throw UserError(fmt::format(
        "{}: label {} (IPS = {}) has {} segment{} and is no torus: a torus has an odd number of orbits, at least "
        "three, "
        "of {} segment{} each; start from a label of a run with IPS = {}, or at a torus bifurcation (TR) with ISW = -1",
        path, label.label, label.problem_type, wanted.segments, wanted.segments == 1 ? "" : "s", m, m == 1 ? "" : "s",
        settings.problem_type));
  }

  void check_restart(const LabelledSolution& label, const RunSettings& settings,
                     const std::string& path) const override {
    if (&family_of(settings) == this) return;
    throw UserError(fmt::format(
        "{}: label {} is a torus (IPS = {}), and no run with IPS = {} begins there; IPS = {} goes on with it, "
        "IPS = {} with tori in grazing contact",
        path, label.label, label.problem_type, settings.problem_type, invariant_torus.number, grazing_torus.number));
  }

  std::string mismatch(const LabelledSolution& label, const RunSettings& settings) const override {
    if (!is_same_problem_type(label.problem_type, settings.problem_type))
      return SolutionFamily::mismatch(label, settings);
    const Eigen::Index states = segment_count(settings) * settings.dimension;
    if (orbits_of(label.states.rows(), states) > 0) return "";
    return fmt::format("has {} states, no odd number of returns of {} segments of {}", label.states.rows(),
                       settings.segments.size(), settings.dimension);
  }
  OrbitCheck check(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                   const std::vector<std::complex<double>>& stored, double tolerance,
                   const CriticalMultipliers&) const override {
    return check_torus(system, settings, x, stored, tolerance);
  }
  const char* checked_trajectories() const override {
    return " over returns from the stored phases and half way between them";
  }

  OrbitTrace trace(const LabelledSolution& label, const std::string& name, int dimension,
                   const std::string& path) const override {
    return torus_bundle(label, name, dimension, path);
  }
  OrbitTrace section_trace(const LabelledSolution& label, const std::string& name, int dimension,
                           const std::string& path) const override {
    return tchat::section_trace(label, name, dimension, path);
  }
  std::map<int, LineKind> label_kinds(const std::string& solution_path) const override {
    return torus_label_kinds(solution_path);
  }
  bool is_drawn_as_contact() const override { return true; }

  std::string why_not(Analysis analysis, const std::string& label) const override {
    if (analysis != Analysis::grazing) return "";
    return fmt::format(
        ", and this analysis one of periodic orbits; `tchat sweep --map {} --over ...` makes its composite map, "
        "`tchat resegment --to grazing-curve` the start of a curve of tori in contact",
        label);
  }
};

}  // namespace

const SolutionFamily& torus_family() {
  static const TorusFamily family;
  return family;
}

namespace {

class TorusAnalysis final : public RingAnalysis {
 public:
  TorusAnalysis(const TorusSystem& system, const OrbitShape& shape) : RingAnalysis(system, shape), system_(system) {}

  const FamilyFacts& facts() const override { return torus_family().facts(); }
  /// Those along the rotation, by their moduli.
  void find_multipliers(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) override {
    result = torus_multipliers(system_, condensed, x);
  }
  SpecialPoint shrunk(const Orbit& x, bool) const override {
    return {PointType::torus,
            {},
            false,
            fmt::format(
                "the torus has shrunk to a periodic orbit, {}: its torus bifurcation, where the branch of tori ends",
                state_text(system_.system(), x, x.start(0)))};
  }
  std::string tendency(const Orbit&, const PeriodGrowth&, const std::string&) const override { return ""; }

 private:
  const TorusSystem& system_;
};

}  // namespace

std::unique_ptr<BranchAnalysis> TorusSystem::make_analysis(const OrbitShape& shape) const {
  return std::make_unique<TorusAnalysis>(*this, shape);
}

// The problem types of invariant tori (IPS = 182) and of tori in grazing contact (IPS = 152): the equations are those
// of orbit/torus_system.hpp (dissertation, 2.4, 3.3, 4.3). rho may be one of the free parameters.

namespace {

ProblemFacts torus_facts(const ProblemId& id, const char* solutions, const char* title, int free_parameters) {
  return {.number = id.number,
          .branch_mode = id.branch_mode,
          .curve = 0,
          .family = torus_family,
          .solutions = solutions,
          .title = title,
          .free_parameters = free_parameters,
          .in_two_parameters = free_parameters > 2,  // a family has two itself, rho among them
          .switches_branch = id.branch_mode < 0};
}

}  // namespace

std::vector<const ProblemType*> torus_types() {
  static const TorusProblem tori(torus_facts(invariant_torus, "invariant tori",
                                             "invariant tori, rho and one parameter free, or two with rho fixed", 2),
                                 free_torus);
  ProblemFacts births_at_torus =
      torus_facts(torus_birth, "invariant tori", "the torus that is born at a TR label of periodic orbits", 2);
  births_at_torus.starts_from = periodic_orbit.number;
  births_at_torus.start_word = "ICP=[{},rho]";
  static const SwitchRow births(births_at_torus, {PointType::torus}, begin_torus);
  ProblemFacts grazing =
      torus_facts(grazing_torus, "invariant tori in grazing contact",
                  "invariant tori in grazing contact, rho and two parameters free, or three with rho fixed", 3);
  grazing.stability = StabilityMeaning::without_contact;
  static const TorusProblem in_contact(grazing, touching_torus);
  return {&tori, &births, &in_contact};
}

}  // namespace tchat
