/// The four files of a run, p.O, q.O, d.O and r.O, opened together and usable at all times.
///
/// Nothing but the lock of the name is touched before open(). What was there is kept as output/run_set.hpp says; files
/// grow by whole blocks. Without finish() they stay what they are, an incomplete run's.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "files/block_file.hpp"
#include "files/run_set.hpp"
#include "plugin/file_lock.hpp"

namespace tchat {

class RunFiles {
 public:
  enum class Mode { replace, append };

  /// `name` is O, with or without folders.
  explicit RunFiles(std::string name, Mode mode = Mode::replace);

  const std::string& name() const { return name_; }
  bool is_open() const { return points_.is_open(); }

  /// Locks the name against other processes. Throws UserError, naming the file and the cure, when another process is
  /// writing the set or a file of it could not be written or kept: folder missing or read-only, a directory or device
  /// in its place. When appending, also reads q.O for the labels there are.
  void check_writable();

  /// Largest label and branch number already in q.O when appending, after check_writable(); otherwise 0.
  int last_label() const { return last_label_; }
  int last_branch() const { return last_branch_; }

  /// Keeps existing files and puts empty ones in their place (or, appending, cuts off an incomplete last line or
  /// solution), and writes `constants` to r.O. Throws UserError like check_writable(), ComputationError when the system
  /// refuses.
  void open(std::string_view constants);

  /// Each stores one block whole; throws ComputationError naming the file (disk full).
  void write_points(std::string_view block) { points_.write(block); }
  void write_solution(std::string_view block) { solutions_.write(block); }
  void write_diagnostics(std::string_view block) { diagnostics_.write(block); }

  /// Writes the closing line of a complete run, closes all files and gives the lock back. Does nothing when they are
  /// not open.
  void finish();

 private:
  std::string path(char letter) const { return output_path(letter, name_); }
  void begin_new_set();
  void go_on_with_set();
  void mend_existing() const;

  std::string name_;
  Mode mode_;
  int last_label_ = 0;
  int last_branch_ = 0;
  std::unique_ptr<FileLock> lock_;  // there: checked
  BlockFile points_;
  BlockFile solutions_;
  BlockFile diagnostics_;
};

}  // namespace tchat
