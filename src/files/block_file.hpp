/// A text file that grows by whole blocks, so that a reader, a kill or a full disk finds no part of one.
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

  /// Stores the block whole, also when this process is killed meanwhile. When only a part of it can be stored (disk
  /// full) the part is removed again; throws ComputationError naming the file and the reason.
  void write(std::string_view block);

  /// The same for a file that nobody reads before it is finished: a kill may cut it. Much cheaper.
  void write_unread(std::string_view block);

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
