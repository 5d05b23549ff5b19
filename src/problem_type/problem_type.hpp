/// What a problem type is: all that other rooms ask of it. Each type is one class in one file of src/problem_types,
/// named in the list of that folder's CMakeLists.txt; the classes they work with are known here by name only.
///
/// IPS and ISW, numbers in constants and files, are compared here and nowhere else.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tchat {

class DefiningSystem;
class HybridSystem;
class OrbitCondition;
class TestFunction;
struct BranchSetup;
struct Orbit;
struct PathPoint;
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
  int number;             ///< IPS
  int branch_mode;        ///< ISW
  int curve;              ///< type number of the points that such a two-parameter curve consists of; 0: no such curve
  const char* family;     ///< what IPS says, in words
  const char* title;      ///< what IPS and ISW say together
  int free_parameters;    ///< problem parameters that are free, durations not counted; 0: the settings decide
  bool has_ring = true;   ///< events end the segments, jumps tie them in a ring, every duration is free
  bool is_torus = false;  ///< an invariant torus: the signature is one return, of which there are several orbits
  bool is_point = false;  ///< an equilibrium: one state, no duration; eigenvalues take the place of multipliers
  StabilityMeaning stability = StabilityMeaning::orbit;
  bool keeps_contact = false;    ///< a segment ends in grazing contact (GCSEGTYP = 2); GCIPSI lists n of xi_n
  bool may_double = false;       ///< the branch may have twice as many segments as its start
  bool switches_branch = false;  ///< goes on as the type that ISW = 1 names, on either side of its start
};

class ProblemType {
 public:
  explicit ProblemType(const ProblemFacts& facts) : facts_(facts) {}
  virtual ~ProblemType() = default;
  ProblemType(const ProblemType&) = delete;
  ProblemType& operator=(const ProblemType&) = delete;
  const ProblemFacts& facts() const { return facts_; }

  /// How many entries of ICP are free, monitors not counted: in a ring problem parameters, else durations too. One more
  /// for each monitor that is held. Throws UserError where the conditions leave none free.
  virtual int free_entries(const RunSettings& settings) const;
  /// Can a branch of this type begin at a label of this type (type number without its tens digit)?
  virtual bool begins_at(int) const { return true; }
  /// The rows that tie the segments together.
  virtual std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                                      std::vector<int> free_parameters) const = 0;
  /// The scalar condition of a two-parameter curve; null for none.
  virtual std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                         const SelectedStart& start) const;
  /// Everything that a branch needs before it is computed. Throws UserError when it cannot begin at the start,
  /// ComputationError when no first point is found.
  virtual BranchSetup set_up(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) const;
  /// A line about each point, or "".
  virtual std::string remark(const BranchSetup&, const Orbit&) const { return {}; }

  // Where a branch needs another discretisation than it began with, asked at each of its points.

  /// Is the branch to go on with another one?
  virtual bool outgrown(const BranchSetup&, const Orbit&) const { return false; }
  /// That one, at the point where the branch was left; without a follower where no solution is found on it. Unless the
  /// type says otherwise twice as many mesh intervals, for types without a scalar condition of a curve.
  virtual BranchSetup refined(const BranchSetup& setup, const PathPoint& last) const;
  /// Why the branch ends here, for want of one within the limits; "".
  virtual std::string unresolved(const BranchSetup&, const Orbit&) const { return {}; }

  /// The test functions of a branch.
  virtual std::vector<std::unique_ptr<TestFunction>> tests(const DefiningSystem& defining,
                                                           const RunSettings& settings) const = 0;

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
/// Do events end the segments and jumps tie them?
bool has_ring(int number);
/// Is every solution an invariant torus: orbits of one return each, as many as the solution has segments for?
bool is_torus(int number);
/// Is every solution one state, an equilibrium?
bool is_point(int number);
/// Do conditions of the problem's own tie the segments?
bool has_own_conditions(int number);
/// Files of the older generation hold 0.
bool tells_problem_type(int number);
/// The same problem, as far as files tell.
bool is_same_problem_type(int number, int other);
bool keeps_contact(int number);
bool is_two_parameter_curve(int number, int branch_mode);
/// Is there a type that follows folds and the like of this one in two parameters?
bool has_two_parameter_curves(int number);
/// AUTO's own boundary value problems have no multipliers.
bool has_multipliers(int number);
/// One multiplier is critical all along, so that stability is none.
bool has_critical_multiplier(int number, int branch_mode);
/// PAR index of the period of AUTO's own periodic orbits; nothing for others.
std::optional<int> auto_period(int number);

/// Types whose constants other rooms make.
struct ProblemId {
  int number;
  int branch_mode;
};
inline constexpr ProblemId periodic_orbit{180, 1};
inline constexpr ProblemId branch_switch{180, -1};
inline constexpr ProblemId grazing_orbit{150, 1};
inline constexpr ProblemId invariant_torus{182, 1};
inline constexpr ProblemId torus_birth{182, -1};
inline constexpr ProblemId grazing_torus{152, 1};
inline constexpr ProblemId boundary_value{4, 1};
inline constexpr ProblemId equilibrium{1, 1};

}  // namespace tchat
