/// Work as commands for the shell, and doing it on several processors. What is done leaves a stamp, and is not done
/// again by a later run with the same commands.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace tchat {

/// Commands one after the other, which make the files of one name in a folder.
struct CommandJob {
  std::string name;                  ///< of its stamp and its log in the folder
  std::vector<std::string> lines;    ///< as a user would type them
  std::vector<std::string> inputs;   ///< files that other jobs make
  std::vector<std::string> outputs;  ///< files that it makes
};

struct JobResult {
  bool was_run = false;  ///< false: not begun, for the time was over or a signal has come
  bool succeeded = false;
  std::string log;  ///< what the commands wrote
};

/// The last message "tchat: ..." of what the commands wrote, or else its last line.
std::string last_message(const JobResult& result);

class JobRunner {
 public:
  /// At most `workers` jobs at a time, their stamps and logs in `folder`. No job is begun once `is_over` says so.
  JobRunner(std::string folder, int workers, std::function<bool()> is_over)
      : folder_(std::move(folder)), workers_(workers), is_over_(std::move(is_over)) {}

  /// The results in the order of the jobs, whichever is ready first. Throws ComputationError where no process can be
  /// made.
  std::vector<JobResult> run(const std::vector<CommandJob>& jobs);

 private:
  struct Process;
  void begin_line(const CommandJob& job, Process& process) const;
  std::string path(const CommandJob& job, const char* ending) const { return folder_ + "/." + job.name + ending; }

  std::string folder_;
  int workers_;
  std::function<bool()> is_over_;
};

}  // namespace tchat
