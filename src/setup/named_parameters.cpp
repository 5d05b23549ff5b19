#include "setup/named_parameters.hpp"

#include <map>
#include <memory>
#include <string>

#include "hybrid/parameter_vector.hpp"
#include "setup/problem_setup.hpp"

namespace tchat {

ParameterNames names_to_come(bool& used) {
  const auto seen = std::make_shared<std::map<std::string, int>>();
  return [&used, seen](const std::string& name, const std::string&) {
    used = true;
    return seen->emplace(name, parameter_length - static_cast<int>(seen->size())).first->second;
  };
}

ParameterNames names_of(const HybridSystem& system) {
  return [&system](const std::string& name, const std::string& where) { return parameter_index(system, name, where); };
}

}  // namespace tchat
