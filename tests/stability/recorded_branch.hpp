/// A branch as ContinuationRun computes it, with the values of all test functions at every point.
#pragma once

#include <string>
#include <vector>

#include "support/branch_fixture.hpp"

namespace tchat::test {

using Tests = std::vector<std::unique_ptr<TestFunction>>;

struct RecordedPoint {
  int number;
  SpecialPoint special;
  Orbit orbit;
  FloquetMultipliers multipliers;
  std::vector<std::optional<double>> values;  ///< of the test functions, in their order
};

class RecordedBranch final : public BranchSink {
 public:
  void point(const BranchPoint& p) override {
    points.push_back({p.number, p.special, p.path.orbit, p.multipliers, {}});
    for (const NamedTestValue& test : p.tests) points.back().values.push_back(test.value);
  }
  void next_step(int, double) override {}
  void note(int, const std::string& text) override { notes.push_back(text); }

  /// Points of a type, in order.
  std::vector<const RecordedPoint*> of_type(PointType type) const {
    std::vector<const RecordedPoint*> result;
    for (const RecordedPoint& p : points)
      if (p.special.type == type) result.push_back(&p);
    return result;
  }
  /// Special points of any type, the branch's ends not among them.
  std::vector<const RecordedPoint*> special() const {
    std::vector<const RecordedPoint*> result;
    for (const RecordedPoint& p : points)
      if (p.special.type != PointType::ordinary && p.special.type != PointType::end) result.push_back(&p);
    return result;
  }

  std::vector<RecordedPoint> points;
  std::vector<std::string> notes;
  BranchSummary summary;
};

/// Continues a corrected start.
inline RecordedBranch record(PathFollower& follower, const DefiningSystem& system, const PathPoint& start,
                             const ContinuationSettings& settings, Tests tests) {
  RecordedBranch branch;
  ContinuationRun run(follower, system, settings, std::move(tests), branch);
  branch.summary = run.run(start);
  return branch;
}

template <class Test, class... Arguments>
Tests one_test(Arguments&&... arguments) {
  Tests tests;
  tests.push_back(std::make_unique<Test>(std::forward<Arguments>(arguments)...));
  return tests;
}

}  // namespace tchat::test
