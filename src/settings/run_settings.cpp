#include "settings/run_settings.hpp"

#include <filesystem>

namespace tchat {

namespace fs = std::filesystem;

std::optional<std::string> recorded_problem(const RunSettings& settings, const std::string& constants) {
  if (settings.problem.empty()) return std::nullopt;
  return (fs::path(constants).parent_path() / settings.problem).lexically_normal().string();
}

std::string problem_to_record(const std::string& problem, const std::string& constants) {
  const fs::path path(problem);
  const fs::path folder = fs::path(constants).parent_path();
  if (path.is_absolute() || folder.empty()) return problem;
  return fs::absolute(path).lexically_normal().lexically_proximate(fs::absolute(folder).lexically_normal()).string();
}

}  // namespace tchat
