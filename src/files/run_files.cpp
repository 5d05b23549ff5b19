#include "files/run_files.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/diagnostics_file.hpp"
#include "files/disk_sync.hpp"
#include "files/output_lock.hpp"
#include "files/solution_file_reader.hpp"
#include "files/temporary_file.hpp"
#include "files/writable_file.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

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

}  // namespace tchat
