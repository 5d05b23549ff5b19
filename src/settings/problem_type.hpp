/// What a problem type is: all that other rooms ask of it. Each type is one class in one file of src/kinds,
/// named in the list of that folder's CMakeLists.txt; the classes they work with are known here by name only.
///
/// IPS and ISW, numbers in constants and files, are compared here and nowhere else.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "settings/problem_id.hpp"

namespace tchat {

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
  /// Further words of a command line that starts there, after IRS, IPS and ISW; {} stands for the name of ICP(1).
  const char* start_words = "";
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
/// Words of `tchat run` that follow it, after IRS: " IPS=182 ISW=-1 'ICP=[a,rho]'"; "" where nothing is born.
/// `principal`: the name of ICP(1).
std::string birth_words(int label_type, int number, bool in_two_parameters, const std::string& principal);
/// AUTO's own boundary value problems have no multipliers.
bool has_multipliers(int number);
/// One multiplier is critical all along, so that stability is none.
bool has_critical_multiplier(int number, int branch_mode);
/// PAR index of the period of AUTO's own periodic orbits; nothing for others.
std::optional<int> auto_period(int number);

}  // namespace tchat
