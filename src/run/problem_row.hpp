/// A problem type as a row: facts, equations, the condition of a curve and its test functions.
#pragma once

#include <algorithm>
#include <vector>

#include "orbit/bordered_problem.hpp"
#include "run/branch_setup.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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
