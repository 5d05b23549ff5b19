/// A family: what a kind of solution is. Periodic orbits, invariant tori, equilibria and boundary value problems are
/// one class each, in one file of src/kinds. A family owns what depends on the kind of a solution: its rules for
/// constants, how a run starts and restarts, the headings of files, the check by integration, the lines of a picture.
/// What a branch of its solutions needs while it is computed is a BranchAnalysis (continuation/branch_analysis.hpp).
///
/// Other rooms ask a family to do something and never which one it is. They know it by the IPS of constants or labels.
#pragma once

#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tchat {

class HybridSystem;
enum class LineKind;
struct LabelledSolution;
struct Orbit;
struct OrbitCheck;
struct OrbitShape;
struct OrbitTrace;
struct RunSettings;
struct SelectedStart;

/// What the constants of a family may say of the signature and of free parameters, with the words of messages.
struct SignatureRules {
  int most_segments = 0;           ///< 0: any number
  const char* why_most = "";       ///< the reason for that limit
  bool ends_in_events = true;      ///< GCHIND and GCGIND name what ends a segment; every duration is free
  const char* why_no_events = "";  ///< the reason where they do not
  bool counts_conditions = false;  ///< NBC and NINT decide how many entries of ICP are free, durations among them
  const char* durations = "durations are free in any case";   ///< what messages about ICP say of them
  const char* parameters = "durations are free in any case";  ///< the same, with what else ICP may name
  const char* example = "1, 61";                              ///< of ICP
  bool watches_all_contacts = false;   ///< an empty GCIPSI chooses all monitored events, not none
  bool has_contacts_to_choose = true;  ///< GCIPSI numbers monitored events
};

/// Columns and lines of p- and d-files.
struct FileHeadings {
  const char* maximum = "MAX ";  ///< before the name of a state
  bool has_period = true;
  bool has_mesh = true;  ///< the error between mesh points is printed
};

/// Advice where the error between mesh points is large.
inline constexpr const char* mesh_advice =
    "  the mesh is too coarse for this orbit: raise NTST or NCOL, or adapt it (IAD = 1)\n";

/// What the summary of a run says.
struct SummaryWords {
  const char* contact;            ///< the special point at which GRSTOP ends a branch
  const char* advice;             ///< what was tried at an abnormal end, and what a user might change
  const char* lost_advice;        ///< what a user might change where special points may be missing
  const char* structural_advice;  ///< where a multiplier that is known is off by more than 1e-3
};

struct FamilyFacts {
  const char* solution;  ///< "a periodic orbit"
  SignatureRules signature = {};
  FileHeadings headings = {};
  SummaryWords summary;
  bool has_rotation = false;         ///< the rotation number is one more parameter beside those of the problem
  bool doubles_mesh = true;          ///< a run doubles NTST when the mesh does not resolve a solution
  bool reports_stability = true;     ///< a change of stability without a special point is reported
  bool has_return_map = true;        ///< multipliers are those of a return map
  bool has_several_returns = false;  ///< a solution consists of several orbits of the signature, one return each
};

/// The multipliers that a label must have, by those that were computed.
using CriticalMultipliers =
    std::function<std::vector<std::complex<double>>(const std::vector<std::complex<double>>& computed)>;

/// Analyses that need more than any labelled solution has.
enum class Analysis { grazing, resegmentation, composite_map };

class SolutionFamily {
 public:
  explicit SolutionFamily(const FamilyFacts& facts) : facts_(facts) {}
  virtual ~SolutionFamily() = default;
  SolutionFamily(const SolutionFamily&) = delete;
  SolutionFamily& operator=(const SolutionFamily&) = delete;
  const FamilyFacts& facts() const { return facts_; }

  /// Sizes of a solution on the mesh that the constants ask for.
  virtual OrbitShape shape(const RunSettings& settings) const = 0;
  /// A start from the data file `path`. Throws UserError where the data do not fit the family.
  virtual SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                        const HybridSystem& system) const = 0;
  /// Sizes of the start that a run of these constants makes of a label. Throws UserError where it cannot start there.
  virtual OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution& label,
                                   const std::string& path) const = 0;
  /// Throws UserError where no run of these constants may start at a label of this family.
  virtual void check_restart(const LabelledSolution&, const RunSettings&, const std::string& /*path*/) const {}

  /// Why labels of this family cannot be checked by integration; "" where they can be.
  virtual std::string why_unverifiable(const RunSettings&) const { return ""; }
  /// Why an entry of a q-file is no solution of these constants; "" when it is one.
  virtual std::string mismatch(const LabelledSolution& label, const RunSettings& settings) const;
  /// The solution integrated segment by segment. `stored`: the multipliers of the d-file; empty when there are none.
  virtual OrbitCheck check(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                           const std::vector<std::complex<double>>& stored, double tolerance,
                           const CriticalMultipliers& critical) const = 0;
  /// " over ...": which trajectories check() integrates; "" for those that are stored.
  virtual const char* checked_trajectories() const { return ""; }

  /// The lines of a picture of the label. `dimension`: states of one segment where the file does not say (0: it does).
  virtual OrbitTrace trace(const LabelledSolution& label, const std::string& name, int dimension,
                           const std::string& path) const;
  /// Its curve on the section that ends a return. Throws UserError where it has none.
  virtual OrbitTrace section_trace(const LabelledSolution& label, const std::string& name, int dimension,
                                   const std::string& path) const;
  /// The labels of a q-file that are drawn as unstable or inadmissible.
  virtual std::map<int, LineKind> label_kinds(const std::string& solution_path) const;
  /// Are points of a curve of this family drawn as those in contact are?
  virtual bool is_drawn_as_contact() const { return false; }

  /// Why the analysis cannot be made of a label of this family, as the end of a sentence that says what the label is,
  /// with a cure; "" where it can be. `label`: its q-file and number, as in q.x:3.
  virtual std::string why_not(Analysis analysis, const std::string& label) const = 0;

 private:
  FamilyFacts facts_;
};

/// The family of an IPS, that of periodic orbits for numbers that are not tchat's.
const SolutionFamily& family_of(int number);

}  // namespace tchat
