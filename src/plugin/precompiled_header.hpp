/// tchat/problem.hpp as g++ has read it, for the plugins that are compiled later: most of the time that a small one
/// takes goes into the headers.
///
/// It lies in the cache folder, one for each compiler, its options and the contents of the headers. g++ takes it where
/// `#include <tchat/problem.hpp>` comes before anything else of a source and reads the headers otherwise, so that what
/// is compiled is the same.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tchat {

/// $XDG_CACHE_HOME/tchat, else ~/.cache/tchat; nothing where neither is known. It need not exist.
std::optional<std::filesystem::path> cache_folder();

class PrecompiledHeader {
 public:
  /// For a compiler of this identity, called with `command`: its words and options, without files.
  PrecompiledHeader(const std::string& identity, std::vector<std::string> command, std::string include_folder);

  /// To be put before the folder of the headers with -I: "" where there is none yet.
  std::string folder() const;
  /// Makes it where it is missing, the second time that it is asked for. Whatever is in the way of that is no fault:
  /// plugins are then compiled without.
  void make() const noexcept;
  /// One that the compiler cannot read.
  void remove() const noexcept;

 private:
  bool is_first_time() const;
  std::string header() const { return include_folder_ + "/tchat/problem.hpp"; }
  std::filesystem::path made() const { return folder_ / "tchat" / "problem.hpp.gch"; }

  std::vector<std::string> command_;
  std::string include_folder_;
  std::filesystem::path folder_;  // empty: no cache
};

}  // namespace tchat
