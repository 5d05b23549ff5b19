/// PAR: the problem's parameters and the segment durations in one vector, as users and files number them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "text/number.hpp"

namespace tchat {

/// PAR(1..60) belong to the user; the duration of segment s (s = 1..) is PAR(60 + s).
inline constexpr int first_duration = 61;
inline constexpr int parameter_length = 512;
inline constexpr int max_segments = 64;
/// The orbits of a torus may have as many in all; other orbits have twice max_segments at most, after a period
/// doubling.
inline constexpr int max_orbit_segments = 4 * max_segments;
/// The rotation number of a torus (bvp/torus_system.hpp), for problems with fewer parameters of their own.
inline constexpr int rotation_parameter = 60;
inline constexpr const char* rotation_name = "rho";
/// Values of monitors (bvp/monitor.hpp) stand behind the durations while a run lasts; no file has them as PAR.
inline constexpr int first_monitor = first_duration + max_orbit_segments;
inline constexpr int max_monitors = 32;

/// PAR(k) is par(k - 1); always parameter_length entries, unused ones zero.
using ParameterVector = Eigen::VectorXd;

/// True when PAR(k) is a duration of an orbit of `segments` segments.
constexpr bool is_duration(int k, int segments) { return k >= first_duration && k < first_duration + segments; }

/// The segment (0-based) whose duration PAR(k) is.
constexpr int duration_segment(int k) { return k - first_duration; }

/// "T2" of PAR(62): what users read. Files of runs have PAR(62), as TC-HAT's do.
inline std::string duration_name(int k) { return "T" + std::to_string(duration_segment(k) + 1); }

/// 62 of "T2"; nothing for what names no duration.
inline std::optional<int> duration_of_name(std::string_view name) {
  if (name.size() < 2 || name.size() > 4 || name.front() != 'T') return std::nullopt;
  const std::optional<int> segment = parse_integer(name.substr(1));
  if (!segment || *segment < 1 || *segment > max_orbit_segments) return std::nullopt;
  return first_duration + *segment - 1;
}

}  // namespace tchat
