#include "files/run_file_kind.hpp"

#include <algorithm>
#include <filesystem>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/point_file_reader.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

bool is_identifier(const std::string& line) {
  const auto words = split_words(line);
  return (words.size() == 12 || words.size() == 16) &&
         std::all_of(words.begin(), words.end(), [](std::string_view word) { return parse_integer(word).has_value(); });
}

RunFileKind kind_by_name(const std::string& name) {
  const auto is_one_of = [&name](const char* prefixes, const char* fort) {
    return name == fort ||
           (name.size() > 1 && name[1] == '.' && std::string(prefixes).find(name[0]) != std::string::npos);
  };
  if (is_one_of("d", "fort.9")) return RunFileKind::diagnostics;
  if (is_one_of("qs", "fort.8")) return RunFileKind::solutions;
  return is_one_of("pb", "fort.7") ? RunFileKind::points : RunFileKind::other;
}

}  // namespace

RunFileKind run_file_kind(const std::string& path) {
  TextLines file(path, "a file of a run");
  std::string line;
  file.next(line);
  if (is_identifier(line)) return RunFileKind::solutions;
  const RunFileKind named = kind_by_name(std::filesystem::path(path).filename().string());
  return named != RunFileKind::diagnostics && looks_like_point_file(line) ? RunFileKind::points : named;
}

}  // namespace tchat
