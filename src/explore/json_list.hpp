/// Lists in JSON.
#pragma once

#include <string>
#include <vector>

#include "files/table_writer.hpp"

namespace tchat {

/// `text` gives the JSON of an element.
template <class List, class Text>
std::string json_list(const List& list, const Text& text) {
  std::string result;
  for (const auto& one : list) result += (result.empty() ? "" : ", ") + text(one);
  return "[" + result + "]";
}

inline std::string json_list(const std::vector<std::string>& texts) {
  return json_list(texts, [](const std::string& text) { return json_value(text); });
}

}  // namespace tchat
