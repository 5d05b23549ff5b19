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
  const fs::path given = fs::path(constants).parent_path();
  if (!path.is_absolute() && given.empty()) return problem;
  const fs::path folder = fs::absolute(given.empty() ? "." : given).lexically_normal();
  const fs::path place = fs::absolute(path).lexically_normal();
  const bool share_a_folder = std::next(place.begin()) != place.end() && std::next(folder.begin()) != folder.end() &&
                              *std::next(place.begin()) == *std::next(folder.begin());
  return !path.is_absolute() || share_a_folder ? place.lexically_proximate(folder).string() : problem;
}

}  // namespace tchat
