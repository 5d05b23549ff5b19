#include "explore/diagram_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "base/levels.hpp"
#include "base/words.hpp"
#include "files/point_file_reader.hpp"

namespace tchat {

namespace {

using Points = std::vector<std::pair<double, double>>;

constexpr std::size_t most_colours = 8;            // that distinguish branches in a key
constexpr double cells = 48.0;                     // of the grid along each axis
constexpr double same_label = level::five_digits;  // as a share of the range of the parameter

/// Adds the points of a branch. False if one of its sections does not have the column.
bool add_points(const PointFile& file, const std::string& column, Points& points) {
  for (const PointSection& section : file.sections) {
    const auto place = section.column(section.at_rest(column));
    if (!place) return false;
    for (const PointRow& row : section.rows) points.emplace_back(row.values.front(), row.values[*place]);
  }
  return true;
}

/// Adds the attractors of a sweep.
bool add_points(const SweepTable& sweep, const std::string& column, Points& points) {
  const std::vector<double>* const y = sweep.column(column);
  if (y == nullptr) return false;
  const std::vector<double>& x = *sweep.column(sweep.over.front().column());
  bool has_some = false;
  for (std::size_t row = 0; row < sweep.rows(); ++row) {
    if (!std::isfinite((*y)[row])) continue;
    points.emplace_back(x[row], (*y)[row]);
    has_some = true;
  }
  return has_some;
}

/// How many cells of a grid over the points' own range have one; constants have one row of cells.
std::size_t cells_with_points(const Points& points) {
  if (points.empty()) return 0;
  const auto [left, right] = std::minmax_element(points.begin(), points.end());
  const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                               [](const auto& a, const auto& b) { return a.second < b.second; });
  constexpr double rounding = level::located;
  const double width = right->first - left->first, height = high->second - low->second;
  const double size = std::max(std::abs(low->second), std::abs(high->second));
  std::set<std::pair<int, int>> found;
  for (const auto& [x, y] : points)
    found.emplace(width > 0.0 ? static_cast<int>(cells * (x - left->first) / width) : 0,
                  height > rounding * size ? static_cast<int>(cells * (y - low->second) / height) : 0);
  return found.size();
}

bool has_label(const ExploredDiagram& diagram, const std::string& type, double parameter, double slack) {
  for (const ExploredBranch& branch : diagram.branches)
    for (const ExploredLabel& label : branch.labels)
      if (label.type == type && std::abs(label.parameter - parameter) <= slack) return true;
  return false;
}

/// The types of labels to draw. A branch point where a doubled branch is born is the period doubling once more.
std::string drawn_types(const ExploredDiagram& diagram, const SweptQuantity& over) {
  const double slack = same_label * std::abs(over.to - over.from);
  std::set<std::string> types;
  for (const ExploredBranch& branch : diagram.branches)
    for (const ExploredLabel& label : branch.labels)
      if (label.type != "BP" || !has_label(diagram, "PD", label.parameter, slack)) types.insert(label.type);
  std::string list;
  for (const std::string& type : types) list += (list.empty() ? "" : ",") + type;
  return list.empty() ? "none" : list;
}

}  // namespace

std::string chosen_quantity(const ExploredDiagram& diagram, const DiagramFiles& files, const SweepTable& sweep) {
  std::string best;
  std::size_t most = 0;
  for (const std::string& name : files.monitors) {
    Points points;
    if (!is_largest_value_column(name) || !add_points(sweep, name, points)) continue;
    const bool is_known = std::all_of(diagram.branches.begin(), diagram.branches.end(), [&](const auto& branch) {
      return add_points(read_point_file(branch.job.outputs.front()), name, points);
    });
    const std::size_t count = cells_with_points(points);
    if (is_known && count > most) best = name, most = count;
  }
  return best;
}

void add_pictures(const DiagramFiles& files, const SweepTable& sweep, ExploredDiagram& diagram) {
  if (diagram.branches.empty()) return;
  diagram.quantity = files.quantity.empty() ? chosen_quantity(diagram, files, sweep) : files.quantity;
  std::vector<std::string> inputs;
  for (const ExploredBranch& branch : diagram.branches) inputs.push_back(branch.job.outputs.front());
  inputs.insert(inputs.end(), files.sweeps.begin(), files.sweeps.end());
  Command words = words_of({{"plot"}, inputs});
  if (!diagram.quantity.empty()) words.insert(words.end(), {"-y", diagram.quantity});
  words.insert(words.end(), {"--grey", "--labels", drawn_types(diagram, sweep.over.front())});
  if (diagram.branches.size() > most_colours) words.emplace_back("--black");
  const auto add = [&](const char* name, const std::vector<std::string>& outputs) {
    CommandJob job{name, {}, inputs, outputs};
    for (const std::string& file : outputs) job.commands.push_back(words_of({words, {"-o", file}}));
    diagram.last_jobs.push_back(std::move(job));
  };
  add("picture", {files.folder + ".png", files.folder + ".svg"});
  add("page", {files.folder + ".html"});
}

void add_curve_picture(const std::string& folder, const std::vector<std::string>& files, const std::string& second,
                       ExploredDiagram& diagram) {
  if (files.empty()) return;
  const std::string picture = folder + "_curves.png";
  diagram.last_jobs.push_back(
      {"curves", {words_of({{"plot"}, files, {"-y", second, "--black", "-o", picture}})}, files, {picture}});
}

namespace {

/// Removes pictures of an earlier call; a file that is not one of these is the user's, and kept as FILE~.
void clear_outputs(const CommandJob& job, bool are_own) {
  std::error_code failed;  // then it is written over, or the command says why not
  for (const std::string& file : job.outputs)
    if (are_own)
      std::filesystem::remove(file, failed);
    else
      std::filesystem::rename(file, file + "~", failed);
}

}  // namespace

std::vector<std::string> draw_pictures(const std::vector<CommandJob>& jobs, const std::string& folder,
                                       const std::function<bool()>& interrupted) {
  JobRunner runner(folder, 1, interrupted);
  for (const CommandJob& job : jobs)
    if (!runner.is_done(job)) clear_outputs(job, runner.has_made(job));
  std::vector<std::string> warnings;
  const std::vector<JobResult> results = runner.run(jobs);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (results[i].was_run && !results[i].succeeded())
      warnings.push_back(fmt::format("the {} is not drawn: {}", jobs[i].name, results[i].failure));
  return warnings;
}

}  // namespace tchat
