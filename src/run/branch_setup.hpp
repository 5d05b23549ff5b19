/// What a branch needs before files are opened, and the problem types as rows of a table that provide it.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/messages.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/bordered_problem.hpp"
#include "orbit/defining_system.hpp"
#include "run/first_correction.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

// Everything a branch needs before files are opened: equations, follower, test functions, the first point.
//
// The branch mode (ISW) decides: 1 continues the orbit of the start; 2 follows the two-parameter curve of the fold,
// period doubling, torus bifurcation or branch point at the start, 3 or more one in so many parameters; -1 switches at
// the start to the branch that bifurcates there.

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

// A problem type as a row: facts, equations, the condition of a curve and its test functions.

/// What a type adds to the equations of one solution. `tests` are those of the curve: they may refer to the condition.
struct BranchCurve {
  std::unique_ptr<OrbitCondition> condition = nullptr;
  std::function<TestList(const RunSettings&)> tests;
  std::function<std::string(const Orbit&)> label_remark = {};  ///< BranchSetup::label_remark
};

/// The curve of a condition; `add_special_points(tests, condition)` adds the special points on it.
template <class Condition, class Add>
BranchCurve curve_of(const DefiningSystem& system, std::unique_ptr<Condition> condition, Add add_special_points) {
  const Condition& kept = *condition;
  return {std::move(condition), [&system, &kept, add_special_points](const RunSettings& settings) {
            TestList tests = contact_tests(system, settings);
            add_special_points(tests, kept);
            add_turning_points(tests, system, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

/// A type whose equations are those of a System.
template <class System>
class ProblemRow final : public ProblemType {
 public:
  /// The equations of one solution.
  using MakeSystem = std::unique_ptr<System> (*)(const HybridSystem&, const RunSettings&, std::vector<int> free);
  /// The curve that starts at a solution. Throws UserError where none does.
  using MakeCurve = BranchCurve (*)(const System&, const RunSettings&, const SelectedStart&);
  /// Changes a start so that it fits the equations. Throws UserError where no such branch starts there.
  using Adapt = void (*)(const HybridSystem&, const RunSettings&, SelectedStart&);
  /// Does the branch start at a label of the types that it may start at?
  using Accepts = bool (*)(const HybridSystem&, const RunSettings&, const SelectedStart&);

  /// `starts_at`: types of labels; empty: any.
  ProblemRow(const ProblemFacts& facts, std::vector<PointType> starts_at, MakeSystem make_system, MakeCurve make_curve,
             Adapt adapt = nullptr, Accepts accepts = nullptr)
      : ProblemType(facts),
        starts_at_(std::move(starts_at)),
        make_system_(make_system),
        make_curve_(make_curve),
        adapt_(adapt),
        accepts_(accepts) {}

  bool begins_at(int label_type) const override { return starts_at_.empty() || is_among(starts_at_, label_type); }
  bool accepts(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) const override {
    return accepts_ == nullptr || accepts_(system, settings, start);
  }

  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    SelectedStart adapted = start;
    if (adapt_ != nullptr) adapt_(system, settings, adapted);
    BranchSetup setup = prepare(system, settings, adapted);
    setup.start = first_point(*setup.follower, *setup.defining, adapted, settings);
    return setup;
  }

  BranchSetup prepare(const HybridSystem& system, const RunSettings& settings,
                      const SelectedStart& start) const override {
    std::unique_ptr<System> equations = make_system_(system, settings, free_problem_parameters(settings));
    BranchCurve curve = make_curve_(*equations, settings, start);
    BranchSetup setup{this, settings};
    setup.make_tests = [tests = std::move(curve.tests), settings] { return tests(settings); };
    setup.label_remark = std::move(curve.label_remark);
    setup.defining = std::move(equations);
    attach_follower(setup, std::move(curve.condition), start.start.orbit);
    return setup;
  }

 private:
  std::vector<PointType> starts_at_;
  MakeSystem make_system_;
  MakeCurve make_curve_;
  Adapt adapt_;
  Accepts accepts_;
};

/// The labels at which switch_branch (run/branch_switch.hpp) starts.
inline std::vector<PointType> branch_switch_labels() {
  return {PointType::period_doubling, PointType::branch_point, PointType::equilibrium_branch_point};
}

/// A type that goes on, from a label, as another type of the same IPS.
class SwitchRow final : public ProblemType {
 public:
  using SetUp = BranchSetup (*)(const HybridSystem&, const RunSettings&, const SelectedStart&);

  SwitchRow(const ProblemFacts& facts, std::vector<PointType> starts_at, SetUp set_up)
      : ProblemType(facts), starts_at_(std::move(starts_at)), set_up_(set_up) {}

  bool begins_at(int label_type) const override { return is_among(starts_at_, label_type); }
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    return set_up_(system, settings, start);
  }
  BranchSetup prepare(const HybridSystem& system, const RunSettings& settings,
                      const SelectedStart& start) const override {
    return followed().prepare(system, settings, start);
  }

 private:
  /// The type of the curve that begins at the label, else that of ISW = 1.
  const ProblemType& followed() const {
    for (const ProblemType* type : problem_types_of(facts().number, orbit_curve.branch_mode))
      if (facts().curve != 0 && type->facts().curve == facts().curve) return *type;
    return problem_type(facts().number, 1);
  }

  std::vector<PointType> starts_at_;
  SetUp set_up_;
};

}  // namespace tchat
