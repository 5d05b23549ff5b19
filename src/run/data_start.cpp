#include "run/data_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "files/run_files.hpp"
#include "files/simulation_files.hpp"
#include "files/solution_file.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_file.hpp"
#include "settings/run_settings.hpp"
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

namespace {

/// A motion has returned when it is nearer than this, as a share of its range, and had been farther than `away`.
constexpr double near = 0.1, away = 0.3;

OrbitPart part_of(const RecordedRows& rows) { return {rows.times, rows.states}; }

/// Largest minus least value of each state, 1 where it is constant.
Eigen::VectorXd range_of(const std::vector<RecordedRows>& segments) {
  Eigen::VectorXd low = segments.front().states.col(0), high = low;
  for (const RecordedRows& rows : segments) {
    low = low.cwiseMin(rows.states.rowwise().minCoeff());
    high = high.cwiseMax(rows.states.rowwise().maxCoeff());
  }
  return (high - low).unaryExpr([](double range) { return range > 0.0 ? range : 1.0; });
}

bool follows(const std::vector<RecordedRows>& segments, std::size_t first, const Signature& signature) {
  for (std::size_t s = 0; s < signature.size(); ++s)
    if (segments[first + s].index != signature[s]) return false;
  return true;
}

/// The first segment of the part that closes best; nothing where the signature does not occur before another segment.
std::optional<std::size_t> best_period(const std::vector<RecordedRows>& segments, const Signature& signature) {
  const Eigen::VectorXd range = range_of(segments);
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first + signature.size() < segments.size(); ++first) {
    if (!follows(segments, first, signature)) continue;
    const Eigen::VectorXd miss = segments[first + signature.size()].states.col(0) - segments[first].states.col(0);
    const double distance = miss.cwiseQuotient(range).lpNorm<Eigen::Infinity>();
    if (distance > least) continue;
    least = distance;
    best = first;
  }
  return best;
}

/// The point nearest to `state` on the line from row k to the next one.
struct NearestPoint {
  double share = 0.0;  ///< of the way to the next row
  double distance = std::numeric_limits<double>::infinity();
};

NearestPoint nearest_point(const RecordedRows& rows, Eigen::Index k, const Eigen::VectorXd& state,
                           const Eigen::VectorXd& range) {
  const Eigen::VectorXd from = (rows.states.col(k) - state).cwiseQuotient(range);
  const Eigen::VectorXd step = (rows.states.col(k + 1) - rows.states.col(k)).cwiseQuotient(range);
  const double length = step.squaredNorm();
  const double share = length > 0.0 ? std::clamp(-from.dot(step) / length, 0.0, 1.0) : 0.0;
  return {share, (from + share * step).norm()};
}

/// The last part of the motion that returns to its final state.
std::optional<OrbitPart> last_return(const RecordedRows& rows) {
  const Eigen::VectorXd range = range_of({rows});
  const Eigen::Index last = rows.states.cols() - 1;
  const Eigen::VectorXd state = rows.states.col(last);
  const auto distance = [&](Eigen::Index k) { return nearest_point(rows, k, state, range).distance; };
  Eigen::Index k = last - 1;
  while (k >= 0 && distance(k) < away) --k;
  while (k >= 0 && distance(k) >= near) --k;
  if (k < 0) return std::nullopt;
  while (k > 0 && distance(k - 1) < distance(k)) --k;
  const double share = nearest_point(rows, k, state, range).share;
  const auto row = static_cast<std::size_t>(k);
  OrbitPart part;
  part.times.assign(rows.times.begin() + k, rows.times.end());
  part.times.front() += share * (rows.times[row + 1] - rows.times[row]);
  part.states = rows.states.rightCols(last - k + 1);
  part.states.col(0) += share * (rows.states.col(k + 1) - rows.states.col(k));
  if (!(part.times[1] > part.times[0])) return std::nullopt;
  return part;
}

std::vector<OrbitPart> parts_of(const std::vector<RecordedRows>& segments, const Signature& signature,
                                const std::string& path) {
  const std::size_t m = signature.size();
  std::vector<OrbitPart> parts;
  const bool is_table = segments.front().index.field == no_function;
  const bool is_smooth = m == 1 && signature.front().event == no_function;
  if (is_smooth && !is_table) {
    const std::optional<OrbitPart> period = last_return(segments.back());
    if (!period)
      throw UserError(
          fmt::format("{}: the motion does not return to its last state; simulate longer, or with smaller "
                      "steps between rows (--rows)",
                      path));
    return {*period};
  }
  if (is_table && segments.size() != m)
    throw UserError(fmt::format("{}: it has {} segments, the signature {} has {}; give constants with that signature",
                                path, segments.size(), to_string(signature), m));
  const std::optional<std::size_t> first = is_table ? std::optional<std::size_t>(0) : best_period(segments, signature);
  if (!first)
    throw UserError(fmt::format(
        "{}: the motion has no segments {} one after the other with a further one behind them; give constants with the "
        "signature of the motion (tchat simulate NAME --dat O writes them)",
        path, to_string(signature)));
  for (std::size_t s = 0; s < m; ++s) parts.push_back(part_of(segments[*first + s]));
  return parts;
}

}  // namespace

DatFile data_of_trajectory(const std::string& path, const RunSettings& settings) {
  const TrajectoryRows rows = read_trajectory_rows(path);
  if (static_cast<int>(rows.states.size()) != settings.dimension)
    throw UserError(fmt::format("{}: it has {} states, NDIM is {}", path, rows.states.size(), settings.dimension));
  DatFile data = data_of_parts(parts_of(rows.segments, settings.signature(), path));
  for (const auto& [name, value] : rows.parameters)
    if (const std::optional<int> k = unnamed_parameter(name))
      data.parameters.emplace_back(*k, value);
    else
      data.named_parameters.emplace_back(name, value);
  return data;
}

std::string convert_data(const RunRequest& request, std::ostream& notices) {
  const std::string constants = constants_path(request.constants.value_or(request.name));
  RunSettings settings = read_constants_file(constants);
  apply_overrides(settings, request.overrides);
  settings.start = {};
  const std::string plugin =
      resolve_plugin_of_run(request.problem, request.name, recorded_problem(settings, constants), notices);
  const ProblemLibrary library(plugin, [&settings] { return problem_sizes(settings); });
  resolve_names(settings, library.system());
  check_settings_against(library.system(), settings, {constants, request.overrides});

  RunRequest from_data = request;
  from_data.data = request.data.value_or(request.name);
  from_data.start.reset();
  const SelectedStart selected = select_start(from_data, settings, library.system(), {});
  LabelledSolution solution = labelled_solution(selected.start.orbit, {}, {}, {});
  solution.type = static_cast<int>(PointType::end);
  solution.problem_type = settings.problem_type;
  solution.branch_mode = settings.branch_mode;
  const std::string name = request.output.value_or(request.name);
  replace_solution_file(name, format_solution(solution));
  return output_path('q', name);
}

}  // namespace tchat
