/// A compiler as a process of its own: its instruction set, and its errors in a few lines.
#pragma once

#include <string>
#include <string_view>
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

// What a C++ compiler says of a plugin, in a few lines: one mistake in a template gives a hundred of its own.

/// Every mistake once, at its place in the author's files (not in tchat's or the system's headers), with the line and,
/// where it is one that authors of problems often make, the cure. `include_folder` is the folder with
/// tchat/problem.hpp. Empty when the output (of g++ or clang++) names no error.
std::string short_errors(const std::string& output, const std::string& include_folder);

// Instructions beyond those that every processor of this architecture has, which plugins are compiled with where this
// processor has them.

/// The option of g++ and clang++ for them; "" where there are none.
inline std::string_view instruction_option() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) return "-mavx2";
#endif
  return {};
}

/// Does this processor run a plugin that says to have been compiled for these, as `tchat_problem_instructions` of
/// tchat/problem.hpp does?
inline bool runs_instructions(std::string_view name) {
  return name.empty() || instruction_option() == std::string("-m").append(name);
}

}  // namespace tchat
