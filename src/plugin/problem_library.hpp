/// A plugin loaded into the process, and problems without events that a section makes ready for simulation.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/fortran_problem.hpp"
#include "tchat/problem.h"

namespace tchat {

// A problem whose motion nothing ends, with an event function that cuts it, for simulations.
//
// A problem of one field without jumps or without event functions has no index vector. Its sectioned problem has one
// more event function, h = x_1', which falls through zero at the maxima of the first state, one more jump, the
// identity, and an index jump function that always returns this index vector. Its own functions keep their numbers.

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

// A problem plugin loaded into the process.
//
// Owns the shared library (dlopen ... dlclose) and checks it when loading: it must be a shared library whose symbols
// resolve, and either export TCHAT_PROBLEM_ENTRY and return a table of this tchat's interface version, or export the
// subroutines of the Fortran interface (fortran_problem.hpp). Every failure is a UserError that names the path, what
// is wrong and the cure. As long as it is loaded, a plugin that ends the process is named (exit_guard.hpp).

class ProblemLibrary {
 public:
  /// Asked only when the plugin does not say its sizes itself; may throw.
  using Sizes = std::function<ProblemSizes()>;

  /// Loads the shared library at `path` (a file name, never searched for in library folders). Throws UserError.
  ///     const ProblemLibrary library(resolve_plugin(name), [&] { return problem_sizes(settings); });
  explicit ProblemLibrary(const std::string& path, const Sizes& sizes = {});
  /// A copy of its own, for another thread: its static data are not those of any other one, so that functions with
  /// memory (SAVE and COMMON in Fortran, static variables) are as safe as in a process of their own. Throws UserError,
  /// ComputationError.
  static std::unique_ptr<ProblemLibrary> copy_of(const std::string& path, const Sizes& sizes = {});

  /// The problem; a view that must not outlive this object.
  const HybridSystem& system() const { return system_; }
  const std::string& path() const { return path_; }
  /// From now on system() is the sectioned problem (SectionedProblem), if the problem lacks sections.
  void add_section();
  bool has_added_section() const { return sectioned_ != nullptr; }
  /// What of the derivatives is a finite difference, for the d-file; empty when all are exact.
  std::vector<std::string> derivative_notes() const;
  /// What a function that is called for output only has thrown: one sentence with the cure; "" when none did.
  std::string complaint() const;

 private:
  ProblemLibrary(const std::string& path, const std::string& file, const Sizes& sizes);

  struct Close {
    std::string path;
    void operator()(void* handle) const;
  };

  std::string path_;
  ExitGuard guard_;  // outlives the library, whose destructors may end the process
  std::unique_ptr<void, Close> handle_;
  std::unique_ptr<FortranProblem> fortran_;  // empty: the library has a table of its own
  std::unique_ptr<GuardedProblem> problem_;
  std::unique_ptr<SectionedProblem> sectioned_;  // empty: the problem as it is
  HybridSystem system_;
};

/// Does a shared library have data that the loader makes one for all copies of it (symbols of the kind "unique", g++
/// without -fno-gnu-unique)? False when the file cannot be read.
bool shares_data_of_copies(const std::string& path);

}  // namespace tchat
