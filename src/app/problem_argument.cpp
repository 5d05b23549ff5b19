#include "app/problem_argument.hpp"

#include "plugin/plugin_build.hpp"

namespace tchat {

void take_source_as_problem(std::string& name, std::optional<std::string>& plugin) {
  const NamedProblem named = named_problem(name);
  name = named.name;
  if (!plugin) plugin = named.plugin;
}

}  // namespace tchat
