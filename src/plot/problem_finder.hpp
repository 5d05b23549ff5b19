/// The problem that the orbits of a q-file belong to: its plugin for event surfaces, and names of states and
/// parameters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hybrid/hybrid_system.hpp"
#include "plugin/problem_library.hpp"

namespace tchat {

struct ProblemChoice {
  std::shared_ptr<ProblemLibrary> library;  ///< none when no plugin was found
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  std::string warning;

  const HybridSystem* system() const { return library ? &library->system() : nullptr; }
};

/// The plugin that the user named; else NAME of q.NAME, in its folder or in the current one; else the only plugin of
/// the folder. A plugin found in these ways that cannot be used, or has another dimension, is passed over. Without a
/// plugin the names come from the header of p.NAME. Throws UserError when the plugin that the user named cannot be
/// used.
ProblemChoice find_problem(const std::string& solution_path, const std::string& plugin, int dimension);

}  // namespace tchat
