/// The four files p.O, q.O, d.O and r.O of a run, written together and kept as a set, and the request that names them.
#pragma once

#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/replaced_file.hpp"
#include "plugin/build_stamp.hpp"
#include "plugin/exit_guard.hpp"

namespace tchat {

// The files p.O, q.O, d.O and r.O of one run as a set, and how a set is kept when a new one takes its place.
//
// At every instant, whatever is killed, a complete set that there was is complete as p.O, q.O, d.O or as p.O~, q.O~,
// d.O~: the old set gets its second names while it still stands, its d-file last, and only then are its files replaced
// one by one, the d-file first. A set whose d-file does not close a run is never taken for a complete one. The same
// holds when the power fails: a set is on the disk before its d-file closes it, and its second names are there before
// the first ones go.

/// "p.O" in the folder of O: letter 'p', name "results/mems" -> "results/p.mems".
std::string output_path(char letter, const std::string& name);

enum class RunSetState {
  absent,       ///< none of p, q, d
  complete,     ///< holds a complete run: the d-file closes one, and p and q have its last point. More may follow
  interrupted,  ///< a run that has not closed its d-file
  foreign       ///< anything else, such as a q-file from elsewhere: no run of ours would leave these together
};

/// Of p.O, q.O, d.O with `suffix` after their names ("" or "~"). Reads the files, but not the numbers of solutions.
RunSetState run_set_state(const std::string& name, const std::string& suffix = "");

/// Before p.O, q.O, d.O or r.O is replaced: keeps what is there under second names, as p.O~ and so on. A set that is
/// not complete never replaces a complete p.O~: an interrupted one is not kept then, a foreign one is kept as p.O~~.
/// Throws ComputationError.
void keep_run_set(const std::string& name);

/// Writes q.O alone, as a start for runs, under the lock of the name; the set that it replaces a file of is kept.
/// Throws UserError when that cannot be done there, ComputationError.
void replace_solution_file(const std::string& name, std::string_view solutions);

// The four files of a run, p.O, q.O, d.O and r.O, opened together and usable at all times.
//
// Nothing but the lock of the name is touched before open(). What was there is kept as keep_run_set() says. Blocks
// are gathered in memory and written together, some times a second: solutions, points, diagnostics, so that what a
// point names is there. Without finish() the files are those of an incomplete run; they still get what was gathered
// when the run ends by an exception, or when leave_process() ends it.

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

// One `tchat run`: what the command line says, before any file is read.

struct RunRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> data;       ///< -d
  std::optional<std::string> start;      ///< -s
  std::optional<std::string> output;     ///< -o
  bool quiet = false;
  bool both_directions = false;
  bool append = false;
  bool clip = false;                   ///< end on the bounds RL0, RL1, A0, A1
  bool strict = false;                 ///< a branch that ends by MX is a failure
  int threads = 1;                     ///< -j
  std::vector<std::string> overrides;  ///< KEY=VALUE
};

/// gc.C in the folder of C, or C itself when only that exists. Throws UserError when neither does.
/// Where C is a folder, gc.C in it counts too: `tchat new` makes NAME/gc.NAME.
std::string constants_path(const std::string& c);
/// gc.NAME, or NAME/gc.NAME where NAME is a folder; empty when there is neither.
std::string own_constants_path(const std::string& name);
/// The constants of the run that wrote the q-file `solutions`: `given` like constants_path(), else the r-file beside
/// it, or gc.NAME of `tchat resegment`. Throws UserError when there is none.
std::string constants_of_run(const std::optional<std::string>& given, const std::string& solutions);
/// D.dat, D/D.dat, or D itself when only that exists. Throws UserError when neither does.
std::string data_path(const std::string& d);
/// q.S in the folder of S, or S itself when only that exists. Throws UserError when neither does.
std::string solution_path(const std::string& s);

/// Both exist and are one file, whatever their paths.
bool same_file(const std::string& a, const std::string& b);

}  // namespace tchat
