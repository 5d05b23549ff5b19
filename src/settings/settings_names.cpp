#include "settings/settings_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "base/user_error.hpp"
#include "settings/constants_table.hpp"
#include "settings/settings_check.hpp"

namespace tchat {

namespace {

/// Of a monitor that is named for the first time the next one. Blanks in names would separate values in files.
int monitor_index(RunSettings& settings, std::string name, const std::string& where) {
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t'; });
  std::vector<std::string>& list = settings.monitors;
  const auto known = std::find(list.begin(), list.end(), name);
  const auto index = static_cast<int>(known - list.begin());
  if (known != list.end()) return first_monitor(settings) + index;
  if (index == max_monitors) throw UserError(fmt::format("{}: more than {} monitors are named", where, max_monitors));
  list.push_back(name);
  return first_monitor(settings) + index;
}

int index_of(RunSettings& settings, const GivenName& name, const ParameterNames& names) {
  const std::string where =
      fmt::format("{}: {} ({})", name.place.text(), name.keyword, find_constant(name.keyword)->meaning);
  const int index = names(name.text, where);
  return index == names_a_monitor ? monitor_index(settings, name.text, where) : index;
}

}  // namespace

void resolve_names(RunSettings& settings, const ParameterLayout& layout, const ParameterNames& names) {
  settings.layout = layout;
  std::vector<int> indices;
  for (const GivenName& name : settings.names) indices.push_back(index_of(settings, name, names));
  const auto resolve = [&](int& k) {
    if (is_name(settings, k)) k = indices[static_cast<std::size_t>(k - first_name)];
  };
  for (int& k : settings.free_parameters) resolve(k);
  for (IndexedValue& weight : settings.parameter_weights) resolve(weight.index);
  for (UserValue& value : settings.user_values) resolve(value.parameter);
  for (HeldValue& held : settings.held) resolve(held.parameter);
  for (BoundedValue& bounded : settings.bounds) resolve(bounded.parameter);
  settings.names.clear();
  const std::vector<GivenIndices> given = std::exchange(settings.unchecked, {});
  if (given.empty()) return;
  check_parameter_indices(settings, [&given](std::string_view keyword) {
    const auto found =
        std::find_if(given.begin(), given.end(), [&](const auto& each) { return each.keyword == keyword; });
    return found != given.end() ? found->place : Place{given.front().place.source};
  });
}

}  // namespace tchat
