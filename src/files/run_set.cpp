#include "files/run_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/diagnostics_file.hpp"
#include "files/diagnostics_file_reader.hpp"
#include "files/disk_sync.hpp"
#include "files/output_lock.hpp"
#include "files/solution_labels.hpp"
#include "files/temporary_file.hpp"
#include "files/writable_file.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

struct PointKey {
  int branch = 0;
  int point = 0;  ///< with its sign
  int label = 0;
  bool operator==(const PointKey&) const = default;
};

/// BR, PT, LAB of the points of a p-file, a cut last line left out; nothing when it is no p-file.
std::optional<std::vector<PointKey>> points_of(const std::string& path) {
  std::vector<PointKey> points;
  TextLines in(path, "points of branches");
  for (std::string line; in.next(line) && !in.ended_within_line();) {
    const auto words = split_words(line);
    if (words.empty() || words[0] == "0") continue;
    if (words.size() < 5) return std::nullopt;
    const auto branch = parse_integer(words[0]), point = parse_integer(words[1]), label = parse_integer(words[3]);
    if (!branch || !point || !label) return std::nullopt;
    points.push_back({*branch, *point, *label});
  }
  return points;
}

/// A d-file up to its last closing line, that line included; nothing when it closes no run.
std::optional<std::string> closed_part(const std::string& path) {
  const std::string text = read_text_if_there(path, "diagnostics of a run").value_or("");
  for (std::size_t end = text.size(); end > 0;) {
    const std::size_t newline = text.rfind('\n', end - 1);
    if (newline == std::string::npos) return std::nullopt;
    const std::size_t before = newline == 0 ? std::string::npos : text.rfind('\n', newline - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    if (ends_complete_run(std::string_view(text).substr(begin, newline + 1 - begin)))
      return text.substr(0, newline + 1);
    end = newline;
  }
  return std::nullopt;
}

}  // namespace

std::string output_path(char letter, const std::string& name) {
  const fs::path path(name);
  return (path.parent_path() / fmt::format("{}.{}", letter, path.filename().string())).string();
}

RunSetState run_set_state(const std::string& name, const std::string& suffix) {
  const auto path = [&](char letter) { return output_path(letter, name) + suffix; };
  const bool points_there = exists(path('p')), solutions_there = exists(path('q')), diagnostics = exists(path('d'));
  if (!points_there && !solutions_there && !diagnostics) return RunSetState::absent;
  if (!diagnostics) return RunSetState::foreign;
  const auto points = points_of(path('p'));
  auto labels = whole_solution_labels(path('q'));
  if (!points || !labels) return RunSetState::foreign;
  // A solution is written before its point, so that every label of a p-file is in its q-file.
  std::sort(labels->begin(), labels->end());
  for (const PointKey& point : *points)
    if (point.label > 0 && !std::binary_search(labels->begin(), labels->end(), point.label))
      return RunSetState::foreign;
  const auto closed = closed_part(path('d'));
  if (!closed) return RunSetState::interrupted;
  const std::vector<DiagnosticPoint> noted = parse_diagnostics(*closed);
  if (noted.empty() || !points_there || !solutions_there) return RunSetState::foreign;
  const PointKey last{noted.back().branch, noted.back().point, noted.back().label};
  const bool there = std::find(points->begin(), points->end(), last) != points->end();
  return there ? RunSetState::complete : RunSetState::foreign;
}

void keep_run_set(const std::string& name) {
  const RunSetState state = run_set_state(name);
  std::string suffix = "~";
  if (state != RunSetState::complete && run_set_state(name, "~") == RunSetState::complete) {
    if (state == RunSetState::interrupted) return;
    suffix = "~~";
  }
  std::error_code error;
  // A set that comes from elsewhere need not be on the disk yet; the one whose place it takes is.
  for (const char letter : {'p', 'q', 'r', 'd'}) sync_file(output_path(letter, name));
  if (exists(output_path('d', name))) fs::remove(output_path('d', name) + suffix, error);
  for (const char letter : {'p', 'q', 'r', 'd'}) {
    const std::string path = output_path(letter, name);
    if (exists(path))
      keep_as(path, path + suffix);
    else if (state == RunSetState::complete)
      fs::remove(path + suffix, error);
    if (error) throw ComputationError(fmt::format("{}{}: cannot be replaced ({})", path, suffix, error.message()));
  }
  sync_folder_of(name);  // before anything takes the first names
}

void replace_solution_file(const std::string& name, std::string_view solutions) {
  const std::string path = output_path('q', name);
  require_writable(path);
  const auto lock = lock_output(name);
  TemporaryFile file(path);
  file.write(solutions);
  file.close();
  keep_run_set(name);
  file.put_in_place();
  sync_folder_of(name);
}

}  // namespace tchat
