/// Problem types and families of solutions: all that other rooms ask of them.
#pragma once

#include <complex>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/words.hpp"

namespace tchat {

// The numbers of problem types (IPS, ISW) whose constants other rooms make.

struct ProblemId {
  int number;       ///< IPS
  int branch_mode;  ///< ISW
};
inline constexpr ProblemId periodic_orbit{180, 1};
inline constexpr ProblemId orbit_curve{180, 2};
inline constexpr ProblemId branch_switch{180, -1};
inline constexpr ProblemId grazing_orbit{150, 1};
inline constexpr ProblemId invariant_torus{182, 1};
inline constexpr ProblemId torus_birth{182, -1};
inline constexpr ProblemId grazing_torus{152, 1};
inline constexpr ProblemId boundary_value{4, 1};
inline constexpr ProblemId equilibrium{1, 1};

// A family: what a kind of solution is. Periodic orbits, invariant tori, equilibria and boundary value problems are
// one class each, in one file of src/kinds. A family owns what depends on the kind of a solution: its rules for
// constants, how a run starts and restarts, the headings of files, the check by integration, the lines of a picture.
// What a branch of its solutions needs while it is computed is a BranchAnalysis (continuation/orbit_trend.hpp).
//
// Other rooms ask a family to do something and never which one it is. They know it by the IPS of constants or labels.

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

// What a problem type is: all that other rooms ask of it. Each type is one class in one file of src/kinds,
// named in the list of that folder's CMakeLists.txt; the classes they work with are known here by name only.
//
// IPS and ISW, numbers in constants and files, are compared here and nowhere else.

class HybridSystem;
class SolutionFamily;
struct BranchSetup;
struct RunSettings;
struct SelectedStart;

/// What the multipliers of a point on a branch of this type say.
enum class StabilityMeaning {
  none,             ///< they are not computed
  orbit,            ///< the orbit is stable or not
  without_contact,  ///< so would it be but for the contact that is kept
  critical          ///< one of them is critical all along
};

struct ProblemFacts {
  int number;       ///< IPS
  int branch_mode;  ///< ISW
  int curve;        ///< type number of the points that such a two-parameter curve consists of; 0: no such curve
  const SolutionFamily& (*family)();  ///< what its solutions are
  const char* solutions;              ///< what IPS says, in words
  const char* title;                  ///< what IPS and ISW say together
  int free_parameters;                ///< of the problem, durations not counted; 0: the settings decide
  bool in_two_parameters = false;     ///< its branches are curves in two parameters of the problem
  StabilityMeaning stability = StabilityMeaning::orbit;
  bool keeps_contact = false;    ///< a segment ends in grazing contact (GCSEGTYP = 2); GCIPSI lists n of xi_n
  bool may_double = false;       ///< the branch may have twice as many segments as its start
  bool may_conserve = false;     ///< CONSERVED has a meaning
  bool switches_branch = false;  ///< goes on as another type, that of ISW = 1 or 2, on either side of its start
  const char* starts_at = "a branch point (BP)";  ///< the labels at which such a switch starts
  const char* start_example = "BP";               ///< of types whose curve has no number, too
  int starts_from = 0;                            ///< IPS of those labels; 0: its own
  /// A further word of a command that starts there, after IRS, IPS and ISW; {} stands for the name of ICP(1).
  const char* start_word = "";
};

class ProblemType {
 public:
  explicit ProblemType(const ProblemFacts& facts) : facts_(facts) {}
  virtual ~ProblemType() = default;
  ProblemType(const ProblemType&) = delete;
  ProblemType& operator=(const ProblemType&) = delete;
  const ProblemFacts& facts() const { return facts_; }
  const SolutionFamily& family() const { return facts_.family(); }

  /// How many entries of ICP are free, monitors not counted: where events end segments problem parameters, else
  /// durations too. One more for each monitor that is held. Throws UserError where the conditions leave none free.
  int free_entries(const RunSettings& settings) const;
  /// Can a branch of this type start at a label of this type (type number without its tens digit)?
  virtual bool begins_at(int) const { return true; }
  /// Does one start at this label, which is of such a type? Types that share IPS, ISW and labels are asked in the order
  /// of the list.
  virtual bool accepts(const HybridSystem&, const RunSettings&, const SelectedStart&) const { return true; }
  /// Everything that a branch needs before it is computed. Throws UserError when it cannot start there,
  /// ComputationError when no first point is found.
  virtual BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                             const SelectedStart& start) const = 0;
  /// The same without a first point: equations, test functions and follower for solutions like `start`.
  virtual BranchSetup prepare(const HybridSystem& system, const RunSettings& settings,
                              const SelectedStart& start) const = 0;

 private:
  ProblemFacts facts_;
};

/// All there are, in the order of the list.
std::span<const ProblemType* const> problem_types();

/// Those of IPS and ISW (0 stands for 1); several where the label that a run starts from decides.
std::vector<const ProblemType*> problem_types_of(int number, int branch_mode);
/// The first of those, else the first of this IPS; null when there is no such IPS.
const ProblemType* nearest_problem_type(int number, int branch_mode);
/// The first of those. Throws UserError with the list of what there is.
const ProblemType& problem_type(int number, int branch_mode);

/// Is there a type of this ISW whose branch may have twice as many segments as its start?
bool may_double_segments(int branch_mode);
/// What ISW stands for: 1 for 0.
int standard_branch_mode(int branch_mode);
/// Each once, in the order of the list.
std::vector<int> problem_type_numbers();
std::vector<int> branch_modes();
/// "180 (periodic orbits) or 150 (...)"
std::string problem_families();

// What files say, of which some are AUTO's own.

/// One of ours; it may be AUTO's too.
bool is_own_problem_type(int number);
/// Is a number of ours AUTO's too, whose files have no durations?
bool is_shared_problem_type(int number);
/// Files of the older generation hold 0.
bool records_problem_type(int number);
/// The same problem, as far as files tell.
bool is_same_problem_type(int number, int other);
bool keeps_contact(int number);
bool is_two_parameter_curve(int number, int branch_mode);
/// The letters of the points that a two-parameter curve of this IPS consists of, by the tens digit of its labels: "LP",
/// ...; for 4 "BE" of equilibria, "GR" of others; "" for 0.
std::string curve_name(int number, int curve_type);
/// Is there a type that follows folds and the like of this one in two parameters?
bool has_two_parameter_curves(int number);
/// What is born at a label; null where nothing is. `label_type`: its number without the tens digit of a curve;
/// `number`: IPS of the label's branch; `in_two_parameters`: it is a curve.
const ProblemType* birth_type(int label_type, int number, bool in_two_parameters);
/// Words of `tchat run` that follow it: IPS=182, ISW=-1, ICP=[a,rho]; none where nothing is born. `principal`: the name
/// of ICP(1).
Command birth_words(int label_type, int number, bool in_two_parameters, const std::string& principal);
/// AUTO's own boundary value problems have no multipliers.
bool has_multipliers(int number);
/// One multiplier is critical all along, so that stability is none.
bool has_critical_multiplier(int number, int branch_mode);
/// PAR index of the period of AUTO's own periodic orbits; nothing for others.
std::optional<int> auto_period(int number);

}  // namespace tchat
