/// A compiler as a process of its own.
#pragma once

#include <string>
#include <vector>

namespace tchat {

struct ProcessResult {
  int spawn_error = 0;  ///< errno of starting the program
  int status = 0;       ///< as waitpid gives it
  std::string output;   ///< standard output and standard error together
};

/// Starts the program of the first word, searched along PATH, with the others as its arguments, without input and with
/// messages in English, and waits for its end.
ProcessResult run_process(const std::vector<std::string>& words);

}  // namespace tchat
