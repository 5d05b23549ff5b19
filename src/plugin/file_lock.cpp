#include "plugin/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace tchat {

namespace {

/// False when another holder removed or replaced the file between our open and our lock.
bool still_at(const std::string& path, int descriptor) {
  struct stat opened {};
  struct stat named {};
  if (fstat(descriptor, &opened) != 0 || stat(path.c_str(), &named) != 0) return false;
  return opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void wait_for_lock(int descriptor) {
  while (flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
  }
}

}  // namespace

FileLock::FileLock(const std::string& path) : path_(path) {
  while (true) {
    descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      error_ = errno;
      return;
    }
    wait_for_lock(descriptor_);
    if (still_at(path, descriptor_)) return;
    close(descriptor_);
  }
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());  // before the lock goes, so that a waiting process sees that its file is gone
  close(descriptor_);
}

}  // namespace tchat
