#include "files/torus_trace.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/user_error.hpp"
#include "files/run_file_names.hpp"
#include "orbit/torus_system.hpp"
#include "settings/constants_file.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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

}  // namespace tchat
