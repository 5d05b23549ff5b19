#include "hybrid/index_vector.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hybrid/parameter_vector.hpp"
#include "text/number.hpp"
#include "text/user_error.hpp"
#include "text/words.hpp"

namespace tchat {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

[[noreturn]] void refuse(std::string_view text, const std::string& option, const std::string& found) {
  throw UserError(fmt::format(
      "{} {}: {}; allowed: index vectors field,event,jump of whole numbers from 1, separated by semicolons, for "
      "example {} \"1,2,1;2,1,2\"",
      option, in_quotes(text), found, option));
}

}  // namespace

std::string to_string(const Signature& signature) {
  std::string text = "{";
  for (const IndexVector& v : signature)
    text += fmt::format("{}({},{},{})", text.size() > 1 ? ", " : "", v.field, v.event, v.jump);
  return text + "}";
}

std::vector<IndexVector> parse_index_vectors(std::string_view text, const std::string& option) {
  std::string plain;  // "1,1,1;2,2,2;", whatever parentheses there were
  for (const char c : text)
    if (c == ')')
      plain += ';';
    else if (c != ' ' && c != '(' && c != '{' && c != '}')
      plain += c;
  std::vector<IndexVector> result;
  for (const std::string_view part : split(plain, ';')) {
    const std::string_view vector = part.starts_with(',') ? part.substr(1) : part;
    if (vector.empty()) continue;
    std::vector<int> numbers;
    for (const std::string_view word : split(vector, ',')) {
      const auto value = parse_integer(word);
      if (!value) refuse(text, option, fmt::format("found {}", in_quotes(word)));
      numbers.push_back(*value);
    }
    if (numbers.size() != 3)
      refuse(text, option, fmt::format("index vector {} has {} numbers", result.size() + 1, numbers.size()));
    result.push_back({numbers[0], numbers[1], numbers[2]});
  }
  if (result.empty()) refuse(text, option, "found no index vector");
  return result;
}

Signature parse_signature(std::string_view text, const std::string& option) {
  const Signature signature = parse_index_vectors(text, option);
  for (const IndexVector& v : signature)
    for (const int number : {v.field, v.event, v.jump})
      if (number < 1) refuse(text, option, fmt::format("found '{}'", number));
  if (signature.size() > static_cast<std::size_t>(max_segments))
    refuse(text, option, fmt::format("{} segments, at most {} are allowed", signature.size(), max_segments));
  return signature;
}

}  // namespace tchat
