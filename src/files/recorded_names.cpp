#include "files/recorded_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/user_error.hpp"
#include "files/point_file_reader.hpp"
#include "files/run_file_names.hpp"

namespace tchat {

namespace {

constexpr int most_names = 1000;

/// `most`: whatever number a file says.
std::vector<std::string> list_of(const std::map<int, std::string>& names, const char* symbol, int most) {
  std::vector<std::string> list;
  const int last = names.empty() ? 0 : std::min(names.rbegin()->first, most);
  for (int k = 1; k <= last; ++k) list.push_back(names.contains(k) ? names.at(k) : fmt::format("{}({})", symbol, k));
  return list;
}

}  // namespace

RecordedNames recorded_names(const std::string& solution_path) {
  std::error_code error;
  RecordedNames recorded;
  const std::string path = sibling_path(solution_path, 'p');
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return recorded;
  try {
    const PointFile file = read_point_file(path);
    const PointSection& section = file.sections.front();
    recorded.names.states = list_of(section.states, "U", most_names);
    recorded.names.parameters = list_of(section.parameters, "PAR", most_names + section.layout.parameters());
  } catch (const UserError&) {
    recorded.warning = fmt::format("{} cannot be read: names of states and parameters are left out", path);
  }
  return recorded;
}

}  // namespace tchat
