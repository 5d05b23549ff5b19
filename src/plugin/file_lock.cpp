#include "plugin/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <thread>

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

}  // namespace tchat
