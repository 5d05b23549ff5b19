#include "plugin/fortran_source.hpp"

#include <strings.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/text_file.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// The file of a line "      INCLUDE 'file'", in any case and with either kind of quote.
std::optional<std::string> included_file(std::string_view line) {
  constexpr std::string_view word = "include";
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos || line.size() < begin + word.size()) return std::nullopt;
  line.remove_prefix(begin);
  if (strncasecmp(line.data(), word.data(), word.size()) != 0) return std::nullopt;
  const std::size_t open = line.find_first_not_of(" \t", word.size());
  if (open == std::string_view::npos || (line[open] != '\'' && line[open] != '"')) return std::nullopt;
  const std::size_t close = line.find(line[open], open + 1);
  if (close == std::string_view::npos) return std::nullopt;
  return std::string(line.substr(open + 1, close - open - 1));
}

std::optional<std::string> locate(const std::string& file, const fs::path& beside,
                                  const std::vector<std::string>& folders) {
  std::vector<fs::path> candidates = {beside / file};
  for (const std::string& folder : folders) candidates.push_back(fs::path(folder) / file);
  std::error_code failed;
  for (const fs::path& candidate : candidates)
    if (fs::is_regular_file(candidate, failed)) return fs::absolute(candidate).string();
  return std::nullopt;
}

}  // namespace

FortranFiles fortran_files(const std::string& source, const std::vector<std::string>& folders) {
  FortranFiles files;
  files.found.push_back(fs::absolute(source).string());
  files.own_header = fs::path(source).stem().string() + ".h";
  for (std::size_t k = 0; k < files.found.size(); ++k) {  // the list grows while it is read
    const fs::path folder = fs::path(files.found[k]).parent_path();
    TextLines in(files.found[k], "source of the plugin");
    for (std::string line; in.next(line);) {
      const std::optional<std::string> file = included_file(line);
      if (!file) continue;
      const std::optional<std::string> path = locate(*file, folder, folders);
      if (!path)
        files.lacks_own_header = files.lacks_own_header || *file == files.own_header;
      else if (std::find(files.found.begin(), files.found.end(), *path) == files.found.end())
        files.found.push_back(*path);
    }
  }
  return files;
}

}  // namespace tchat
