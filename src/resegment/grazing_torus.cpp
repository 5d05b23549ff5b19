#include "resegment/grazing_torus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/user_error.hpp"
#include "settings/point_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// The contact that the label is; nothing when it is none.
std::optional<UserPointKind> contact_of(const LabelledSolution& solution) {
  for (const UserPointKind& kind : all_kinds(solution))
    if (kind.kind == UserPointKind::contact) return kind;
  return std::nullopt;
}

/// Its number in GCIPSI: through the GCHGRZIND lists of all segments in order.
int number_of(const RunSettings& settings, const UserPointKind& contact) {
  int number = 0;
  for (int s = 0; s < segment_count(settings); ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor) {
      ++number;
      if (s + 1 == contact.segment && event == contact.index) return number;
    }
  return 0;
}

}  // namespace

RunSettings grazing_torus_settings(const RunSettings& settings, const LabelledSolution& solution,
                                   const std::string& name, const HybridSystem& system, bool icp_is_given) {
  const std::optional<UserPointKind> contact = contact_of(solution);
  const int number = contact ? number_of(settings, *contact) : 0;
  if (number == 0)
    throw UserError(
        fmt::format("{} is no contact of a torus with a monitored event function (GR): a curve of grazing tori begins "
                    "there; run with "
                    "the event in GCHGRZIND, to a GR label",
                    name));
  RunSettings result = settings;
  result.problem_type = grazing_torus.number;
  result.branch_mode = grazing_torus.branch_mode;
  std::erase(result.test_functions, number);
  result.test_functions.insert(result.test_functions.begin(), number);  // the first one is touched all along
  result.start = {"", solution.label};
  result.user_values.clear();
  result.stop_rules.clear();
  if (icp_is_given) return result;
  for (int k = 1; k <= system.parameters(); ++k) {
    auto& free = result.free_parameters;
    if (std::find(free.begin(), free.end(), k) != free.end()) continue;
    free.push_back(k);
    return result;
  }
  throw UserError(
      fmt::format("{}: every parameter of problem {} is free already, and a curve of grazing tori frees one "
                  "more; take rho out of ICP on the run before",
                  name, system.name()));
}

LabelledSolution grazing_torus_start(LabelledSolution solution) {
  solution.problem_type = grazing_torus.number;
  solution.free_parameters.clear();
  solution.parameter_direction.clear();
  solution.state_direction.resize(0, 0);
  return solution;
}

}  // namespace tchat
