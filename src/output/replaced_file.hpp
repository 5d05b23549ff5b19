/// A file written under another name and put in its place when complete, so that no moment has half a file; one that
/// was there is kept as `path~`.
#pragma once

#include <string>
#include <string_view>

#include "output/block_file.hpp"

namespace tchat {

class ReplacedFile {
 public:
  /// Opens `path`.new. Throws ComputationError when it cannot be written.
  explicit ReplacedFile(std::string path);
  ReplacedFile(const ReplacedFile&) = delete;
  ReplacedFile& operator=(const ReplacedFile&) = delete;
  /// Without finish() nothing is replaced.
  ~ReplacedFile();

  void write(std::string_view block) { file_.write(block); }
  /// Puts the file in its place. Throws ComputationError.
  void finish();

 private:
  std::string path_;
  BlockFile file_;
};

}  // namespace tchat
