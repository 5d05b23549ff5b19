/// A new file beside the one that it is to become, under a name that nobody can foresee: .NAME.XXXXXX.new. It is
/// created, never opened through a link that lies there, and removed unless it is put in its place.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "output/block_file.hpp"

namespace tchat {

class TemporaryFile {
 public:
  /// Throws ComputationError naming `path` when no file can be made there.
  explicit TemporaryFile(std::string path);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  /// The name that it has until then, for programs that write into it.
  const std::string& name() const { return name_; }
  void write(std::string_view text) { file_.write_unread(text); }
  void close() { file_.close(); }

  /// Gives it its final name, in one step with the end of a file that has the name. The file is handed over, open
  /// unless it was closed. Throws ComputationError.
  BlockFile put_in_place();

 private:
  std::string path_;
  std::string name_;  // "" when it is in its place
  BlockFile file_;
};

/// A second name for the file `path`, in one step with the end of a file that has this name; `path` stays what it is.
/// Where the file system has no second names (hard links) it is a copy. Throws ComputationError.
void keep_as(const std::string& path, const std::string& kept);

/// Makes `path` a file of its own when it shares its contents with the file `other`. Throws ComputationError.
void separate(const std::string& path, const std::string& other);

/// Removes temporary files for these paths that killed processes have left. Only for who alone may write there.
void remove_abandoned(const std::vector<std::string>& paths);

}  // namespace tchat
