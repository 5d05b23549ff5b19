/// What a plugin was compiled from, written behind the shared library's own contents.
///
/// A loader ignores bytes behind an ELF file, so library and stamp are one file and change together in one rename.
/// The stamp holds the compiler's identity, the files that the compiler read (source, interface, the user's headers;
/// system headers left out) and a hash of their contents.
///
/// Files are written down by their place, not by their path: a copy of a folder has its own sources. What was reached
/// from the source's folder belongs to that folder wherever it goes, tchat's headers belong to the tchat that asks,
/// and only other files (a folder given with -I) stand where they stood.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

/// The two folders that files are found from.
struct BuildPlaces {
  std::string source_folder;   ///< absolute
  std::string include_folder;  ///< absolute, the one with tchat/problem.hpp
};

/// A file that was read, by its place.
struct BuildInput {
  enum class Root : char { source = 's', interface = 't', elsewhere = '/' };
  Root root = Root::elsewhere;
  std::string path;  ///< below the root; absolute for elsewhere

  std::string found_from(const BuildPlaces& places) const;
};

struct BuildStamp {
  std::string compiler;           ///< hash of the compiler's identity
  std::string contents;           ///< hash of the contents of `files`
  std::vector<BuildInput> files;  ///< every file that was read; empty: the stamp cannot be trusted
};

/// Where a file belongs, from the path that the compiler used for it.
BuildInput place_of(const std::string& file, const BuildPlaces& places);

/// Hash of a text, 16 hexadecimal digits.
std::string hash_text(const std::string& text);
/// Hash of the places and contents of files; different when one cannot be read.
std::string hash_files(const std::vector<BuildInput>& files, const BuildPlaces& places);

/// The prerequisites of the rules that a compiler wrote with -MMD, absolute.
std::vector<std::string> read_dependencies(const std::string& path);

/// Adds the stamp to a library. False when the file cannot be written.
bool append_stamp(const std::string& library, const BuildStamp& stamp);
/// The stamp of a library; nothing when it has none (it was not compiled by tchat). Without files when another version
/// of tchat wrote it.
std::optional<BuildStamp> read_stamp(const std::string& library);

}  // namespace tchat
