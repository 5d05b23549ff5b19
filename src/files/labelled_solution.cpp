#include "files/labelled_solution.hpp"

#include <algorithm>

namespace tchat {

std::string type_name(const LabelledSolution& solution) { return type_name(solution.type, solution.kind); }

std::vector<std::string> type_names(const LabelledSolution& solution) {
  return type_names(solution.type, solution.kind, solution.further);
}

std::vector<int> basic_types(const LabelledSolution& solution, const std::string& asked_for) {
  std::vector<int> types{basic_type(solution.type)};
  for (const UserPointKind& other : solution.further)
    types.push_back(other.kind == UserPointKind::other_type ? other.index : static_cast<int>(PointType::user));
  std::stable_partition(types.begin(), types.end(), [&](int type) { return type_name(type) == asked_for; });
  return types;
}

std::vector<UserPointKind> all_kinds(const LabelledSolution& solution) {
  std::vector<UserPointKind> kinds{solution.kind};
  kinds.insert(kinds.end(), solution.further.begin(), solution.further.end());
  return kinds;
}

std::string description(const LabelledSolution& solution, const std::function<std::string(int)>& parameter_name) {
  std::string text;
  for (const UserPointKind& kind : all_kinds(solution)) {
    const std::string what =
        description(kind, kind.kind == UserPointKind::user_value ? parameter_name(kind.index) : "");
    if (!what.empty()) text += (text.empty() ? "" : "; ") + what;
  }
  return text;
}

}  // namespace tchat
