#include "files/run_file_names.hpp"

#include <filesystem>

namespace tchat {

namespace fs = std::filesystem;

std::string constants_file_of(const std::string& name) {
  const fs::path path(name);
  return (path.parent_path() / fs::path(constants_prefix).concat(path.filename().string())).string();
}

std::string sibling_path(const std::string& path, char letter) {
  const fs::path given(path);
  const std::string name = given.filename().string();
  const auto beside = [&given](const std::string& other) { return (given.parent_path() / other).string(); };
  if (name == "fort.7" || name == "fort.8" || name == "fort.9")
    return beside(letter == 'p' ? "fort.7" : letter == 'q' ? "fort.8" : letter == 'd' ? "fort.9" : "fort.2");
  if (name.size() < 3 || name[1] != '.') return "";
  const std::string rest = name.substr(1);
  const std::string ours = beside(letter + rest);
  std::error_code error;
  if (fs::is_regular_file(ours, error) || std::string("pqd").find(name[0]) != std::string::npos) return ours;
  if (letter == 'd' || letter == 'r') return ours;
  if (std::string("bs").find(name[0]) != std::string::npos) return beside((letter == 'p' ? "b" : "s") + rest);
  return "";
}

std::string resolve_run_file(const std::string& path, char letter) {
  const fs::path given(path);
  const fs::path prefixed = given.parent_path() / (std::string{letter, '.'} + given.filename().string());
  std::error_code error;
  return !fs::exists(given, error) && fs::exists(prefixed, error) ? prefixed.string() : path;
}

std::string run_name(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  const bool prefixed = name.size() > 2 && name[1] == '.' && std::string("pqdbs").find(name[0]) != std::string::npos;
  return prefixed ? name.substr(2) : name;
}

std::string run_path(const std::string& path) {
  return (std::filesystem::path(path).parent_path() / run_name(path)).string();
}

}  // namespace tchat
