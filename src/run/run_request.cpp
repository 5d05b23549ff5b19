#include "run/run_request.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "constants/user_error.hpp"
#include "start/run_file_names.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

}  // namespace

std::string constants_path(const std::string& c) {
  const fs::path path(c);
  const fs::path prefixed = path.parent_path() / ("gc." + path.filename().string());
  if (is_file(prefixed)) return prefixed.string();
  if (is_file(path)) return path.string();
  throw UserError(
      fmt::format("there is no constants file {}{}; give its name with -c, or write one "
                  "(src/docs/constants.md)",
                  prefixed.string(), path == prefixed ? "" : " or " + path.string()));
}

std::string constants_of_run(const std::optional<std::string>& given, const std::string& solutions) {
  if (given) return constants_path(*given);
  const std::string used = sibling_path(solutions, 'r');
  if (!used.empty() && is_file(used)) return used;
  const fs::path made = fs::path(solutions).parent_path() / ("gc." + run_name(solutions));
  if (is_file(made)) return made.string();
  throw UserError(fmt::format("there is no {} with the constants of the run that wrote {}; give them with -c C",
                              used.empty() ? "r-file" : used, solutions));
}

std::string data_path(const std::string& d) {
  const fs::path path(d);
  const fs::path with_suffix = d + ".dat";
  if (is_file(with_suffix)) return with_suffix.string();
  if (is_file(path)) return path.string();
  throw UserError(
      fmt::format("there is no starting data {} or {}; give its name with -d, or a q-file with -s and a "
                  "label with IRS=",
                  with_suffix.string(), path.string()));
}

std::string default_solution_path(const std::string& s) {
  const fs::path path(s);
  return (path.parent_path() / ("q." + path.filename().string())).string();
}

std::string solution_path(const std::string& s) {
  const std::string prefixed = default_solution_path(s);
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
