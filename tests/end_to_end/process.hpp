/// Another program, run to its end or signalled on the way, with what it printed and how it ended.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace test_support {

struct Outcome {
  int status = -1;         ///< exit status; -1 when a signal or the time limit ended the program
  int signal = 0;          ///< that ended the program, 0 if none did
  bool timed_out = false;  ///< it did not end in time and was killed
  std::string out, err;    ///< standard output, standard error
  std::string text() const { return out + err; }
};

/// Is what takes long wanted, too (scripts/test --all)?
bool all_tests();

class Process {
 public:
  /// Starts `words` (program with its path first) in `folder`; what it prints goes to two files named `log`.out and
  /// `log`.err.
  Process(const std::vector<std::string>& words, const std::string& folder, const std::string& log);
  /// A program that still runs is killed.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const;
  bool ended();
  /// Waits for the end, kills at the time limit.
  Outcome wait(std::chrono::seconds limit);

 private:
  std::string log_;
  pid_t child_ = 0;  // 0 once it has ended
  int raw_status_ = 0;
};

}  // namespace test_support
