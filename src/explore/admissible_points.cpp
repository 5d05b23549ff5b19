#include "explore/admissible_points.hpp"

#include <cstdlib>

#include "files/diagnostics_file.hpp"

namespace tchat {

AdmissiblePoints admissible_points(const std::string& path) {
  AdmissiblePoints result;
  bool some_beyond = false, some_left = false;
  for (const DiagnosticPoint& point : read_diagnostics_file(path)) {
    ++result.points;
    result.inadmissible += point.admissible ? 0 : 1;
    if (std::abs(point.point) > 1) {
      some_beyond = true;
      some_left = some_left || point.admissible;
    }
    if (point.label > 0) result.labels[point.label] = point.admissible;
  }
  result.only_at_start = some_beyond && !some_left;
  return result;
}

}  // namespace tchat
