/// The four files of a run, p.O, q.O, d.O and r.O, opened together and usable at all times.
///
/// Nothing is touched before open(). An existing complete set is kept as p.O~ and so on; an incomplete one (its d-file
/// lacks the closing line) never replaces a complete p.O~. Without finish() the files stay what they are, an incomplete
/// run's.
#pragma once

#include <string>
#include <string_view>

#include "output/block_file.hpp"

namespace tchat {

/// "p.O" in the folder of O: letter 'p', name "results/mems" -> "results/p.mems".
std::string output_path(char letter, const std::string& name);

/// True when the d-file of a set exists and ends with the closing line of a complete run.
bool is_complete_run(const std::string& diagnostics_path);

class RunFiles {
 public:
  using Mode = BlockFile::Mode;

  /// `name` is O, with or without folders.
  explicit RunFiles(std::string name, Mode mode = Mode::replace);

  const std::string& name() const { return name_; }
  bool is_open() const { return points_.is_open(); }

  /// Throws UserError, naming the file and the cure, when a file of the set could not be written: folder missing or
  /// read-only, a directory or device in its place. When appending, also reads q.O for the labels there are.
  void check_writable();

  /// Largest label and branch number already in q.O when appending, after check_writable(); otherwise 0.
  int last_label() const { return last_label_; }
  int last_branch() const { return last_branch_; }

  /// Moves existing files away (or, appending, cuts off an incomplete last line or solution), opens p.O, q.O, d.O and
  /// writes `constants` to r.O. Throws UserError like check_writable(), ComputationError when the system refuses.
  void open(std::string_view constants);

  /// Each stores one block whole; throws ComputationError naming the file (disk full).
  void write_points(std::string_view block) { points_.write(block); }
  void write_solution(std::string_view block) { solutions_.write(block); }
  void write_diagnostics(std::string_view block) { diagnostics_.write(block); }

  /// Writes the closing line of a complete run and closes all files. Does nothing when they are not open.
  void finish();

 private:
  std::string path(char letter) const { return output_path(letter, name_); }
  void keep_existing() const;
  void mend_existing() const;

  std::string name_;
  Mode mode_;
  int last_label_ = 0;
  int last_branch_ = 0;
  bool checked_ = false;
  BlockFile points_;
  BlockFile solutions_;
  BlockFile diagnostics_;
};

}  // namespace tchat
