#include "run/parameter_remarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/parameter_vector.hpp"
#include "plugin/named_parameters.hpp"
#include "settings/constants_file.hpp"
#include "settings/family.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

std::string inherited_bounds(const HybridSystem& system, const RunSettings& in_file, const RunSettings& used,
                             const std::vector<std::string>& overrides, const std::string& file) {
  const int before = in_file.free_parameters.front();
  const int now = used.free_parameters.front();
  if (before == now) return "";
  const RunSettings standard;
  std::string list;
  const auto add = [&](const char* keyword, double value, double standard_value) {
    if (value != standard_value && !is_overridden(overrides, keyword))
      list += fmt::format("{}{} = {:.10g}", list.empty() ? "" : ", ", keyword, value);
  };
  add("RL0", used.parameter_min, standard.parameter_min);
  add("RL1", used.parameter_max, standard.parameter_max);
  if (list.empty()) return "";
  return fmt::format("{} of {} was given for {} and now bounds {}, the new ICP(1); give RL0 and RL1 with it", list,
                     file, parameter_name(system, in_file, before), parameter_name(system, used, now));
}

std::string idle_parameters(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                            std::size_t free_count) {
  static constexpr std::array curves{PointType::fold, PointType::period_doubling, PointType::torus,
                                     PointType::equilibrium_fold, PointType::hopf};
  const auto begins_curve = [](int type) {
    return std::any_of(curves.begin(), curves.end(), [type](PointType t) { return type == static_cast<int>(t); });
  };
  if (problem_type(settings).facts().switches_branch || free_count != 1 ||
      !has_two_parameter_curves(settings.problem_type) ||
      std::none_of(start.types.begin(), start.types.end(), begins_curve))
    return "";
  std::string list;
  std::size_t count = 0;
  for (const int k : settings.free_parameters)
    if (is_parameter(settings, k) && ++count > free_count)
      list += fmt::format("{}{}", list.empty() ? "" : ", ", system.parameter_name(k));
  if (list.empty()) return "";
  return fmt::format(
      "{} of ICP stays fixed with ISW = 1, a mere column; ISW=2 follows the curve of {} in two parameters", list,
      type_name(start.type, start.kind));
}

}  // namespace tchat
