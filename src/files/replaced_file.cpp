#include "files/replaced_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <utility>

#include "base/messages.hpp"

namespace tchat {

namespace {

/// errno of what failed, 0.
int sync_error(int descriptor) {
  int error = 0;
  do {
    error = ::fsync(descriptor) == 0 ? 0 : errno;
  } while (error == EINTR);
  return error;
}

void tell(int error, const std::string& path) {
  if (error == EIO || error == ENOSPC || error == EDQUOT)
    throw ComputationError(fmt::format("{}: cannot be stored on the disk ({})", path, std::strerror(error)));
}

void sync_opened(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  const int error = sync_error(descriptor);
  ::close(descriptor);
  tell(error, path);
}

}  // namespace

void begin_sync(int descriptor) { ::sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE); }

void sync_file(int descriptor, const std::string& path) { tell(sync_error(descriptor), path); }

void sync_file(const std::string& path) { sync_opened(path, 0); }

void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  sync_opened(folder.empty() ? "." : folder, O_DIRECTORY);
}

namespace {

/// Size of an ordinary file; -1 for devices and pipes, which cannot be cut.
off_t ordinary_size(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return -1;
  return status.st_size;
}

/// Nothing but system calls. errno of what failed, 0.
int append(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

struct Outcome {
  int error = 0;
  bool whole = true;  ///< no part of the text that failed is left in the file
};

Outcome append_or_cut(int descriptor, std::string_view text) {
  const off_t before = ordinary_size(descriptor);
  const int error = append(descriptor, text);
  return {error, error == 0 || before < 0 || ::ftruncate(descriptor, before) == 0};
}

}  // namespace

BlockFile::BlockFile(std::string path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_APPEND, 0666);
  if (descriptor_ < 0) fail("cannot be opened for writing", errno);
}

BlockFile::BlockFile(int descriptor, std::string path, bool is_temporary)
    : path_(std::move(path)), descriptor_(descriptor), is_temporary_(is_temporary) {}

BlockFile::BlockFile(BlockFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      is_temporary_(other.is_temporary_) {}

BlockFile& BlockFile::operator=(BlockFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(is_temporary_, other.is_temporary_);
  return *this;
}

BlockFile::~BlockFile() {
  if (is_open()) ::close(descriptor_);
}

void BlockFile::write(std::string_view blocks) {
  if (blocks.empty()) return;
  const Outcome outcome = append_or_cut(descriptor_, blocks);
  if (outcome.error == 0) return;
  if (is_temporary_) fail("cannot be written; what had this name before stays", outcome.error);
  fail(outcome.whole ? "cannot be written; it holds everything up to the last complete block"
                     : "cannot be written; its last block is not complete",
       outcome.error);
}

void BlockFile::write_before_the_end(std::string_view blocks) noexcept {
  if (is_open() && !blocks.empty()) append_or_cut(descriptor_, blocks);
}

void BlockFile::begin_sync() {
  if (is_open()) tchat::begin_sync(descriptor_);
}

void BlockFile::sync() {
  if (is_open()) sync_file(descriptor_, path_);
}

void BlockFile::close() {
  if (!is_open()) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot be closed", errno);
}

void BlockFile::fail(const std::string& what, int error) const {
  throw ComputationError(fmt::format("{}: {} ({})", path_, what, std::strerror(error)));
}

namespace fs = std::filesystem;

namespace {

constexpr int random_letters = 6;
constexpr int most_tries = 100;
constexpr const char* ending = ".new";

std::string temporary_name(const std::string& path) {
  static constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  std::random_device random;
  std::uniform_int_distribution<std::size_t> any(0, letters.size() - 1);
  std::string chosen;
  for (int k = 0; k < random_letters; ++k) chosen += letters[any(random)];
  const fs::path final_path(path);
  return (final_path.parent_path() / fmt::format(".{}.{}{}", final_path.filename().string(), chosen, ending)).string();
}

bool is_temporary_name_of(const std::string& file, const std::string& final_name) {
  const std::string begin = fmt::format(".{}.", final_name);
  return file.size() == begin.size() + random_letters + std::strlen(ending) && file.starts_with(begin) &&
         file.ends_with(ending);
}

/// Calls `make(name)` with new names until none is taken; the name, errno set and "" when it fails.
template <class Make>
std::string make_under_new_name(const std::string& path, const Make& make) {
  for (int k = 0; k < most_tries; ++k) {
    std::string name = temporary_name(path);
    if (make(name)) return name;
    if (errno != EEXIST) return "";
  }
  return "";
}

/// A new file that no other process takes for an abandoned one; -1 and errno set when it fails.
int open_locked(const std::string& name) {
  const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC | O_APPEND, 0666);
  if (descriptor < 0) return -1;
  // Where there are no locks nothing counts as abandoned. Another process may have removed it before it was locked.
  ::flock(descriptor, LOCK_EX | LOCK_NB);
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && status.st_nlink > 0) return descriptor;
  ::close(descriptor);
  errno = EEXIST;
  return -1;
}

/// Removes the file unless a process that lives has it locked.
void remove_unlocked(const std::string& name) {
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(name.c_str());
  ::close(descriptor);
}

bool is_empty(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && status.st_size == 0;
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& why) {
  throw ComputationError(fmt::format("{}: {} ({})", path, what, why));
}

/// The contents of `path` as the file `target`.
void copy_to(const std::string& path, const std::string& target) {
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(path, "cannot be read to be kept", std::strerror(errno));
  TemporaryFile copy(target);
  std::string part(1 << 20, '\0');
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())) || in.gcount() > 0)
    copy.write(std::string_view(part).substr(0, static_cast<std::size_t>(in.gcount())));
  if (in.bad()) refuse(path, "cannot be read to be kept", std::strerror(errno));
  copy.close();
  copy.put_in_place();
}

}  // namespace

TemporaryFile::TemporaryFile(std::string path) : path_(std::move(path)) {
  remove_abandoned({path_});
  int descriptor = -1;
  name_ = make_under_new_name(path_, [&descriptor](const std::string& name) {
    descriptor = open_locked(name);
    return descriptor >= 0;
  });
  if (name_.empty()) refuse(path_, "cannot be opened for writing", std::strerror(errno));
  file_ = BlockFile(descriptor, path_, true);
  held_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
}

TemporaryFile::~TemporaryFile() {
  if (!name_.empty()) std::remove(name_.c_str());
  if (held_ >= 0) ::close(held_);
}

void TemporaryFile::close() {
  file_.begin_sync();
  file_.close();
}

BlockFile TemporaryFile::put_in_place() {
  if (!is_empty(held_)) sync_file(held_, path_);
  if (std::rename(name_.c_str(), path_.c_str()) != 0) refuse(path_, "cannot be written", std::strerror(errno));
  name_.clear();
  file_.is_in_place();
  ::flock(held_, LOCK_UN);
  return std::move(file_);
}

void keep_as(const std::string& path, const std::string& kept) {
  for (int k = 0; k < most_tries; ++k) {
    const std::string name =
        make_under_new_name(kept, [&path](const std::string& free) { return ::link(path.c_str(), free.c_str()) == 0; });
    if (name.empty()) return copy_to(path, kept);
    const bool renamed = std::rename(name.c_str(), kept.c_str()) == 0;
    const int error = errno;
    ::unlink(name.c_str());  // still there when it failed, and when both were names of one file already
    if (renamed) return;
    // Another process may have taken the name for an abandoned one.
    if (error != ENOENT) refuse(path, fmt::format("cannot be kept as {}", kept), std::strerror(error));
  }
  refuse(path, fmt::format("cannot be kept as {}", kept), std::strerror(ENOENT));
}

void separate(const std::string& path, const std::string& other) {
  std::error_code error;
  if (fs::equivalent(path, other, error) && !error) copy_to(path, path);
}

void remove_abandoned(const std::vector<std::string>& paths) {
  const auto is_abandoned = [&paths](const std::string& file) {
    return std::any_of(paths.begin(), paths.end(), [&file](const std::string& path) {
      return is_temporary_name_of(file, fs::path(path).filename().string());
    });
  };
  if (paths.empty()) return;
  const fs::path parent = fs::path(paths.front()).parent_path();
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator at(parent.empty() ? "." : parent, error), end; !error && at != end; at.increment(error))
    if (is_abandoned(at->path().filename().string())) found.push_back(at->path());
  for (const fs::path& file : found) remove_unlocked(file.string());
}

namespace {

void refuse(const std::string& path, const std::string& what) {
  throw UserError(fmt::format("{}: {}; choose another name with -o, or mend the file's place", path, what));
}

void check_folder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (!fs::is_directory(folder, error)) refuse(path, fmt::format("cannot be written, there is no folder {}", folder));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(path, fmt::format("cannot be written in folder {} ({})", folder, std::strerror(errno)));
}

}  // namespace

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

void require_writable(const std::string& path) {
  check_folder(path);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) refuse(path, "cannot be written, it is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(path, "cannot be written, it is a device or pipe");
  if (fs::exists(status) && ::access(path.c_str(), W_OK) != 0)
    refuse(path, fmt::format("cannot be written ({})", std::strerror(errno)));
  const std::string kept = path + "~";
  if (fs::exists(status) && fs::is_directory(kept, error))
    throw UserError(
        fmt::format("{} cannot be replaced: it is to be kept as {}, and that is a directory; move the directory away, "
                    "or choose another name with -o",
                    path, kept));
}

namespace {

std::string checked(std::string path) {
  require_writable(path);
  return path;
}

}  // namespace

ReplacedFile::ReplacedFile(std::string path) : path_(checked(std::move(path))), file_(path_) {
  remove_abandoned({path_ + "~"});
}

void ReplacedFile::finish() {
  file_.close();
  std::error_code error;
  if (std::filesystem::exists(path_, error)) {
    keep_as(path_, path_ + "~");
    sync_folder_of(path_);
  }
  file_.put_in_place();
  sync_folder_of(path_);
}

void write_whole_file(const std::string& path, std::string_view text) {
  ReplacedFile file(path);
  file.write(text);
  file.finish();
}

std::unique_ptr<FileLock> lock_output(const std::string& name, const std::string& cure) {
  // A process that was killed may still be storing its last block; a run that is going on takes longer.
  constexpr std::chrono::milliseconds patience{1000};
  const std::filesystem::path path(name);
  const std::string file = fmt::format(".{}.lock", path.filename().string());
  auto lock = std::make_unique<FileLock>((path.parent_path() / file).string(), patience);
  if (lock->error() != EWOULDBLOCK) return lock;
  const std::string who = lock->holder() > 0 ? fmt::format(" (process {})", lock->holder()) : "";
  throw UserError(
      fmt::format("{}: another tchat{} is writing the files of this name; wait for its end, or choose another name "
                  "with {}",
                  name, who, cure));
}

}  // namespace tchat
