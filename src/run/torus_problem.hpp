/// The problem types of invariant tori: what their runs do with settings of one return.
#pragma once

#include "run/problem_row.hpp"

namespace tchat {

class TorusSystem;

class TorusProblem final : public ProblemType {
 public:
  /// The curve that tori of this shape make; `one_return`: the settings as the user gave them. Throws UserError where
  /// they do not say what the curve keeps.
  using MakeCurve = BranchCurve (*)(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);

  TorusProblem(const ProblemFacts& facts, MakeCurve make_curve) : ProblemType(facts), make_curve_(make_curve) {}

  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override;
  /// As many orbits as the start has.
  BranchSetup prepare(const HybridSystem& system, const RunSettings& one_return,
                      const SelectedStart& start) const override;

 private:
  MakeCurve make_curve_;
};

/// Tori, without a further condition.
BranchCurve free_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);
/// Tori in grazing contact (stability/torus_contact_condition.hpp) with the first chosen event.
BranchCurve touching_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);

/// A monitored event function on a segment (from 0) of the return.
struct MonitoredEvent {
  int segment;
  int event;
};

/// Those that GCIPSI chooses, in its order; all of GCHGRZIND with an empty GCIPSI.
std::vector<MonitoredEvent> chosen_events(const RunSettings& settings, int segments_per_return);

}  // namespace tchat
