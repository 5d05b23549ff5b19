#include "files/temporary_file.hpp"

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

#include "base/user_error.hpp"
#include "files/disk_sync.hpp"

namespace tchat {

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
  file_ = BlockFile(descriptor, path_);
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

}  // namespace tchat
