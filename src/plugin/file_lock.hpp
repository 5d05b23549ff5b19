/// An exclusive lock between processes, held while this object lives: flock on a file that is removed afterwards. The
/// file holds the number of the process that has the lock.
#pragma once

#include <chrono>
#include <string>

namespace tchat {

class FileLock {
 public:
  /// Waits for the lock at `path`, creating the file. `error()` tells when the file cannot be created; a file system
  /// without locks is taken as locked.
  explicit FileLock(const std::string& path);
  /// The same, but waits no longer than this for another process.
  FileLock(const std::string& path, std::chrono::milliseconds patience);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// errno of the attempt to create the lock file, 0 when the lock is held. EWOULDBLOCK: another process has it.
  int error() const { return error_; }
  /// Number of the other process, 0 when it is not known.
  int holder() const { return holder_; }

 private:
  bool try_once(bool wait);

  std::string path_;
  int descriptor_ = -1;
  int error_ = 0;
  int holder_ = 0;
};

}  // namespace tchat
