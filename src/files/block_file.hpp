/// A text file that grows by whole blocks, so that a full disk leaves no part of one.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

class BlockFile {
 public:
  BlockFile() = default;
  /// Opens or creates the file, to add to its end. Throws ComputationError naming it when that fails.
  explicit BlockFile(std::string path);
  /// Takes over an open file; `path` is its name.
  BlockFile(int descriptor, std::string path);
  BlockFile(const BlockFile&) = delete;
  BlockFile& operator=(const BlockFile&) = delete;
  BlockFile(BlockFile&& other) noexcept;
  BlockFile& operator=(BlockFile&& other) noexcept;
  /// Closes; what was written stays.
  ~BlockFile();

  bool is_open() const { return descriptor_ >= 0; }
  const std::string& path() const { return path_; }

  /// Appends whole blocks. When only a part can be stored (disk full) the part is removed again; throws
  /// ComputationError naming the file and the reason. A SIGKILL meanwhile may leave a part: readers leave it out.
  void write(std::string_view blocks);

  /// The same, safe in a signal handler; says nothing about success.
  void write_before_the_end(std::string_view blocks) noexcept;

  /// What was written goes to the disk from now on; sync() waits for it.
  void begin_sync();

  /// Waits until what was written is on the disk, for the case that the power fails. Throws ComputationError.
  void sync();

  /// Closes the file. Throws ComputationError when the system reports a failure only now.
  void close();

 private:
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace tchat
