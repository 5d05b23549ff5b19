/// Folders in the build tree with results that several tests read: one computes them, the others find them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace test_support {

/// The files that are given or lie in folders that are given, without libraries in the latter, in a fixed order.
std::vector<std::filesystem::path> files_of(const std::vector<std::filesystem::path>& places);

/// A folder that belongs to this process until the object ends; others wait. It is another one for another tchat, for
/// other contents of the sources and for other words.
class KeptFolder {
 public:
  KeptFolder(const std::string& name, const std::vector<std::filesystem::path>& sources, const std::string& words = "");
  ~KeptFolder();
  KeptFolder(const KeptFolder&) = delete;
  KeptFolder& operator=(const KeptFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

/// All files below `from` with the times of their last change, which make looks at.
void copy_with_times(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace test_support
