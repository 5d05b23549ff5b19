#include "published/kept_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <functional>
#include <sstream>

namespace test_support {

namespace fs = std::filesystem;

namespace {

std::size_t hash_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return std::hash<std::string>()(file.string() + text.str());
}

}  // namespace

std::vector<fs::path> files_of(const std::vector<fs::path>& places) {
  std::vector<fs::path> files;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place)) files.push_back(place);
    if (!fs::is_directory(place)) continue;  // there are no constants for a chain that begins with a simulation
    for (const auto& entry : fs::directory_iterator(place))
      if (entry.is_regular_file() && entry.path().extension() != ".so") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

KeptFolder::KeptFolder(const std::string& name, const std::vector<fs::path>& sources, const std::string& words) {
  std::size_t key = 31 * hash_of(TCHAT_EXECUTABLE) + std::hash<std::string>()(words);
  for (const fs::path& source : sources) key = 31 * key + hash_of(source);
  path_ = fs::path(KEPT_FOLDERS) / (name + "_" + std::to_string(key));
  fs::create_directories(path_);
  lock_ = open((path_.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  REQUIRE(lock_ >= 0);
  REQUIRE(flock(lock_, LOCK_EX) == 0);
}

KeptFolder::~KeptFolder() { close(lock_); }

void copy_with_times(const fs::path& from, const fs::path& to) {
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path target = to / entry.path().lexically_relative(from);
    if (entry.is_directory()) {
      fs::create_directories(target);
      continue;
    }
    fs::copy_file(entry.path(), target);
    fs::last_write_time(target, entry.last_write_time());
  }
}

}  // namespace test_support
