#include "output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <utility>

#include "constants/user_error.hpp"
#include "output/diagnostics_file.hpp"
#include "output/writable_file.hpp"
#include "start/solution_file_reader.hpp"
#include "start/text_file.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 4> letters{'p', 'q', 'd', 'r'};

/// The last bytes of a file; empty when it cannot be read.
std::string tail_of(const std::string& path) {
  constexpr std::streamoff longest = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return "";
  const std::streamoff size = file.tellg();
  const std::streamoff length = std::min(size, longest);
  std::string tail(static_cast<std::size_t>(std::max<std::streamoff>(length, 0)), '\0');
  file.seekg(size - length);
  file.read(tail.data(), length);
  tail.resize(static_cast<std::size_t>(file.gcount()));
  return tail;
}

/// Cuts a file to its first `size` bytes.
void cut(const std::string& path, std::size_t size) {
  std::error_code error;
  fs::resize_file(path, size, error);
  if (error) throw ComputationError(fmt::format("{}: cannot be mended ({})", path, error.message()));
}

/// Makes the file end with a newline, cutting off what follows the last one.
void cut_last_line(const std::string& path) {
  const std::string text = read_text_file(path, "an output to add to", "run without --append");
  const auto end = text.rfind('\n');
  const std::size_t size = end == std::string::npos ? 0 : end + 1;
  if (size != text.size()) cut(path, size);
}

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

}  // namespace

std::string output_path(char letter, const std::string& name) {
  const fs::path path(name);
  return (path.parent_path() / fmt::format("{}.{}", letter, path.filename().string())).string();
}

bool is_complete_run(const std::string& diagnostics_path) { return ends_complete_run(tail_of(diagnostics_path)); }

RunFiles::RunFiles(std::string name, Mode mode) : name_(std::move(name)), mode_(mode) {}

void RunFiles::check_writable() {
  if (fs::path(name_).filename().empty())
    throw UserError(fmt::format("'{}' is no name for output files; an example is -o mems", name_));
  for (const char letter : letters) require_writable(path(letter));
  if (mode_ == Mode::append && exists(path('q'))) {
    const SolutionFile existing = read_solution_file(path('q'));
    last_label_ = existing.last_label;
    last_branch_ = existing.last_branch;
  }
  checked_ = true;
}

void RunFiles::open(std::string_view constants) {
  if (!checked_) check_writable();
  if (mode_ == Mode::replace) keep_existing();
  if (mode_ == Mode::append) mend_existing();
  // The d-file comes first: a set without one is taken for somebody's own, not for an interrupted run's.
  diagnostics_ = BlockFile(path('d'), mode_);
  points_ = BlockFile(path('p'), mode_);
  solutions_ = BlockFile(path('q'), mode_);
  BlockFile used_constants(path('r'), Mode::replace);
  used_constants.write(constants);
  used_constants.close();
}

void RunFiles::finish() {
  if (!is_open()) return;
  points_.close();
  solutions_.close();
  diagnostics_.write(format_end_of_run());
  diagnostics_.close();
}

/// A set with a d-file that lacks the closing line may be lost for a complete p.O~; every other one is kept.
void RunFiles::keep_existing() const {
  const bool incomplete = exists(path('d')) && !is_complete_run(path('d'));
  if (incomplete && is_complete_run(path('d') + "~")) return;
  for (const char letter : letters) {
    const std::string current = path(letter);
    std::error_code error;
    if (exists(current)) fs::rename(current, current + "~", error);
    if (error) throw ComputationError(fmt::format("{}: cannot be kept as {}~ ({})", current, current, error.message()));
  }
}

void RunFiles::mend_existing() const {
  for (const char letter : {'p', 'd'})
    if (exists(path(letter))) cut_last_line(path(letter));
  if (!exists(path('q'))) return;
  const std::string text = read_text_file(path('q'), "an output to add to", "run without --append");
  const std::size_t complete = parse_solution_file(text, path('q')).complete_bytes;
  if (complete < text.size()) cut(path('q'), complete);
  if (complete > 0 && text[complete - 1] != '\n') BlockFile(path('q'), Mode::append).write("\n");
}

}  // namespace tchat
