#include "files/orbit_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "files/solution_file_reader.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

namespace {

constexpr double jump_tolerance = 1e-6;

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
  return std::abs(start_after(s)(i) - end_of(s)(i)) > jump_tolerance * std::max(size, 1e-300);
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

}  // namespace tchat
