/// A text file that grows by whole blocks, so that a reader, a kill or a full disk finds no part of one.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

class BlockFile {
 public:
  enum class Mode { replace, append };

  BlockFile() = default;
  /// Opens or creates the file. Throws ComputationError naming it when that fails.
  BlockFile(std::string path, Mode mode);
  BlockFile(const BlockFile&) = delete;
  BlockFile& operator=(const BlockFile&) = delete;
  BlockFile(BlockFile&& other) noexcept;
  BlockFile& operator=(BlockFile&& other) noexcept;
  /// Closes; what was written stays.
  ~BlockFile();

  bool is_open() const { return descriptor_ >= 0; }
  const std::string& path() const { return path_; }

  /// Hands the block to the system in one call. When only a part of it can be stored (disk full) the part is removed
  /// again; throws ComputationError naming the file and the reason.
  void write(std::string_view block);

  /// Closes the file. Throws ComputationError when the system reports a failure only now.
  void close();

 private:
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace tchat
