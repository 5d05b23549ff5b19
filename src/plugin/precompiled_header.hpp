/// tchat/problem.hpp as g++ has read it, for the plugins that are compiled later: most of the time that a small one
/// takes goes into the headers.
///
/// It lies in the cache folder, one for each compiler, its options and the contents of the headers. g++ can take it
/// only before anything else of a source. So it is given to sources where system headers alone come before
/// `#include <tchat/problem.hpp>`, whose order has no meaning; what is compiled is the same.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tchat {

/// $XDG_CACHE_HOME/tchat, else ~/.cache/tchat; nothing where neither is known. It need not exist.
std::optional<std::filesystem::path> cache_folder();

/// Whether nothing but comments and system headers comes before tchat/problem.hpp in a source. A macro may change what
/// that means, and so may a header of the user.
bool can_come_first(const std::string& source);

class PrecompiledHeader {
 public:
  /// For a compiler of this identity, called with `command`: its words and options, without files.
  PrecompiledHeader(const std::string& identity, std::vector<std::string> command, const std::string& include_folder);

  /// Options for the compilation of this source: none where there is no header yet or the source cannot take it.
  std::vector<std::string> options_for(const std::string& source) const;
  /// Makes it where it is missing, the second time that it is asked for. Whatever is in the way of that is no fault:
  /// plugins are then compiled without.
  void make() const noexcept;
  /// One that the compiler cannot read.
  void remove() const noexcept;

 private:
  bool is_made() const;
  bool is_first_time() const;
  std::string header() const { return include_folder_ + "/tchat/problem.hpp"; }
  std::filesystem::path made() const { return folder_ / "tchat" / "problem.hpp.gch"; }

  std::vector<std::string> command_;
  std::string include_folder_;
  std::filesystem::path folder_;  // empty: no cache
};

}  // namespace tchat
