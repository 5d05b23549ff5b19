/// An exclusive lock between processes, held while this object lives: flock on a file that is removed afterwards.
#pragma once

#include <string>

namespace tchat {

class FileLock {
 public:
  /// Waits for the lock at `path`, creating the file. `error()` tells when the file cannot be created; a file system
  /// without locks is taken as locked.
  explicit FileLock(const std::string& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// errno of the attempt to create the lock file, 0 when the lock is held.
  int error() const { return error_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  int error_ = 0;
};

}  // namespace tchat
