/// What a plugin was compiled from, written behind the shared library's own contents.
///
/// A loader ignores bytes behind an ELF file, so library and stamp are one file and change together in one rename.
/// The stamp holds the compiler's identity, the files that the compiler read (source, interface, the user's headers;
/// system headers left out) and a hash of their contents.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

struct BuildStamp {
  std::string compiler;            ///< hash of the compiler's identity
  std::string contents;            ///< hash of the contents of `files`
  std::vector<std::string> files;  ///< every file that was read, absolute
};

/// Hash of a text, 16 hexadecimal digits.
std::string hash_text(const std::string& text);
/// Hash of the contents of files; different when one cannot be read.
std::string hash_files(const std::vector<std::string>& files);

/// The prerequisites of the rules that a compiler wrote with -MMD.
std::vector<std::string> read_dependencies(const std::string& path);

/// Adds the stamp to a library. False when the file cannot be written.
bool append_stamp(const std::string& library, const BuildStamp& stamp);
/// The stamp of a library; nothing when it has none (it was not compiled by tchat).
std::optional<BuildStamp> read_stamp(const std::string& library);

}  // namespace tchat
