#include "files/run_request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <string_view>
#include <vector>

#include "base/near_words.hpp"
#include "base/user_error.hpp"
#include "files/run_file_names.hpp"
#include "files/run_set.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

/// What -c could have meant: the constants that a run of this name has left, or constants files of like names.
std::string constants_meant(const fs::path& path) {
  if (const std::string used = output_path('r', path.string()); is_file(used))
    return fmt::format("the constants of the run {} are in {}: -c {}", path.string(), used, used);
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (const std::string name = at->path().filename().string(); name.starts_with(constants_prefix))
      names.push_back(name.substr(constants_prefix.size()));
  const std::vector<std::string> near = near_words(path.filename().string(), names);
  if (!near.empty()) return fmt::format("did you mean {}?", fmt::join(near, ", "));
  return fmt::format(
      "give its name with -c, let `tchat simulate {} --dat {}` write it with starting data, or write one "
      "(`tchat constants` explains what is in it)",
      path.filename().string(), path.filename().string());
}

/// NAME/NAME where NAME is a folder, as `tchat new NAME` makes it; else NAME.
fs::path in_own_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) ? path / path.filename() : path;
}

/// Removes a leading gc. from the name of the file.
fs::path without_prefix(const fs::path& path) {
  const std::string file = path.filename().string();
  return file.starts_with(constants_prefix) ? path.parent_path() / file.substr(constants_prefix.size()) : path;
}

}  // namespace

std::string own_constants_path(const std::string& name) {
  for (const std::string& path : {constants_file_of(name), constants_file_of(in_own_folder(name).string())})
    if (is_file(path)) return path;
  return "";
}

std::string constants_path(const std::string& c) {
  const fs::path path(c);
  if (const std::string own = own_constants_path(c); !own.empty()) return own;
  if (is_file(path)) return path.string();
  const fs::path name = without_prefix(path);
  const std::string file = constants_file_of(name.string());
  throw UserError(fmt::format("there is no constants file {}{}; {}", file, path == file ? "" : " or " + path.string(),
                              constants_meant(name)));
}

std::string constants_of_run(const std::optional<std::string>& given, const std::string& solutions) {
  if (given) return constants_path(*given);
  const std::string used = sibling_path(solutions, 'r');
  if (!used.empty() && is_file(used)) return used;
  if (const std::string made = constants_file_of(run_path(solutions)); is_file(made)) return made;
  throw UserError(fmt::format("there is no {} with the constants of the run that wrote {}; give them with -c C",
                              used.empty() ? "r-file" : used, solutions));
}

std::string data_path(const std::string& d) {
  const fs::path path(d);
  const fs::path with_suffix = d + ".dat";
  if (is_file(with_suffix)) return with_suffix.string();
  if (const std::string own = in_own_folder(path).string() + ".dat"; is_file(own)) return own;
  if (is_file(path)) return path.string();
  throw UserError(
      fmt::format("there is no starting data {} or {}; give its name with -d, or a q-file with -s and a "
                  "label with IRS=",
                  with_suffix.string(), path.string()));
}

std::string solution_path(const std::string& s) {
  const std::string prefixed = output_path('q', s);
  if (is_file(prefixed)) return prefixed;
  if (is_file(s)) return s;
  throw UserError(
      fmt::format("there is no q-file {} to restart from; give the name of an earlier run's output with -s", prefixed));
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

}  // namespace tchat
