/// Work as commands that make files: doing it on several processors, once, and as a Makefile.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/words.hpp"

namespace tchat {

// A job is data: calls of tchat, the files that they read and those that they make. What is executed and the Makefile
// are made from it.
//
// What is done leaves a stamp: the calls, a hash of the program and of all files that they read, and one of those that
// they made. A job is done again when any of these has changed.

/// Calls one after the other, which make the files of one name in a folder.
struct CommandJob {
  std::string name;  ///< of its stamp and its log in the folder
  Commands commands;
  std::vector<std::string> inputs;      ///< files that other jobs make
  std::vector<std::string> outputs;     ///< files that it makes
  std::vector<std::string> given = {};  ///< files of the user that it reads: the problem, constants
};

struct JobResult {
  bool was_run = false;  ///< false: not begun, for the time was over or a signal has come
  int status = 0;        ///< of the call that failed; 0: none did
  std::string failure;   ///< its message
  bool succeeded() const { return was_run && status == 0; }
};

class JobRunner {
 public:
  /// At most `workers` jobs at a time, their stamps and logs in `folder`. No job is begun once `is_over` says so.
  JobRunner(std::string folder, int workers, std::function<bool()> is_over)
      : folder_(std::move(folder)), workers_(workers), is_over_(std::move(is_over)) {}

  /// The results in the order of the jobs, whichever is ready first. Throws ComputationError where no process can be
  /// made.
  std::vector<JobResult> run(const std::vector<CommandJob>& jobs);
  /// Has the job been done, with nothing changed that it reads or has made?
  bool is_done(const CommandJob& job) const;
  /// Have its files been made by a job of this name, whatever it read, and not been changed since?
  bool has_made(const CommandJob& job) const;

 private:
  struct Process;
  void begin_call(const CommandJob& job, Process& process) const;
  std::string path(const CommandJob& job, const char* ending) const { return folder_ + "/." + job.name + ending; }

  std::string folder_;
  int workers_;
  std::function<bool()> is_over_;
};

/// `jobs` come after those that make their inputs, and before `last` ones. Target `branches` makes the files of `jobs`,
/// `all` those of both, `part` a part of PARTS of the branches, number PART from 1: no file belongs to two parts, so
/// that parts can be made at the same time by processes that know nothing of each other.
std::string makefile_text(const std::vector<CommandJob>& jobs, const std::vector<CommandJob>& last,
                          const std::string& folder);

}  // namespace tchat
