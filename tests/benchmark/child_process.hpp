/// Other programs, run and measured.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tchat::benchmark {

struct ChildTimes {
  double wall = 0.0;            ///< seconds from its start to its end
  double processor = 0.0;       ///< seconds, of the system for it included
  double peak_mebibytes = 0.0;  ///< its largest resident size; 0 unless asked for, or where the system does not tell
};

/// Runs a program in a folder, one thread, its output in the file "output" there. The peak is read when the program
/// ends (ptrace): what the system reports afterwards counts the process that started it too. Throws std::runtime_error
/// when it does not end with status 0.
ChildTimes run_child(const std::vector<std::string>& command, const std::filesystem::path& folder,
                     bool with_peak = false);

/// A new folder of its own, removed with all that is in it.
class ScratchFolder {
 public:
  /// In `parent`; where that is empty the system's folder for temporary files.
  explicit ScratchFolder(const std::filesystem::path& parent = {});
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tchat::benchmark
