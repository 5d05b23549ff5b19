/// A file written under another name and put in its place when complete, so that no moment has half a file or none;
/// one that was there is kept as `path~`.
#pragma once

#include <string>
#include <string_view>

#include "files/temporary_file.hpp"

namespace tchat {

class ReplacedFile {
 public:
  /// Opens the file under its temporary name; without finish() nothing is replaced. Throws UserError when it, or what
  /// it replaces as `path`~, can have no such name, ComputationError when the system refuses.
  explicit ReplacedFile(std::string path);

  void write(std::string_view block) { file_.write(block); }
  /// Keeps what is there, which then still stands in its place, and puts the new file there. Throws ComputationError.
  void finish();

 private:
  std::string path_;
  TemporaryFile file_;
};

}  // namespace tchat
