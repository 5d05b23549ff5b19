/// What the problem types of invariant tori share.
#pragma once

#include "problem_type/problem_type.hpp"

namespace tchat {

class TorusSystem;
struct OrbitShape;

class TorusProblem : public ProblemType {
 public:
  explicit TorusProblem(const ProblemFacts& facts) : ProblemType(facts) {}

  /// The condition of a curve of tori that have one; `one_return`: the settings as the user gave them.
  virtual std::unique_ptr<OrbitCondition> torus_condition(const TorusSystem& system, const OrbitShape& shape,
                                                          const RunSettings& one_return) const;
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override;
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override;
  /// Rotation number, frequencies, harmonics.
  std::string remark(const BranchSetup& setup, const Orbit& x) const override;
  bool outgrown(const BranchSetup& setup, const Orbit& x) const override;
  BranchSetup refined(const BranchSetup& setup, const PathPoint& last) const override;
  std::string unresolved(const BranchSetup& setup, const Orbit& x) const override;
};

/// A monitored event function on a segment (from 0) of the return.
struct MonitoredEvent {
  int segment;
  int event;
};

/// Those that GCIPSI chooses, in its order; all of GCHGRZIND with an empty GCIPSI.
std::vector<MonitoredEvent> chosen_events(const RunSettings& settings, int segments_per_return);

/// Least values of the events, strong resonances where rho is free, the fold, user values.
std::vector<std::unique_ptr<TestFunction>> torus_tests(const TorusSystem& system, const RunSettings& settings,
                                                       const std::vector<MonitoredEvent>& events);

}  // namespace tchat
