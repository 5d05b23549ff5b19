/// A plugin's table with every function behind a PluginCall, and with an end to exceptions.
///
/// A function that throws counts as one that cannot be evaluated: its results are NaN (of the index jump function: a
/// negative count). For user functions, which nothing else asks about, the exception's text is kept.
#pragma once

#include <string>

#include "tchat/problem.h"

namespace tchat {

class GuardedProblem {
 public:
  /// A copy of the table, what it points to outlives this object; `path` is what messages show.
  GuardedProblem(const tchat_problem& plugin, const std::string& path);
  GuardedProblem(const GuardedProblem&) = delete;
  GuardedProblem& operator=(const GuardedProblem&) = delete;
  ~GuardedProblem() = default;

  /// Lives as long as this object.
  const tchat_problem& table() const { return table_; }
  /// What user_value or output_parameters threw first; "" when they did not.
  const std::string& thrown() const { return thrown_; }

 private:
  struct Calls;

  tchat_problem plugin_;
  std::string path_;
  tchat_problem table_;
  mutable std::string thrown_;
};

}  // namespace tchat
