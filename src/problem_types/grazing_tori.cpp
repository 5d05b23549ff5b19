/// Tori in grazing contact: those of bvp/torus_system.hpp with one condition more
/// (special_points/torus_contact_condition.hpp). Three parameters are free, rho may be one of them.
#include "bvp/torus_system.hpp"
#include "constants/settings_type.hpp"
#include "run/torus_problem.hpp"
#include "special_points/torus_contact_condition.hpp"
#include "text/user_error.hpp"

namespace tchat::types {

namespace {

class GrazingTori final : public TorusProblem {
 public:
  GrazingTori()
      : TorusProblem(
            {.number = grazing_torus.number,
             .branch_mode = grazing_torus.branch_mode,
             .curve = 0,
             .family = "invariant tori in grazing contact",
             .title = "invariant tori in grazing contact, rho and two parameters free, or three with rho fixed",
             .free_parameters = 3,
             .is_torus = true,
             .stability = StabilityMeaning::without_contact}) {}

  /// The first chosen event is the one that the torus touches.
  std::unique_ptr<OrbitCondition> torus_condition(const TorusSystem& system, const OrbitShape& shape,
                                                  const RunSettings& one_return) const override {
    const auto events = chosen_events(one_return, segment_count(one_return));
    if (events.empty())
      throw UserError(
          "IPS = 152 follows tori that touch a monitored event function, and GCHGRZIND lists none: name it on "
          "the segment where it is touched, as in GCHGRZIND=[[1]]");
    return std::make_unique<TorusContactCondition>(system, shape, events.front().segment, events.front().event);
  }

  std::vector<std::unique_ptr<TestFunction>> tests(const DefiningSystem& defining,
                                                   const RunSettings& settings) const override {
    const auto& system = static_cast<const TorusSystem&>(defining);
    auto events = chosen_events(settings, system.segments_per_return());
    if (!events.empty()) events.erase(events.begin());
    return torus_tests(system, settings, events);
  }
};

}  // namespace

const ProblemType& grazing_tori() {
  static const GrazingTori type;
  return type;
}

}  // namespace tchat::types
