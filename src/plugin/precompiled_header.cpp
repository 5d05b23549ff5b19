#include "plugin/precompiled_header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <utility>

#include "base/words.hpp"
#include "plugin/build_stamp.hpp"
#include "plugin/compiler_process.hpp"
#include "plugin/file_lock.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

constexpr const char* folder_prefix = "header-";
constexpr std::size_t most_kept = 4;  // some ten megabytes each

/// Keeps the newest header folders of the cache; the others belong to other compilers or versions.
void remove_old(const fs::path& cache) {
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  for (fs::directory_iterator at(cache, error), end; !error && at != end; at.increment(error))
    if (at->path().filename().string().starts_with(folder_prefix) && at->is_directory(error))
      found.emplace_back(at->last_write_time(error), at->path());
  std::sort(found.rbegin(), found.rend());
  for (std::size_t k = most_kept; k < found.size(); ++k) fs::remove_all(found[k].second, error);
}

std::string hash_of_headers(const std::string& include_folder) {
  const BuildPlaces places{"", include_folder};
  std::vector<BuildInput> headers;
  std::error_code error;
  for (fs::directory_iterator at(include_folder + "/tchat", error), end; !error && at != end; at.increment(error))
    headers.push_back({BuildInput::Root::interface, "tchat/" + at->path().filename().string()});
  std::sort(headers.begin(), headers.end(), [](const BuildInput& a, const BuildInput& b) { return a.path < b.path; });
  return hash_files(headers, places);
}

}  // namespace

std::optional<fs::path> cache_folder() {
  const char* const xdg = std::getenv("XDG_CACHE_HOME");
  if (xdg != nullptr && xdg[0] == '/') return fs::path(xdg) / "tchat";
  const char* const home = std::getenv("HOME");
  if (home != nullptr && home[0] == '/') return fs::path(home) / ".cache" / "tchat";
  return std::nullopt;
}

bool can_come_first(const std::string& source) {
  std::ifstream in(source);
  bool in_comment = false;
  for (std::string line; std::getline(in, line);) {
    const std::string_view text = trimmed(line);
    if (!in_comment && text.starts_with("#include")) {
      const std::string_view name = trimmed(text.substr(8));
      if (name.starts_with("<tchat/problem.hpp>") || name.starts_with("\"tchat/problem.hpp\"")) return true;
      if (!name.starts_with('<')) return false;
      continue;
    }
    const bool is_comment = in_comment || text.empty() || text.starts_with("//") || text.starts_with("/*");
    if (!is_comment) return false;
    const auto end = text.starts_with("//") && !in_comment ? std::string_view::npos : text.find("*/");
    if (end != std::string_view::npos && end + 2 < text.size()) return false;
    in_comment = (in_comment || text.starts_with("/*")) && end == std::string_view::npos;
  }
  return false;
}

PrecompiledHeader::PrecompiledHeader(const std::string& identity, std::vector<std::string> command,
                                     const std::string& include_folder)
    : command_(std::move(command)), include_folder_(fs::absolute(include_folder).string()) {
  const std::optional<fs::path> cache = cache_folder();
  if (!cache || identity.empty()) return;
  const std::string key = fmt::format("{}\n{}\n{}\n{}", identity, fmt::join(command_, "\n"), include_folder_,
                                      hash_of_headers(include_folder_));
  folder_ = *cache / (folder_prefix + hash_text(key));
}

bool PrecompiledHeader::is_made() const {
  std::error_code error;
  return !folder_.empty() && fs::exists(made(), error);
}

std::vector<std::string> PrecompiledHeader::options_for(const std::string& source) const {
  if (!is_made() || !can_come_first(source)) return {};
  return {"-include", (folder_ / "tchat" / "problem.hpp").string(), "-fpch-deps"};
}

/// Leaves a mark: a header that is asked for once is not worth its time.
bool PrecompiledHeader::is_first_time() const {
  const fs::path mark = folder_ / "asked";
  std::error_code error;
  if (fs::exists(mark, error)) return false;
  const std::ofstream made(mark);
  return true;
}

void PrecompiledHeader::make() const noexcept {
  try {
    if (folder_.empty() || is_made()) return;
    std::error_code error;
    fs::create_directories(made().parent_path(), error);
    if (error) return;
    const FileLock lock(folder_.string() + "/lock");
    if (lock.error() != 0 || is_made() || is_first_time()) return;
    const std::string unfinished = (folder_ / fmt::format("unfinished.{}", ::getpid())).string();
    std::vector<std::string> words = command_;
    // With rules for make it keeps the names of the headers, for those of the plugins.
    words.insert(words.end(), {"-w", "-MMD", "-MF", "/dev/null", "-x", "c++-header", header(), "-o", unfinished});
    const ProcessResult result = run_process(words);
    const bool succeeded = result.spawn_error == 0 && result.status == 0;
    if (succeeded) fs::rename(unfinished, made(), error);
    if (!succeeded || error) fs::remove(unfinished, error);
    remove_old(folder_.parent_path());
  } catch (const std::exception&) {  // as promised
  }
}

void PrecompiledHeader::remove() const noexcept {
  std::error_code error;
  fs::remove_all(folder_, error);
}

}  // namespace tchat
