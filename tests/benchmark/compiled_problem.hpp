/// Problems as `tchat run` has them: plugins that tchat compiles for this machine, and loads.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"

namespace tchat::benchmark {

/// While it lives problems are kept, and those that it kept are then unloaded. One at a time: main's.
class CompiledProblems {
 public:
  CompiledProblems();
  ~CompiledProblems();
  CompiledProblems(const CompiledProblems&) = delete;
  CompiledProblems& operator=(const CompiledProblems&) = delete;
};

/// The problem of this C++ source; compiled when it is asked for first. Throws UserError.
const HybridSystem& compiled_problem(const std::string& source);

/// problems/NAME/NAME.cpp of the repository.
const HybridSystem& problem_of_repository(const std::string& name);

}  // namespace tchat::benchmark
