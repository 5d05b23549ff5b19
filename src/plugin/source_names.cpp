#include "plugin/source_names.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include "base/text_file.hpp"
#include "plugin/formula_file.hpp"
#include "plugin/plugin_build.hpp"

namespace tchat {

namespace {

constexpr std::size_t longest_source = 1 << 20;  // bytes; a key has been pressed, and somebody waits

bool is_word(char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// The text with blanks in the place of comments.
std::string without_comments(std::string_view text) {
  std::string plain(text);
  char quote = '\0';
  for (std::size_t k = 0; k < plain.size(); ++k) {
    const char c = plain[k];
    if (quote != '\0') {
      if (c == '\\') ++k;
      if (c == quote || c == '\n') quote = '\0';
      continue;
    }
    if (c == '"' || c == '\'') quote = c;
    if (c != '/' || k + 1 == plain.size()) continue;
    const bool is_line = plain[k + 1] == '/';
    if (!is_line && plain[k + 1] != '*') continue;
    const std::size_t found = is_line ? plain.find('\n', k) : plain.find("*/", k + 2);
    const std::size_t end = found == std::string::npos ? plain.size() : found + (is_line ? 0 : 2);
    std::fill(plain.begin() + static_cast<std::ptrdiff_t>(k), plain.begin() + static_cast<std::ptrdiff_t>(end), ' ');
    k = end - 1;
  }
  return plain;
}

/// Behind the identifier `word`; npos when the text does not have it.
std::size_t find_behind(const std::string& text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end]))) return end;
  }
  return std::string::npos;
}

/// A name that can be typed: no blanks, quotes, backslashes or control characters.
bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isgraph(static_cast<unsigned char>(c)) != 0 && c != '"' && c != '\'' && c != '\\';
  });
}

std::vector<std::string> parameter_names_in_formulas(std::string_view text) {
  formulas::FormulaErrors mistakes;
  std::vector<std::string> names;
  for (const formulas::Assignment& parameter : formulas::read_formula_file(text, mistakes).parameters)
    names.push_back(parameter.name.text);
  return names;
}

}  // namespace

std::vector<std::string> parameter_names_in_cpp(std::string_view text) {
  const std::string plain = without_comments(text);
  std::size_t at = find_behind(plain, "parameter_names");
  if (at == std::string::npos) return {};
  at = plain.find_first_not_of("[]0123456789 \t\r\n=", at);
  std::vector<std::string> names;
  while (at != std::string::npos && plain[at] != '}') {
    if (plain[at] == '"') {
      const std::size_t end = plain.find('"', at + 1);
      if (end == std::string::npos) return {};
      names.push_back(plain.substr(at + 1, end - at - 1));
      if (!is_plain(names.back())) return {};
      at = end;
    } else if (plain[at] != '{' && plain[at] != ',') {
      return {};
    }
    at = plain.find_first_not_of(" \t\r\n", at + 1);
  }
  return names;
}

std::vector<std::string> parameter_names_in_source(const std::string& name_or_path) {
  const std::string source = source_of(name_or_path);
  if (source.empty()) return {};
  const std::string text = read_text_if_there(source, "source of the plugin", longest_source).value_or("");
  return formulas_of(source) ? parameter_names_in_formulas(text) : parameter_names_in_cpp(text);
}

}  // namespace tchat
