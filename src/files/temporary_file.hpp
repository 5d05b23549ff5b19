/// A new file beside the one that it is to become, under a name that nobody can foresee: .NAME.XXXXXX.new. It is
/// created, never opened through a link that lies there, and removed unless it is put in its place.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "files/block_file.hpp"

namespace tchat {

class TemporaryFile {
 public:
  /// Temporary files for this path that killed processes have left are removed: those that no process holds locked.
  /// Throws ComputationError naming `path` when no file can be made there.
  explicit TemporaryFile(std::string path);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  /// The name that it has until then, for programs that write into it.
  const std::string& name() const { return name_; }
  void write(std::string_view text) { file_.write(text); }
  /// It stays locked, and goes to the disk from now on.
  void close();

  /// Gives it its final name, in one step with the end of a file that has the name; contents are on the disk before
  /// that. The file is handed over, open unless it was closed. Throws ComputationError.
  BlockFile put_in_place();

 private:
  std::string path_;
  std::string name_;  // "" when it is in its place
  BlockFile file_;
  int held_ = -1;  // another descriptor of the file, which keeps it locked
};

/// A second name for the file `path`, in one step with the end of a file that has this name; `path` stays what it is.
/// Where the file system has no second names (hard links) it is a copy. Throws ComputationError.
void keep_as(const std::string& path, const std::string& kept);

/// Makes `path` a file of its own when it shares its contents with the file `other`. Throws ComputationError.
void separate(const std::string& path, const std::string& other);

/// Removes temporary files for these paths, all of one folder, that killed processes have left: those that no process
/// holds locked. For second names (path~) only where no other process may be making one.
void remove_abandoned(const std::vector<std::string>& paths);

}  // namespace tchat
