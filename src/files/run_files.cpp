#include "files/run_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/solution_file.hpp"
#include "files/solution_file_reader.hpp"
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

namespace {

constexpr std::array<char, 4> letters{'p', 'q', 'd', 'r'};

/// So much of points and diagnostics is not kept in memory any longer, in bytes.
constexpr std::size_t much = 1 << 17;

std::string read_to_append(const std::string& path) {
  return read_text_file(path, "an output to add to", "run without --append");
}

/// Cuts a file to its first `size` bytes.
void cut(const std::string& path, std::size_t size) {
  std::error_code error;
  fs::resize_file(path, size, error);
  if (error) throw ComputationError(fmt::format("{}: cannot be mended ({})", path, error.message()));
}

/// Where the last whole line ends.
std::size_t end_of_lines(std::string_view text) {
  const auto end = text.rfind('\n');
  return end == std::string_view::npos ? 0 : end + 1;
}

std::string_view last_line(std::string_view lines) {
  if (lines.empty()) return lines;
  const auto before = lines.rfind('\n', lines.size() - 2);
  return lines.size() < 2 || before == std::string_view::npos ? lines : lines.substr(before + 1);
}

/// Cuts off an incomplete last line and a header without points, which AUTO's reader refuses.
void mend_points(const std::string& path) {
  const std::string text = read_to_append(path);
  std::string_view lines(text.data(), end_of_lines(text));
  while (!lines.empty()) {
    const auto words = split_words(without_carriage_return(last_line(lines).substr(0, last_line(lines).size() - 1)));
    if (!words.empty() && words[0] != "0") break;
    lines.remove_suffix(last_line(lines).size());
  }
  if (lines.size() < text.size()) cut(path, lines.size());
}

/// Cuts off an incomplete last line, and ends the last block.
void mend_diagnostics(const std::string& path) {
  const std::string text = read_to_append(path);
  const std::string_view lines(text.data(), end_of_lines(text));
  if (lines.size() < text.size()) cut(path, lines.size());
  if (!lines.empty() && last_line(lines) != format_bar() && !ends_complete_run(last_line(lines)))
    BlockFile(path).write(format_bar());
}

void mend_solutions(const std::string& path) {
  const std::string text = read_to_append(path);
  const std::size_t complete = parse_solution_file(text, path).complete_bytes;
  if (complete < text.size()) cut(path, complete);
  if (complete > 0 && text[complete - 1] != '\n') BlockFile(path).write("\n");
}

}  // namespace

RunFiles::RunFiles(std::string name, Mode mode) : name_(std::move(name)), mode_(mode) {}

RunFiles::~RunFiles() {
  try {
    write_gathered();
  } catch (const std::exception&) {  // another failure is on its way already
  }
}

void RunFiles::check_writable() {
  if (fs::path(name_).filename().empty())
    throw UserError(fmt::format("'{}' is no name for output files; an example is -o mems", name_));
  for (const char letter : letters) require_writable(path(letter));
  lock_ = lock_output(name_);
  if (mode_ == Mode::append && exists(path('q'))) {
    const SolutionFile existing = read_solution_file(path('q'));
    last_label_ = existing.last_label;
    last_branch_ = existing.last_branch;
  }
}

void RunFiles::open(std::string_view constants) {
  if (!lock_) check_writable();
  std::vector<std::string> names;
  for (const char letter : letters)
    for (const char* suffix : {"", "~", "~~"}) names.push_back(path(letter) + suffix);
  remove_abandoned(names);
  // A disk without room for it is noticed before anything is touched.
  TemporaryFile used_constants(path('r'));
  used_constants.write(constants);
  used_constants.close();
  if (mode_ == Mode::replace)
    begin_new_set();
  else
    go_on_with_set();
  used_constants.put_in_place();
  // Room for all that is gathered between two writes, so that no point of a long branch allocates.
  for (Growing* growing : {&points_, &diagnostics_})
    for (std::string* text : {&growing->gathered, &growing->being_written}) text->reserve(much + much / 4);
}

void RunFiles::begin_new_set() {
  TemporaryFile diagnostics(path('d')), points(path('p')), solutions(path('q'));
  keep_run_set(name_);
  diagnostics_.file = diagnostics.put_in_place();
  points_.file = points.put_in_place();
  solutions_.file = solutions.put_in_place();
}

/// Files that are still those of the kept set too, because a run was killed at its very beginning, are separated.
void RunFiles::go_on_with_set() {
  for (const char letter : letters) separate(path(letter), path(letter) + "~");
  mend_existing();
  diagnostics_.file = BlockFile(path('d'));
  points_.file = BlockFile(path('p'));
  solutions_.file = BlockFile(path('q'));
}

void RunFiles::mend_existing() const {
  if (exists(path('p'))) mend_points(path('p'));
  if (exists(path('d'))) mend_diagnostics(path('d'));
  if (exists(path('q'))) mend_solutions(path('q'));
}

void RunFiles::add(Growing& growing, std::string_view block) {
  changing_ = 1;
  growing.gathered += block;
  changing_ = 0;
}

void RunFiles::write_if_due() {
  constexpr auto longest_wait = std::chrono::milliseconds(250);
  const std::size_t gathered = points_.gathered.size() + diagnostics_.gathered.size();
  const bool is_late = std::chrono::steady_clock::now() - last_written_ >= longest_wait;
  if (is_late || gathered > much || !solutions_.gathered.empty()) write_gathered();
}

void RunFiles::write_gathered() {
  // After a failure nothing is tried again: the other files would name points of which that file has nothing.
  changing_ = 1;
  for (Growing* growing : {&solutions_, &points_, &diagnostics_}) {
    growing->being_written.swap(growing->gathered);
    growing->gathered.clear();
  }
  changing_ = 0;
  for (Growing* growing : {&solutions_, &points_, &diagnostics_}) growing->file.write(growing->being_written);
  last_written_ = std::chrono::steady_clock::now();
}

void RunFiles::act() noexcept {
  if (changing_ != 0) return;
  for (Growing* growing : {&solutions_, &points_, &diagnostics_}) growing->file.write_before_the_end(growing->gathered);
}

void RunFiles::finish() {
  if (!is_open()) return;
  write_gathered();
  // The closing line says that all is there: on the disk it is the last one to come.
  for (Growing* growing : {&solutions_, &points_, &diagnostics_}) growing->file.begin_sync();
  points_.file.sync();
  solutions_.file.sync();
  sync_folder_of(name_);
  diagnostics_.file.write(format_end_of_run());
  diagnostics_.file.sync();
  for (Growing* growing : {&points_, &solutions_, &diagnostics_}) growing->file.close();
  lock_.reset();
}

namespace {

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

/// What -c could have meant: the constants that a run of this name has left, or constants files of like names.
std::string constants_meant(const fs::path& path) {
  if (const std::string used = output_path('r', path.string()); is_file(used))
    return fmt::format("the constants of the run {} are in {}: -c {}", path.string(), used, used);
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (const std::string name = at->path().filename().string(); name.starts_with(constants_prefix))
      names.push_back(name.substr(constants_prefix.size()));
  const std::vector<std::string> near = near_words(path.filename().string(), names);
  if (!near.empty()) return fmt::format("did you mean {}?", fmt::join(near, ", "));
  return fmt::format(
      "give its name with -c, let `tchat simulate {} --dat {}` write it with starting data, or write one "
      "(`tchat constants` explains what is in it)",
      path.filename().string(), path.filename().string());
}

/// NAME/NAME where NAME is a folder, as `tchat new NAME` makes it; else NAME.
fs::path in_own_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) ? path / path.filename() : path;
}

/// Removes a leading gc. from the name of the file.
fs::path without_prefix(const fs::path& path) {
  const std::string file = path.filename().string();
  return file.starts_with(constants_prefix) ? path.parent_path() / file.substr(constants_prefix.size()) : path;
}

}  // namespace

std::string own_constants_path(const std::string& name) {
  for (const std::string& path : {constants_file_of(name), constants_file_of(in_own_folder(name).string())})
    if (is_file(path)) return path;
  return "";
}

std::string constants_path(const std::string& c) {
  const fs::path path(c);
  if (const std::string own = own_constants_path(c); !own.empty()) return own;
  if (is_file(path)) return path.string();
  const fs::path name = without_prefix(path);
  const std::string file = constants_file_of(name.string());
  throw UserError(fmt::format("there is no constants file {}{}; {}", file, path == file ? "" : " or " + path.string(),
                              constants_meant(name)));
}

std::string constants_of_run(const std::optional<std::string>& given, const std::string& solutions) {
  if (given) return constants_path(*given);
  const std::string used = sibling_path(solutions, 'r');
  if (!used.empty() && is_file(used)) return used;
  if (const std::string made = constants_file_of(run_path(solutions)); is_file(made)) return made;
  throw UserError(fmt::format("there is no {} with the constants of the run that wrote {}; give them with -c C",
                              used.empty() ? "r-file" : used, solutions));
}

std::string data_path(const std::string& d) {
  const fs::path path(d);
  const fs::path with_suffix = d + ".dat";
  if (is_file(with_suffix)) return with_suffix.string();
  if (const std::string own = in_own_folder(path).string() + ".dat"; is_file(own)) return own;
  if (is_file(path)) return path.string();
  throw UserError(
      fmt::format("there is no starting data {} or {}; give its name with -d, or a q-file with -s and a "
                  "label with IRS=",
                  with_suffix.string(), path.string()));
}

std::string solution_path(const std::string& s) {
  const std::string prefixed = output_path('q', s);
  if (is_file(prefixed)) return prefixed;
  if (is_file(s)) return s;
  const bool is_prefixed = fs::path(s).filename().string().starts_with("q.");
  throw UserError(fmt::format("there is no q-file {} to restart from; give the name of an earlier run's output with -s",
                              is_prefixed ? s : prefixed));
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

}  // namespace tchat
