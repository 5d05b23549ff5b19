#include "plot/branch_end.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "base/user_error.hpp"
#include "files/labelled_solution.hpp"
#include "files/run_file_names.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"

namespace tchat {

namespace {

constexpr double digits_of_header = 1e-4;

/// RL0, RL1, A0, A1 of r.NAME; nothing without it.
std::vector<double> recorded_bounds(const std::string& point_path) {
  const std::string path = sibling_path(point_path, 'r');
  std::error_code error;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return {};
  try {
    const RunSettings settings = read_constants_file(path);
    return {settings.parameter_min, settings.parameter_max, settings.measure_min, settings.measure_max};
  } catch (const UserError&) {
    return {};  // the header's digits must do
  }
}

std::vector<double> bounds_of(const BranchFile& file, std::size_t section) {
  std::vector<double> bounds = file.sections[section].bounds;
  const std::vector<double> exact = recorded_bounds(file.path);
  for (std::size_t k = 0; k < std::min(bounds.size(), exact.size()); ++k)
    if (std::abs(bounds[k] - exact[k]) <= digits_of_header * std::abs(exact[k])) bounds[k] = exact[k];
  return bounds;
}

}  // namespace

double part_within_bounds(const BranchFile& file, std::size_t section, std::size_t row) {
  const PointSection& s = file.sections[section];
  const bool is_end = basic_type(s.rows[row].type) == static_cast<int>(PointType::end);
  if (!is_end || row == 0 || s.bounds.empty()) return 1.0;
  const std::vector<double> bounds = bounds_of(file, section);
  double part = 1.0;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, s.columns.size()); ++k) {
    const double before = s.rows[row - 1].values[k], here = s.rows[row].values[k];
    for (const double bound : {bounds[2 * k], bounds[2 * k + 1]})
      if ((before < bound && bound < here) || (before > bound && bound > here))
        part = std::min(part, (bound - before) / (here - before));
  }
  return part;
}

}  // namespace tchat
