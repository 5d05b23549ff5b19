/// From a period doubling or branch point to the branch that bifurcates there (run/branch_switch.hpp), which is one of
/// ISW = 1.
#pragma once

#include "problem_type/problem_type.hpp"

namespace tchat {

class BranchSwitch : public ProblemType {
 public:
  explicit BranchSwitch(const ProblemFacts& facts) : ProblemType(facts) {}

  /// Period doublings and branch points.
  bool begins_at(int label_type) const override;
  int free_entries(const RunSettings& settings) const override { return followed().free_entries(settings); }
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override;
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override;
  std::vector<std::unique_ptr<TestFunction>> tests(const DefiningSystem& defining,
                                                   const RunSettings& settings) const override;

 private:
  const ProblemType& followed() const { return problem_type(facts().number, 1); }
};

}  // namespace tchat
