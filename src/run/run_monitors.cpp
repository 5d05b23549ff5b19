#include "run/run_monitors.hpp"

#include "plugin/named_parameters.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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
