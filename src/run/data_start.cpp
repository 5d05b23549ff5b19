#include "run/data_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "files/parameter_values.hpp"
#include "files/trajectory_rows.hpp"
#include "plugin/named_parameters.hpp"
#include "run/trajectory_start.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

bool given_on_command_line(const HybridSystem& system, const RunSettings& settings, int k) {
  for (const RunSettings::ParameterValue& value : settings.parameter_values)
    if (parameter_index(system, value.name, "command line") == k) return true;
  return false;
}

}  // namespace

OrbitShape shape_of_segments(const RunSettings& settings) {
  const OrbitShape in_common{settings.dimension, segment_count(settings), settings.mesh_intervals,
                             settings.collocation_points};
  return settings.own_meshes ? in_common.with_own_meshes() : in_common;
}

SelectedStart start_from_state(const std::string& path, const RunSettings& settings, const HybridSystem& system) {
  const DatFile data = read_point_dat_file(path, settings.dimension);
  SelectedStart selected;
  selected.source = path;
  selected.known_parameters = initial_parameters(system);
  for (const auto& [k, value] : given_parameters(data, system, path, selected.known_parameters))
    selected.known_parameters(k - 1) = value;
  ParameterVector par = selected.known_parameters;
  apply_command_line(system, settings, par);
  par.duration(0) = 0.0;
  selected.start.orbit = point_from_data(data, par);
  selected.label_start = settings.start.from_data();
  selected.last_label = selected.label_start ? 0 : 1;
  return selected;
}

SelectedStart start_from_orbit(const std::string& path, const RunSettings& settings, const HybridSystem& system) {
  const int m = segment_count(settings);
  const DatFile data =
      looks_like_trajectory(path) ? data_of_trajectory(path, settings) : read_dat_file(path, settings.dimension, m);
  ParameterVector par = initial_parameters(system);
  par.make_room(m);
  const ParameterLayout& layout = par.layout();
  std::vector<bool> given(static_cast<std::size_t>(m), false);
  const auto set = [&](int k, double value) {
    par(k - 1) = value;
    if (layout.is_duration(k, m)) given[static_cast<std::size_t>(layout.duration_segment(k))] = true;
  };
  const tchat_problem& table = system.table();
  for (int s = 0; table.initial_durations != nullptr && s < std::min(m, table.durations); ++s)
    if (std::isfinite(table.initial_durations[s])) set(layout.duration(s), table.initial_durations[s]);
  for (std::size_t s = 0; s < data.durations.size(); ++s) set(layout.duration(static_cast<int>(s)), data.durations[s]);
  for (const auto& [k, value] : given_parameters(data, system, path, par)) set(k, value);
  const ParameterVector known = par;
  apply_command_line(system, settings, par);
  for (int s = 0; s < m; ++s) {
    if (given[static_cast<std::size_t>(s)] || given_on_command_line(system, settings, layout.duration(s))) continue;
    if (m > 1)
      throw UserError(fmt::format(
          "{}: the duration of segment {} is not given; with several segments every one is needed, add a line "
          "`# PAR({}) = value` to the file or 'PAR({})=value' to the command line",
          path, s + 1, layout.duration(s), layout.duration(s)));
    par.duration(0) = data.span;
  }
  const OrbitShape shape = shape_of_segments(settings);
  SelectedStart selected;
  selected.source = path;
  selected.start.orbit = orbit_from_data(data, shape, par);
  selected.second = orbit_from_rows(data, shape, par);
  selected.known_parameters = known;
  selected.known_parameters.durations(m) = par.durations(m);
  selected.label_start = settings.start.from_data();
  selected.last_label = selected.label_start ? 0 : 1;
  return selected;
}

}  // namespace tchat
