#include "start/branch_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "constants/user_error.hpp"
#include "start/diagnostics_file_reader.hpp"
#include "start/point_type.hpp"
#include "start/run_file_names.hpp"
#include "start/solution_file_reader.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return !path.empty() && fs::is_regular_file(path, error);
}

/// A new branch begins where the points are counted from 1 again; after 9999 that is only the count's end.
std::vector<BranchPiece> split_into_pieces(const std::vector<PointSection>& sections) {
  std::vector<BranchPiece> pieces;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const auto& rows = sections[s].rows;
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= rows.size(); ++k) {
      const bool ends = k == rows.size() || std::abs(rows[k].branch) != std::abs(rows[k - 1].branch) ||
                        (std::abs(rows[k].point) == 1 && std::abs(rows[k - 1].point) < 9990);
      if (!ends) continue;
      pieces.push_back({s, begin, k});
      begin = k;
    }
  }
  return pieces;
}

void take_from_solutions(BranchFile& file) {
  const std::string path = sibling_path(file.path, 'q');
  if (!is_file(path)) return;
  SolutionFile solutions;
  try {
    solutions = read_solution_file(path);
  } catch (const UserError& error) {
    file.warnings.push_back(fmt::format("{}\n  (names of UZ points and fixed parameters are left out)", error.what()));
    return;
  }
  std::map<int, const LabelledSolution*> by_label;
  for (const LabelledSolution& solution : solutions.solutions) by_label[solution.label] = &solution;
  for (std::size_t s = 0; s < file.sections.size(); ++s) {
    for (std::size_t k = 0; k < file.sections[s].rows.size(); ++k) {
      const PointRow& row = file.sections[s].rows[k];
      const auto found = row.label > 0 ? by_label.find(row.label) : by_label.end();
      if (found == by_label.end() || found->second->point != std::abs(row.point)) continue;
      const LabelledSolution& solution = *found->second;
      file.types[s][k] = type_name(solution);
      for (const UserPointKind& kind : all_kinds(solution))
        if (kind.kind == UserPointKind::xi) file.xi_zeros[row.label].push_back(kind.index);
      if (file.parameters[s].empty())
        for (std::size_t p = 0; p < solution.parameters.size(); ++p)
          file.parameters[s][static_cast<int>(p) + 1] = solution.parameters[p];
    }
  }
}

/// Both files list the points in the order of their computation; the d-file may lack some (IID = 0) at its end.
void take_from_diagnostics(BranchFile& file) {
  const std::string path = sibling_path(file.path, 'd');
  if (!is_file(path)) return;
  std::vector<DiagnosticPoint> points;
  try {
    points = read_diagnostics_file(path);
  } catch (const UserError& error) {
    file.warnings.push_back(error.what());
    return;
  }
  std::size_t next = 0;
  for (std::size_t s = 0; s < file.sections.size(); ++s) {
    for (std::size_t k = 0; k < file.sections[s].rows.size(); ++k) {
      const PointRow& row = file.sections[s].rows[k];
      const auto same = [&row](const DiagnosticPoint& p) {
        return p.branch == row.branch && p.point == row.point && p.label == row.label;
      };
      const auto found = std::find_if(points.begin() + static_cast<std::ptrdiff_t>(next), points.end(), same);
      if (found == points.end()) continue;
      next = static_cast<std::size_t>(found - points.begin()) + 1;
      file.admissible[s][k] = found->admissible;
      if (row.label > 0 && !found->xi_zeros.empty())
        file.xi_zeros[row.label] = found->xi_zeros;  // older q-files have one n
      if (file.types[s][k] == "UZ" && !found->type.empty()) file.types[s][k] = found->type;
    }
  }
}

}  // namespace

BranchFile read_branch_file(const std::string& path) {
  PointFile points = read_point_file(path);
  BranchFile file;
  file.path = path;
  file.name = run_name(path);
  file.sections = std::move(points.sections);
  file.warnings = std::move(points.warnings);
  file.pieces = split_into_pieces(file.sections);
  file.parameters.resize(file.sections.size());
  for (const PointSection& section : file.sections) {
    file.admissible.emplace_back(section.rows.size(), true);
    file.types.emplace_back();
    for (const PointRow& row : section.rows) file.types.back().push_back(type_name(row.type));
  }
  take_from_solutions(file);
  take_from_diagnostics(file);
  return file;
}

}  // namespace tchat
