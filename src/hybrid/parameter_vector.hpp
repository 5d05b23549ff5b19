/// PAR: the problem's parameters and the segment durations in one vector, as users and files number them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "text/number.hpp"

namespace tchat {

/// PAR(1..60) belong to the user; the duration of segment s (s = 1..) is PAR(60 + s).
inline constexpr int first_duration = 61;
/// A ParameterVector has at least this many entries, on which problems rely.
inline constexpr int parameter_length = 512;
/// A larger number is an input error: memory would not suffice.
inline constexpr int max_segments = 100'000;
/// The orbits of a torus may have as many in all, for their returns are coupled densely.
inline constexpr int max_torus_segments = 256;
/// The rotation number of a torus (bvp/torus_system.hpp), for problems with fewer parameters of their own.
inline constexpr int rotation_parameter = 60;
inline constexpr const char* rotation_name = "rho";
/// Values of monitors (bvp/monitor.hpp) stand behind the durations while a run lasts; no file has them as PAR.
constexpr int first_monitor(int segments) { return first_duration + std::max(max_torus_segments, segments); }
inline constexpr int max_monitors = 32;
/// The parameter that unfolds equations (bvp/unfolded_system.hpp) behind these.
constexpr int unfolding_parameter(int segments) { return first_monitor(segments) + max_monitors; }

/// PAR(k) is par(k - 1); unused ones zero. That of an orbit has room for its durations and for monitors, any other one
/// parameter_length entries.
using ParameterVector = Eigen::VectorXd;

/// How many entries the vector of an orbit has.
constexpr int parameter_room(int segments) { return std::max(parameter_length, unfolding_parameter(segments)); }
/// Gives the vector of an orbit as many, new ones zero.
inline void make_room(ParameterVector& par, int segments) {
  const Eigen::Index before = par.size();
  if (before == parameter_room(segments)) return;
  par.conservativeResize(parameter_room(segments));
  if (par.size() > before) par.tail(par.size() - before).setZero();
}

/// True when PAR(k) is a duration of an orbit of `segments` segments.
constexpr bool is_duration(int k, int segments) { return k >= first_duration && k < first_duration + segments; }

/// The segment (0-based) whose duration PAR(k) is.
constexpr int duration_segment(int k) { return k - first_duration; }

/// "T2" of PAR(62): what users read. Files of runs have PAR(62), as TC-HAT's do.
inline std::string duration_name(int k) { return "T" + std::to_string(duration_segment(k) + 1); }

/// 62 of "T2"; nothing for what names no duration.
inline std::optional<int> duration_of_name(std::string_view name) {
  if (name.size() < 2 || name.size() > 7 || name.front() != 'T') return std::nullopt;
  const std::optional<int> segment = parse_integer(name.substr(1));
  if (!segment || *segment < 1 || *segment > max_segments) return std::nullopt;
  return first_duration + *segment - 1;
}

}  // namespace tchat
