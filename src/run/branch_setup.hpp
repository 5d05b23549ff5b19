/// Everything a branch needs before files are opened: equations, follower, test functions, the first point.
///
/// The branch mode (ISW) decides: 1 continues the orbit of the start; 2 follows the two-parameter curve of the fold,
/// period doubling, torus bifurcation or branch point at the start, 3 or more one in so many parameters; -1 switches at
/// the start to the branch that bifurcates there.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/user_error.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/defining_system.hpp"
#include "run/branch_start.hpp"
#include "run/test_lists.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

class ProblemType;
struct BranchSetup;

/// The discretisation of a branch, asked at each of its points.
class Discretisation {
 public:
  virtual ~Discretisation() = default;
  /// A line about each point, or "".
  virtual std::string remark(const Orbit&) const { return {}; }
  /// Does x need another discretisation?
  virtual bool is_outgrown(const Orbit& /*x*/) const { return false; }
  /// The branch on that one from `last` on; without a follower where no solution is found on it. Unless said otherwise
  /// twice as many mesh intervals, for branches without a scalar condition of a curve.
  virtual BranchSetup refined(const BranchSetup& setup, const PathPoint& last) const;
  /// Why the branch ends at x: no discretisation within the limits resolves it; "".
  virtual std::string why_unresolved(const Orbit& /*x*/) const { return {}; }
};

struct BranchSetup {
  const ProblemType* type = nullptr;  ///< really followed: after a switch that of the new branch
  RunSettings settings = {};          ///< likewise: after a switch its signature and branch mode
  std::unique_ptr<DefiningSystem> defining = nullptr;
  std::unique_ptr<PathFollower> follower = nullptr;
  /// Makes the test functions of the branch; they refer to the defining system and to the follower's condition.
  std::function<TestList()> make_tests = {};
  std::shared_ptr<const Discretisation> discretisation = std::make_shared<Discretisation>();
  /// What there is to say of a labelled point, in a line; may be empty.
  std::function<std::string(const Orbit&)> label_remark = {};
  FirstPoint start = {};
  /// What is written as the constants of the run where these are not its settings: of a torus those of one return.
  std::optional<RunSettings> constants = {};
};

/// There is no curve of the kind at the start.
class NoCurveError : public UserError {
 public:
  using UserError::UserError;
};

/// Gives the set-up, whose equations are there, a follower for solutions like `start`. Throws UserError when it would
/// need more memory than there is.
void attach_follower(BranchSetup& setup, std::unique_ptr<OrbitCondition> condition, const Orbit& start);

/// Throws UserError when the start is not of a kind that the branch mode can begin at, ComputationError when no first
/// point is found.
BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

}  // namespace tchat
