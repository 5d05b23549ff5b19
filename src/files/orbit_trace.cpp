#include "files/orbit_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <limits>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/point_file_reader.hpp"
#include "files/solution_file_reader.hpp"
#include "model/parameter_vector.hpp"
#include "orbit/torus_system.hpp"
#include "settings/constants_file.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

constexpr double jump_tolerance = level::located;

int segments_of(const LabelledSolution& solution, int dimension, const std::string& path) {
  const auto rows = static_cast<int>(solution.states.rows());
  const int segments = dimension > 0 ? (rows % dimension == 0 ? rows / dimension : 0) : segment_count(solution);
  if (segments == 0)
    throw UserError(
        fmt::format("{}: label {} has {} states, and how many of them belong to one segment is not in the "
                    "file; give the dimension of the problem, as in --dimension 4",
                    path, solution.label, rows));
  return segments;
}

}  // namespace

bool OrbitTrace::jumps_after(std::size_t s) const {
  for (Eigen::Index i = 0; i < dimension(); ++i)
    if (jumps_after(s, i)) return true;
  return false;
}

bool OrbitTrace::jumps_after(std::size_t s, Eigen::Index i) const {
  if ((!is_closed && s + 1 == segments.size()) || ends_return(s) || is_section) return false;
  double size = 0.0;
  for (const TraceSegment& segment : segments) size = std::max(size, segment.states.row(i).cwiseAbs().maxCoeff());
  return std::abs(start_after(s)(i) - end_of(s)(i)) >
         jump_tolerance * std::max(size, std::numeric_limits<double>::min());
}

OrbitTrace orbit_trace(const LabelledSolution& solution, const std::string& name, int dimension,
                       const std::string& path) {
  if (solution.tau.size() < 2)
    throw UserError(fmt::format("{}: label {} is an equilibrium, not an orbit", path, solution.label));
  OrbitTrace trace;
  trace.name = name;
  trace.parameters = solution.parameters;
  trace.rotation_parameter = solution.layout.rotation();
  const int segments = segments_of(solution, dimension, path);
  const Eigen::Index n = solution.states.rows() / segments;
  for (const int k : solution.free_parameters)
    if (!solution.layout.is_duration(k, segments)) trace.free_parameters.emplace_back(k, stored_parameter(solution, k));
  double start = 0.0;
  for (int s = 0; s < segments; ++s) {
    TraceSegment segment;
    const double length = duration(solution, s);
    for (const double tau : solution.tau) segment.times.push_back(start + tau * length);
    segment.states = solution.states.middleRows(s * n, n);
    trace.segments.push_back(std::move(segment));
    start += length;
  }
  return trace;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int fewest_returns = 61;  // of a bundle
constexpr int points_on_curve = 500;

std::string constants_beside(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::string used = sibling_path(path, 'r');
  if (!used.empty() && fs::is_regular_file(used, error)) return used;
  const std::string made = constants_file_of(run_path(path));
  if (fs::is_regular_file(made, error)) return made;
  throw UserError(
      fmt::format("{}: it holds tori, and how many segments one return has stands in {} or {}, which are not there",
                  path, used.empty() ? "the r-file" : used, made));
}

/// The same curve at `count` phases, w being taken out of each row and put back.
MatrixXd finer(const MatrixXd& values, int count) {
  MatrixXd periodic = values;
  const auto old_count = static_cast<double>(values.cols());
  VectorXd w(values.rows());
  for (Index row = 0; row < values.rows(); ++row) {
    w(row) = likely_winding(values.row(row));
    for (Index l = 0; l < values.cols(); ++l) periodic(row, l) -= w(row) * static_cast<double>(l) / old_count;
  }
  MatrixXd result(values.rows(), count);
  for (int k = 0; k < count; ++k) {
    const double phi = static_cast<double>(k) / count;
    result.col(k) = periodic * interpolation_weights(static_cast<int>(values.cols()), phi).transpose() + phi * w;
  }
  return result;
}

/// Row r of a segment of each return, at the phases.
MatrixXd rows_of(const OrbitTrace& trace, int s, int m, Index node) {
  const auto returns = static_cast<Index>(trace.segments.size()) / m;
  MatrixXd values(trace.dimension(), returns);
  for (Index i = 0; i < returns; ++i)
    values.col(i) = trace.segments[static_cast<std::size_t>(i * m + s)].states.col(node);
  return values;
}

}  // namespace

int segments_of_return(const LabelledSolution& solution, const std::string& solution_path) {
  const std::string constants = constants_beside(solution_path);
  const RunSettings settings = read_constants_file(constants);
  const Index states = static_cast<Index>(segment_count(settings)) * settings.dimension;
  if (states > 0 && solution.states.rows() % states == 0 && solution.states.rows() / states >= 3)
    return segment_count(settings);
  throw UserError(fmt::format("{}: label {} has {} states, no returns of {} segments of {} states as {} has them",
                              solution_path, solution.label, solution.states.rows(), segment_count(settings),
                              settings.dimension, constants));
}

OrbitTrace torus_bundle(const LabelledSolution& solution, const std::string& name, int dimension,
                        const std::string& path) {
  const int m = segments_of_return(solution, path);
  OrbitTrace trace = orbit_trace(solution, name, dimension, path);
  trace.segments_per_return = m;
  trace.section_points = rows_of(trace, 0, m, 0);
  const auto stored = static_cast<int>(trace.segments.size()) / m;
  const int more = static_cast<int>(std::ceil(static_cast<double>(fewest_returns) / stored));
  if (more <= 1) return trace;
  std::vector<TraceSegment> segments(static_cast<std::size_t>(stored * more * m));
  for (int s = 0; s < m; ++s) {
    const Index nodes = trace.segments[static_cast<std::size_t>(s)].states.cols();
    for (int i = 0; i < stored * more; ++i) {
      TraceSegment& segment = segments[static_cast<std::size_t>(i * m + s)];
      segment.times = trace.segments[static_cast<std::size_t>(i / more * m + s)].times;
      segment.states.resize(trace.dimension(), nodes);
    }
    for (Index node = 0; node < nodes; ++node) {
      const MatrixXd values = finer(rows_of(trace, s, m, node), stored * more);
      for (int i = 0; i < stored * more; ++i)
        segments[static_cast<std::size_t>(i * m + s)].states.col(node) = values.col(i);
    }
  }
  trace.segments = std::move(segments);
  return trace;
}

OrbitTrace section_trace(const LabelledSolution& solution, const std::string& name, int dimension,
                         const std::string& path) {
  const int m = segments_of_return(solution, path);
  OrbitTrace trace = orbit_trace(solution, name, dimension, path);
  trace.section_points = rows_of(trace, 0, m, 0);
  trace.is_section = true;
  TraceSegment curve;
  const MatrixXd values = finer(trace.section_points, points_on_curve);
  curve.states.resize(values.rows(), points_on_curve + 1);
  curve.states.leftCols(points_on_curve) = values;
  curve.states.col(points_on_curve) = values.col(0);
  for (Index row = 0; row < values.rows(); ++row)
    curve.states(row, points_on_curve) += likely_winding(trace.section_points.row(row));
  for (int k = 0; k <= points_on_curve; ++k) curve.times.push_back(static_cast<double>(k) / points_on_curve);
  trace.segments = {std::move(curve)};
  return trace;
}

namespace {

constexpr double critical_width_of_orbits = level::visible;

std::map<int, LineKind> kinds_in_diagnostics(const std::string& path) {
  std::map<int, LineKind> kinds;
  for (const DiagnosticPoint& point : read_diagnostics_file(path))
    if (point.label > 0 && line_kind(point) != LineKind::stable) kinds[point.label] = line_kind(point);
  return kinds;
}

std::map<int, LineKind> kinds_in_points(const std::string& path) {
  std::map<int, LineKind> kinds;
  for (const PointSection& section : read_point_file(path).sections)
    for (const PointRow& row : section.rows)
      if (row.label > 0 && row.point > 0 && section.has_stability() && !section.is_two_parameter_curve())
        kinds[row.label] = LineKind::unstable;
  return kinds;
}

}  // namespace

bool has_multiplier_outside(const DiagnosticPoint& point) {
  return std::any_of(point.multipliers.begin(), point.multipliers.end(),
                     [](const auto& mu) { return std::abs(mu) > 1.0 + critical_width_of_orbits; });
}

LineKind line_kind(const DiagnosticPoint& point) {
  if (!point.admissible) return LineKind::inadmissible;
  return has_multiplier_outside(point) ? LineKind::unstable : LineKind::stable;
}

std::map<int, LineKind> label_kinds(const std::string& solution_path) {
  std::error_code error;
  for (const char letter : {'d', 'p'}) {
    const std::string path = sibling_path(solution_path, letter);
    if (path.empty() || !std::filesystem::is_regular_file(path, error)) continue;
    try {
      return letter == 'd' ? kinds_in_diagnostics(path) : kinds_in_points(path);
    } catch (const UserError&) {
      continue;  // the other file may tell
    }
  }
  return {};
}

std::map<int, LineKind> torus_label_kinds(const std::string& solution_path) {
  std::map<int, LineKind> kinds;
  std::error_code error;
  for (const char letter : {'p', 'd'}) {
    const std::string path = sibling_path(solution_path, letter);
    if (path.empty() || !std::filesystem::is_regular_file(path, error)) continue;
    try {
      if (letter == 'p') kinds = kinds_in_points(path);
      if (letter == 'd')
        for (const auto& [label, kind] : kinds_in_diagnostics(path))
          if (kind == LineKind::inadmissible) kinds[label] = kind;
    } catch (const UserError&) {
      continue;
    }
  }
  return kinds;
}

}  // namespace tchat
