/// Files that compiled plugins are built with: stamps of their sources, locks, and the precompiled problem header.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tchat {

// An exclusive lock between processes, held while this object lives: flock on a file that is removed afterwards. The
// file holds the number of the process that has the lock.

class FileLock {
 public:
  /// Waits for the lock at `path`, creating the file. `error()` tells when the file cannot be created; a file system
  /// without locks is taken as locked.
  explicit FileLock(const std::string& path);
  /// The same, but waits no longer than this for another process.
  FileLock(const std::string& path, std::chrono::milliseconds patience);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// errno of the attempt to create the lock file, 0 when the lock is held. EWOULDBLOCK: another process has it.
  int error() const { return error_; }
  /// Number of the other process, 0 when it is not known.
  int holder() const { return holder_; }

 private:
  bool try_once(bool wait);

  std::string path_;
  int descriptor_ = -1;
  int error_ = 0;
  int holder_ = 0;
};

// What a plugin was compiled from, written behind the shared library's own contents.
//
// A loader ignores bytes behind an ELF file, so library and stamp are one file and change together in one rename.
// The stamp holds the compiler's identity, the files that the compiler read (source, interface, the user's headers;
// system headers left out) and a hash of their contents.
//
// Files are written down by their place, not by their path: a copy of a folder has its own sources. What was reached
// from the source's folder belongs to that folder wherever it goes, tchat's headers belong to the tchat that asks,
// and only other files (a folder given with -I) stand where they stood.

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

// tchat/problem.hpp as g++ has read it, for the plugins that are compiled later: most of the time that a small one
// takes goes into the headers.
//
// It lies in the cache folder, one for each compiler, its options and the contents of the headers. g++ can take it
// only before anything else of a source. So it is given to sources where system headers alone come before
// `#include <tchat/problem.hpp>`, whose order has no meaning; what is compiled is the same.

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
