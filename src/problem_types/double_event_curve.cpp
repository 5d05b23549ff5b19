/// Periodic orbits at which two events come at once, in two parameters (bvp/event_condition.hpp): where sliding begins
/// or ends (crossing- and switching-sliding), or where an impact meets another surface.
#include <fmt/format.h>

#include <cstdlib>

#include "bvp/event_condition.hpp"
#include "bvp/event_minima.hpp"
#include "bvp/no_duration.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "constants/run_settings.hpp"
#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"
#include "special_points/bifurcation_tests.hpp"
#include "start/start_selection.hpp"
#include "text/user_error.hpp"

namespace tchat::types {

namespace {

[[noreturn]] void refuse(const SelectedStart& start, const std::string& why) {
  throw UserError(fmt::format("{}: no curve with ISW = 2 begins at label {} (GR): {}", start.source, start.label, why));
}

/// Where the second event function vanishes. A segment that lasts no time has the same state at both ends: at its start
/// its own event function is not among the conditions.
std::unique_ptr<OrbitCondition> condition_at(const DefiningSystem& defining, const SelectedStart& start) {
  const UserPointKind& kind = start.kind;
  const Orbit& x = start.start.orbit;
  const int s = kind.segment - 1;
  if (kind.kind == UserPointKind::impact_velocity)
    refuse(start, fmt::format("the orbit is tangent to the surface of event {} at the end of segment {}; tchat "
                              "resegment --to grazing-curve makes the start of the curve of such orbits",
                              kind.index, kind.segment));
  if (kind.kind != UserPointKind::contact || s < 0 || s >= defining.segments())
    refuse(start, "the label is no place where two events come at once");
  const bool whole = lasts_no_time(x, s);
  if (!whole && kind.tau > 0.0 && kind.tau < 1.0)
    refuse(start, fmt::format("the contact is inside segment {}, where the orbit touches a surface; tchat resegment "
                              "--to grazing-curve makes the start of the curve of such orbits",
                              kind.segment));
  const bool at_end = !whole && kind.tau == 1.0;
  const bool ended_by = at_end && defining.signature()[static_cast<std::size_t>(s)].event == kind.index;
  if (ended_by || (!at_end && is_pinned_start(defining.system(), defining.signature(), x, s, kind.index)))
    refuse(start, fmt::format("event {} vanishes at the {} of segment {} for every orbit of this signature", kind.index,
                              at_end ? "end" : "start", kind.segment));
  return std::make_unique<EventCondition>(defining, x.shape, s, kind.index, at_end);
}

class DoubleEventCurve final : public ProblemType {
 public:
  DoubleEventCurve()
      : ProblemType({.number = periodic_orbit.number,
                     .branch_mode = 2,
                     .curve = double_event_curve_type,
                     .family = "periodic orbits",
                     .title = "two events at once, such as the onset of sliding, in two parameters",
                     .free_parameters = 2}) {}

  bool begins_at(int label_type) const override { return std::abs(label_type) == double_event_curve_type; }
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return std::make_unique<PeriodicOrbitSystem>(system, settings.signature(), std::move(free_parameters));
  }
  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return condition_at(defining, start);
  }

  /// A fold in the principal parameter means nothing here.
  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override {
    TestList tests = contact_tests(defining, settings);
    const int kind = std::abs(settings.detect_bifurcations);
    const bool stop = settings.detect_bifurcations < 0;
    if (kind == 2 || kind == 3) tests.push_back(std::make_unique<BranchPointTest>(stop));
    if (kind == 2 || kind == 4) {
      tests.push_back(std::make_unique<PeriodDoublingTest>(stop));
      tests.push_back(std::make_unique<TorusTest>(stop));
    }
    add_user_values(tests, defining.system(), settings);
    return tests;
  }

 private:
  /// The tens digit of its points: that of UZ, which GR labels have in files.
  static constexpr int double_event_curve_type = -static_cast<int>(PointType::user);
};

}  // namespace

const ProblemType& double_event_curve() {
  static const DoubleEventCurve type;
  return type;
}

}  // namespace tchat::types
