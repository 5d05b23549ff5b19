/// The four files of a run, p.O, q.O, d.O and r.O, opened together and usable at all times.
///
/// Nothing but the lock of the name is touched before open(). What was there is kept as files/run_set.hpp says. Blocks
/// are gathered in memory and written together, some times a second: solutions, points, diagnostics, so that what a
/// point names is there. Without finish() the files are those of an incomplete run; they still get what was gathered
/// when the run ends by an exception, or when leave_process() ends it.
#pragma once

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <string_view>

#include "files/block_file.hpp"
#include "files/run_set.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/file_lock.hpp"

namespace tchat {

class RunFiles final : private LastAct {
 public:
  enum class Mode { replace, append };

  /// `name` is O, with or without folders.
  explicit RunFiles(std::string name, Mode mode = Mode::replace);
  /// Writes what was gathered.
  ~RunFiles() override;
  RunFiles(const RunFiles&) = delete;
  RunFiles& operator=(const RunFiles&) = delete;

  const std::string& name() const { return name_; }
  bool is_open() const { return points_.file.is_open(); }

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

  /// Each gathers one block.
  void add_points(std::string_view block) { add(points_, block); }
  void add_solution(std::string_view block) { add(solutions_, block); }
  void add_diagnostics(std::string_view block) { add(diagnostics_, block); }

  /// To be called when all blocks of a point are there: writes what was gathered when a solution is among it, a quarter
  /// of a second has passed since the last time, or it is much. Throws ComputationError naming the file (disk full);
  /// what was gathered is given up then.
  void write_if_due();

  /// Writes the closing line of a complete run, closes all files and gives the lock back. Does nothing when they are
  /// not open.
  void finish();

 private:
  struct Growing {
    BlockFile file;
    std::string gathered;
    std::string being_written;
  };

  std::string path(char letter) const { return output_path(letter, name_); }
  void add(Growing& growing, std::string_view block);
  void write_gathered();
  void act() noexcept override;
  void begin_new_set();
  void go_on_with_set();
  void mend_existing() const;

  std::string name_;
  Mode mode_;
  int last_label_ = 0;
  int last_branch_ = 0;
  std::unique_ptr<FileLock> lock_;  // there: checked
  Growing points_;
  Growing solutions_;
  Growing diagnostics_;
  std::chrono::steady_clock::time_point last_written_;
  volatile std::sig_atomic_t changing_ = 0;  // a signal handler may find the gathered texts in the middle of a change
};

}  // namespace tchat
