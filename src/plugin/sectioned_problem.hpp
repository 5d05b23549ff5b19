/// A problem whose motion nothing ends, with an event function that cuts it, for simulations.
///
/// A problem of one field without jumps or without event functions has no index vector. Its sectioned problem has one
/// more event function, h = x_1', which falls through zero at the maxima of the first state, one more jump, the
/// identity, and an index jump function that always returns this index vector. Its own functions keep their numbers.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "tchat/problem.h"

namespace tchat {

/// Has the problem one field, and no segment that could end?
bool lacks_sections(const HybridSystem& system);

class SectionedProblem {
 public:
  /// `plain` outlives this object.
  explicit SectionedProblem(const tchat_problem& plain);
  SectionedProblem(const SectionedProblem&) = delete;
  SectionedProblem& operator=(const SectionedProblem&) = delete;
  ~SectionedProblem() = default;

  /// Lives as long as this object. It has what simulations evaluate, first derivatives at most.
  const tchat_problem& table() const { return table_; }

 private:
  struct Calls;

  tchat_problem plain_;
  tchat_problem table_;
  std::vector<std::string> names_;  // of event functions, then of jumps
  std::vector<const char*> event_names_, jump_names_;
};

}  // namespace tchat
