/// The problem that the orbits of a q-file belong to: its plugin for event surfaces, and names of states and
/// parameters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "plugin/problem_library.hpp"

namespace tchat {

struct ProblemChoice {
  std::shared_ptr<ProblemLibrary> library;  ///< none when no plugin was named
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  std::string warning;

  const HybridSystem* system() const { return library ? &library->system() : nullptr; }
};

/// The plugin that the user named with -p. A picture compiles and runs nothing on its own account: without one the
/// names come from the header of p.NAME. Throws UserError when the plugin cannot be used, or has another dimension.
ProblemChoice find_problem(const std::string& solution_path, const std::string& plugin, int dimension);

}  // namespace tchat
