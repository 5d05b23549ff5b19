#include "plot/trajectory_file.hpp"

#include <filesystem>

#include "files/trajectory_rows.hpp"

namespace tchat {

TrajectoryFile read_trajectory_file(const std::string& path) {
  const TrajectoryRows rows = read_trajectory_rows(path);
  TrajectoryFile file;
  file.trace.name = std::filesystem::path(path).stem().string();
  file.trace.is_closed = false;
  for (const auto& [name, value] : rows.parameters) {
    const std::optional<int> k = unnamed_parameter(name);
    if (k && *k > static_cast<int>(file.trace.parameters.size())) file.trace.parameters.resize(*k - 1, 0.0);
    file.trace.parameters.push_back(value);
  }
  file.states = rows.states;
  for (const RecordedRows& recorded : rows.segments) {
    TraceSegment segment;
    segment.times = recorded.times;
    segment.states = recorded.states;
    file.trace.segments.push_back(std::move(segment));
  }
  return file;
}

}  // namespace tchat
