#include "setup/run_monitors.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "constants/settings_type.hpp"
#include "problem_type/family.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

/// Those of segments that the orbit has, and what may be held or be the principal parameter.
void check_monitor(const RunSettings& settings, int index, const MonitorName& monitor, const SettingsSource& source) {
  const auto refuse = [&](const char* keyword, const std::string& why) {
    throw UserError(fmt::format("{}: {}: {}", source.of(keyword),
                                settings.monitors[static_cast<std::size_t>(index - first_monitor(settings))], why));
  };
  const bool has_multipliers = family_of(settings).facts().has_return_map;
  const bool of_segment = monitor.kind != MonitorName::Kind::multiplier && monitor.number > 0;
  if (of_segment && monitor.number > segment_count(settings))
    refuse("ICP",
           fmt::format("the orbit has {} segment{}", segment_count(settings), segment_count(settings) == 1 ? "" : "s"));
  if (monitor.kind == MonitorName::Kind::velocity &&
      settings.segments[static_cast<std::size_t>(monitor.number - 1)].index.event == no_function)
    refuse("ICP", "no event function ends that segment; end(X, S) is the value of any function there");
  if (monitor.kind != MonitorName::Kind::multiplier) return;
  if (!has_multipliers || settings.detect_bifurcations == 0)
    refuse("ICP", has_multipliers ? "multipliers are not computed with ISP = 0; give ISP another value"
                                  : "there are no multipliers");
  if (monitor.number > settings.dimension)
    refuse("UZR", fmt::format("the orbit has as many multipliers as states; allowed: multiplier(1) to multiplier({})",
                              settings.dimension));
  const auto holds = [index](const HeldValue& held) { return held.parameter == index; };
  if (std::any_of(settings.held.begin(), settings.held.end(), holds))
    refuse("HOLD",
           "the modulus of a multiplier cannot be held, for it is not smooth where two of them meet; ISW = 2 follows "
           "folds, period doublings and torus bifurcations");
  if (settings.free_parameters.front() == index)
    refuse("ICP", "the modulus of a multiplier may be a further entry of ICP, not its first");
}

std::vector<MonitorName> monitor_names(const HybridSystem& system, const RunSettings& settings) {
  std::vector<MonitorName> list;
  for (const std::string& name : settings.monitors) list.push_back(parse_monitor(system, name, "constants"));
  return list;
}

}  // namespace

std::string parameter_name(const HybridSystem& system, const RunSettings& settings, int k) {
  if (is_monitor(settings, k)) return settings.monitors[static_cast<std::size_t>(k - first_monitor(settings))];
  return is_duration(settings, k) ? settings.layout.duration_name(k) : system.parameter_name(k);
}

std::string held_text(const HybridSystem& system, const RunSettings& settings) {
  std::string text;
  for (const HeldValue& held : settings.held)
    text += (text.empty() ? "" : ", ") + parameter_name(system, settings, held.parameter);
  return text;
}

void check_monitors(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source) {
  const std::vector<MonitorName> list = monitor_names(system, settings);
  for (std::size_t i = 0; i < list.size(); ++i)
    check_monitor(settings, first_monitor(settings) + static_cast<int>(i), list[i], source);
}

std::shared_ptr<const Monitor> principal_monitor(const DefiningSystem& system, const RunSettings& settings) {
  const int k = settings.free_parameters.front();
  if (!is_monitor(settings, k)) return nullptr;
  return make_monitor(parse_monitor(system.system(), parameter_name(system.system(), settings, k), "ICP"), system);
}

BranchMonitors branch_monitors(const DefiningSystem& system, const RunSettings& settings, const Orbit& start) {
  const std::vector<MonitorName> names = monitor_names(system.system(), settings);
  const CollocationRule rule(start.shape.collocation);
  BranchMonitors monitors{MonitorSet(names, system), {}};
  for (const HeldValue& held : settings.held) {
    std::shared_ptr<const Monitor> monitor =
        is_monitor(settings, held.parameter)
            ? make_monitor(names[static_cast<std::size_t>(held.parameter - first_monitor(settings))], system)
            : make_duration_monitor(settings.layout.duration_segment(held.parameter));
    const double value = held.value ? *held.value : monitor->value(start, rule);
    monitors.held.push_back({std::move(monitor), value, parameter_name(system.system(), settings, held.parameter)});
  }
  return monitors;
}

}  // namespace tchat
