/// Instructions beyond those that every processor of this architecture has, which plugins are compiled with where this
/// processor has them.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

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
