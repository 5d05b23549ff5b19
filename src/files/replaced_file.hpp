/// Writing files so that neither a full disk nor a power failure leaves part of one: blocks, replacement of whole
/// files, and a lock on output names.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/build_stamp.hpp"

namespace tchat {

// What must be on the disk before something else may happen, for the case that the power fails.

/// Has the contents of an open file written to the disk without waiting, so that several files come there at once: one
/// that is synced afterwards waits less. Says nothing about success.
void begin_sync(int descriptor);

/// Waits until the contents of an open file are on the disk (nothing to wait for when they are already). Devices and
/// file systems that know no such thing are passed over. Throws ComputationError naming `path` when the disk fails.
void sync_file(int descriptor, const std::string& path);

/// The same by name; a file that is missing needs nothing.
void sync_file(const std::string& path);

/// Waits until the names in the folder of `path` are on the disk: files created, renamed, removed.
void sync_folder_of(const std::string& path);

class BlockFile {
 public:
  BlockFile() = default;
  /// Opens or creates the file, to add to its end. Throws ComputationError naming it when that fails.
  explicit BlockFile(std::string path);
  /// Takes over an open file; `path` is its name, or the one that it is to have.
  BlockFile(int descriptor, std::string path, bool is_temporary);
  BlockFile(const BlockFile&) = delete;
  BlockFile& operator=(const BlockFile&) = delete;
  BlockFile(BlockFile&& other) noexcept;
  BlockFile& operator=(BlockFile&& other) noexcept;
  /// Closes; what was written stays.
  ~BlockFile();

  bool is_open() const { return descriptor_ >= 0; }
  /// It has its name now.
  void is_in_place() { is_temporary_ = false; }
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
  bool is_temporary_ = false;
};

// A new file beside the one that it is to become, under a name that nobody can foresee: .NAME.XXXXXX.new. It is
// created, never opened through a link that lies there, and removed unless it is put in its place.

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

// Asked before any work is done: is a file there, can one be written there?

/// False also where it cannot be told.
bool exists(const std::string& path);

/// Throws UserError when `path` lies in a folder that is missing or closed, or is a directory, a device or a file that
/// may not be replaced, or when there is one that cannot be kept as `path~`.
void require_writable(const std::string& path);

// A file written under another name and put in its place when complete, so that no moment has half a file or none;
// one that was there is kept as `path~`.

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

// A small text file that is written whole: readers find the old one or the new one, never a part.

/// Writes a file beside it and renames it; an existing file is kept as path~. Throws UserError, ComputationError naming
/// the file.
void write_whole_file(const std::string& path, std::string_view text);

// One process at a time writes the files of one output name.

/// Holds the lock .O.lock in the folder of `name` = O. Throws UserError naming the other process that is writing these
/// files; `cure` says how to give them another name. A folder in which no lock can be made is no obstacle here.
std::unique_ptr<FileLock> lock_output(const std::string& name, const std::string& cure = "-o");

}  // namespace tchat
