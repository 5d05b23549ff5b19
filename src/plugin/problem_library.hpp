/// A problem plugin loaded into the process.
///
/// Owns the shared library (dlopen ... dlclose) and checks it when loading: it must be a shared library whose symbols
/// resolve, export TCHAT_PROBLEM_ENTRY, and return a table of this tchat's interface version. Every failure is a
/// UserError that names the path, what is wrong and the cure.
#pragma once

#include <memory>
#include <string>

#include "hybrid/hybrid_system.hpp"

namespace tchat {

class ProblemLibrary {
 public:
  /// Loads the shared library at `path` (a file name, never searched for in library folders). Throws UserError.
  explicit ProblemLibrary(const std::string& path);

  /// The problem; a view that must not outlive this object.
  const HybridSystem& system() const { return system_; }
  const std::string& path() const { return path_; }

 private:
  struct Close {
    void operator()(void* handle) const;
  };

  std::string path_;
  std::unique_ptr<void, Close> handle_;
  HybridSystem system_;
};

}  // namespace tchat
