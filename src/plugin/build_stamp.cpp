#include "plugin/build_stamp.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "base/text_file.hpp"
#include "base/words.hpp"
#include "plugin/compiler_process.hpp"

namespace tchat {

namespace {

/// False when another holder removed or replaced the file between our open and our lock.
bool still_at(const std::string& path, int descriptor) {
  struct stat opened {};
  struct stat named {};
  if (fstat(descriptor, &opened) != 0 || stat(path.c_str(), &named) != 0) return false;
  return opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// False when another process has the lock and we do not wait. Other failures are those of a file system without locks.
bool lock(int descriptor, bool wait) {
  while (flock(descriptor, wait ? LOCK_EX : LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno != EWOULDBLOCK;
  }
  return true;
}

int number_in(int descriptor) {
  std::array<char, 16> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  int number = 0;
  if (size > 0) std::from_chars(text.data(), text.data() + size, number);
  return number;
}

void leave_own_number(int descriptor) {
  const std::string text = std::to_string(getpid()) + '\n';
  if (ftruncate(descriptor, 0) != 0) return;
  if (pwrite(descriptor, text.data(), text.size(), 0) < 0) return;  // the number only serves a message
}

}  // namespace

FileLock::FileLock(const std::string& path) : path_(path) {
  while (!try_once(true)) {
  }
}

FileLock::FileLock(const std::string& path, std::chrono::milliseconds patience) : path_(path) {
  constexpr std::chrono::milliseconds pause{10};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!try_once(false)) {
    if (error_ != 0 && std::chrono::steady_clock::now() >= deadline) return;
    std::this_thread::sleep_for(pause);
  }
}

/// True when there is nothing more to try: the lock is held, or its file cannot be made.
bool FileLock::try_once(bool wait) {
  const int descriptor = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  error_ = descriptor < 0 ? errno : 0;
  if (descriptor < 0) return true;
  if (!lock(descriptor, wait)) {
    error_ = EWOULDBLOCK;
    holder_ = number_in(descriptor);
  } else if (still_at(path_, descriptor)) {
    leave_own_number(descriptor);
    descriptor_ = descriptor;
    return true;
  }
  close(descriptor);
  return false;
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());  // before the lock goes, so that a waiting process sees that its file is gone
  close(descriptor_);
}

namespace {

constexpr std::string_view stamp_mark = "\n#tchat-plugin-stamp ";
constexpr std::string_view stamp_version = "2\n";
constexpr std::string_view stamp_foot = "#tchat-plugin-stamp-end\n";
constexpr std::streamoff longest_stamp = 1 << 16;

constexpr std::uint64_t hash_start = 14695981039346656037ULL;

/// FNV-1a, continued from `hash`.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t hash) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return hash;
}

/// All that can be read of a file from `begin` on.
std::string read_rest(std::ifstream& in) {
  std::ostringstream text;
  text << in.rdbuf();  // an error while reading ends it
  return text.str();
}

/// The last bytes of a file, at most longest_stamp of them.
std::string read_tail(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return "";
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - longest_stamp));
  return read_rest(in);
}

/// What follows `folder`/ in a path; "" when the path does not lie there.
std::string below(const std::string& folder, const std::string& path) {
  const std::string begin = folder.ends_with('/') ? folder : folder + "/";
  return path.starts_with(begin) ? path.substr(begin.size()) : "";
}

}  // namespace

std::string BuildInput::found_from(const BuildPlaces& places) const {
  if (root == Root::elsewhere) return path;
  return (root == Root::source ? places.source_folder : places.include_folder) + "/" + path;
}

BuildInput place_of(const std::string& file, const BuildPlaces& places) {
  if (std::string path = below(places.include_folder, file); path.starts_with("tchat/"))
    return {BuildInput::Root::interface, path};
  if (std::string path = below(places.source_folder, file); !path.empty()) return {BuildInput::Root::source, path};
  return {BuildInput::Root::elsewhere, file};
}

std::string hash_text(const std::string& text) { return fmt::format("{:016x}", hash_bytes(text, hash_start)); }

std::string hash_files(const std::vector<BuildInput>& files, const BuildPlaces& places) {
  std::uint64_t hash = hash_start;
  for (const BuildInput& input : files) {
    const std::string file = input.found_from(places);
    const std::optional<std::string> text = read_text_if_there(file, "source of the plugin");
    hash = hash_bytes(text ? "+" : "-", hash_bytes(input.path, hash));
    hash = hash_bytes(text.value_or(""), hash);
  }
  return fmt::format("{:016x}", hash);
}

std::vector<std::string> read_dependencies(const std::string& path) {
  const std::string text = read_text_if_there(path, "dependencies of the plugin").value_or("");
  std::vector<std::string> files;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty() && word.back() != ':') files.push_back(std::filesystem::absolute(word).string());
    word.clear();
  };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char next = k + 1 < text.size() ? text[k + 1] : '\n';
    if (text[k] == '\\' && (next == ' ' || next == '#' || next == '\\')) {
      word += text[++k];
    } else if (text[k] == '$' && next == '$') {
      word += text[++k];
    } else if (text[k] == '\\' && next == '\n') {
      end_word();
    } else if (std::isspace(static_cast<unsigned char>(text[k])) != 0) {
      end_word();
    } else {
      word += text[k];
    }
  }
  end_word();
  return files;
}

bool append_stamp(const std::string& library, const BuildStamp& stamp) {
  std::ofstream out(library, std::ios::binary | std::ios::app);
  out << stamp_mark << stamp_version << stamp.compiler << '\n' << stamp.contents << '\n';
  for (const BuildInput& file : stamp.files) out << static_cast<char>(file.root) << file.path << '\n';
  out << stamp_foot;
  out.close();
  return static_cast<bool>(out);
}

std::optional<BuildStamp> read_stamp(const std::string& library) {
  const std::string tail = read_tail(library);
  const std::size_t mark = tail.rfind(stamp_mark);
  if (mark == std::string::npos || !tail.ends_with(stamp_foot)) return std::nullopt;
  std::string text = tail.substr(mark + stamp_mark.size());
  if (!text.starts_with(stamp_version)) return BuildStamp{};
  text.resize(text.size() - stamp_foot.size());
  std::istringstream lines(text.substr(stamp_version.size()));
  BuildStamp stamp;
  std::getline(lines, stamp.compiler);
  std::getline(lines, stamp.contents);
  for (std::string file; std::getline(lines, file) && !file.empty();)
    stamp.files.push_back({static_cast<BuildInput::Root>(file[0]), file.substr(1)});
  return stamp;
}

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
