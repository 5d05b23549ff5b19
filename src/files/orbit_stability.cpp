#include "files/orbit_stability.hpp"

#include <algorithm>
#include <complex>
#include <filesystem>

#include "base/user_error.hpp"
#include "files/point_file_reader.hpp"
#include "files/run_file_names.hpp"

namespace tchat {

namespace {

constexpr double critical_width_of_orbits = 1e-4;

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
