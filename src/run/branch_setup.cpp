#include "run/branch_setup.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bvp/critical_multiplier.hpp"
#include "constants/user_error.hpp"
#include "run/branch_switch.hpp"
#include "run/problem_setup.hpp"
#include "start/point_type.hpp"

namespace tchat {

namespace {

constexpr int fold = static_cast<int>(PointType::fold);
constexpr int period_doubling = static_cast<int>(PointType::period_doubling);

/// The curve that a label lies on: of its own type, or the one that it was computed on (tens digit).
int curve_through(const SelectedStart& selected) {
  const int tens = std::abs(selected.type) / 10;
  const int type = tens > 0 ? tens : selected.type;
  if (type == fold || type == period_doubling) return type;
  throw UserError(fmt::format(
      "{}: ISW = 2 follows the curve of a fold (LP) or a period doubling (PD) in two parameters, but the run starts "
      "from {}; name such a label, for example IRS=LP1",
      selected.source,
      selected.from_solution ? fmt::format("a label of type {}", type_name(selected.type, selected.kind).empty()
                                                                     ? "none"
                                                                     : type_name(selected.type, selected.kind))
                             : "data"));
}

}  // namespace

BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  if (settings.branch_mode == -1) return switch_branch(system, settings, selected);
  BranchSetup setup{settings, nullptr, nullptr, {}, 0};
  const ProblemType& type = problem_type(settings);
  setup.defining = type.make(system, settings, free_problem_parameters(type, settings));
  const OrbitShape& shape = selected.start.orbit.shape;
  check_memory(shape, setup.defining->free_count());
  std::unique_ptr<OrbitCondition> condition;
  if (settings.branch_mode == 2) {
    setup.curve_type = curve_through(selected);
    condition = std::make_unique<CriticalMultiplier>(*setup.defining, shape, setup.curve_type == fold ? 1 : -1);
  }
  setup.follower =
      std::make_unique<PathFollower>(*setup.defining, shape, weighted_norm(settings), newton_settings(settings),
                                     settings.free_parameters.front(), std::move(condition));
  setup.start = first_point(*setup.follower, *setup.defining, selected, settings);
  return setup;
}

}  // namespace tchat
