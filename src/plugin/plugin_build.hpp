/// From what the user names to a shared library: P.so as it is, or sources that are compiled.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "base/words.hpp"
#include "plugin/compiler.hpp"

namespace tchat {

// Which files a Fortran source includes: what its library depends on, and whether its own header NAME.h is missing.
//
// gfortran cannot list INCLUDE lines as it can #include (unless it preprocesses the source, which alters old sources),
// so they are read here.

struct FortranFiles {
  std::vector<std::string> found;  ///< absolute: the source, then what it includes, directly or not
  std::string own_header;          ///< "NAME.h" for NAME.f
  bool lacks_own_header = false;   ///< it is included, but nowhere: TC-HAT's sources include an empty one
};

/// Follows INCLUDE 'file' lines; a file is looked for in the folder of the file that includes it, then in `folders`.
FortranFiles fortran_files(const std::string& source, const std::vector<std::string>& folders);

// From what the user names to a shared library that can be loaded: P.so as it is, or P.cpp, P.f, P.tch compiled when
// needed.
//
// Searching order for P, which may contain folders (dir/P):
//   1. P ends in .so: that file as it is.
//   2. P ends in .cpp, .cc, .cxx, .f90 (Fortran, free form), .f or .for (fixed form): that source; the library is the
//      same name with .so. P ends in .tch: these formulas, translated to C++; the library is P.tch.so.
//   3. otherwise P with one of these endings, in this order, then P.so; then the same in the folder P: P/P.cpp, ...
//
// A source is compiled when its library is missing, or when the source, a header that it includes (tchat's interface
// among them) or the compiler has changed since; in a copy of a folder the copy's own files count. The library is
// compiled to a temporary name under a lock and then renamed, so that several processes may ask for one plugin at the
// same time and none ever sees half a file. Where the source's folder cannot be written, the library goes to
// $XDG_CACHE_HOME/tchat, else ~/.cache/tchat.

/// Path of a shared library that is up to date. Throws UserError: nothing there under that name, no compiler, the
/// compiler's own message, no folder to write to.
std::string resolve_plugin(const std::string& name_or_path, const PluginBuildOptions& options = {});

/// The name or path of the problem: `given` with -p, else that of a run (its path without q.), where such a plugin
/// exists, else the one that the run's constants name (`recorded`).
std::string problem_of_run(const std::optional<std::string>& given, const std::string& run,
                           const std::optional<std::string>& recorded);

/// The plugin of that problem. Where the user has not named it and it is in another folder, a notice says which code is
/// compiled and run, before that happens. Throws like resolve_plugin.
std::string resolve_plugin_of_run(const std::optional<std::string>& given, const std::string& run,
                                  const std::optional<std::string>& recorded, std::ostream& notices);

/// The source that a name or path stands for, in the searching order above; "" when there is none.
std::string source_of(const std::string& name_or_path);

/// The user's files that decide what a problem is, as seen from the working folder: its source with all that it
/// includes, else the library. `library` is that of resolve_plugin().
std::vector<std::string> files_of_problem(const std::string& name_or_path, const std::string& library);

/// The words of `tchat run` that name the problem of a plugin: NAME, or NAME -p PATH where NAME alone does not find it.
Command problem_words(const std::string& plugin);

/// What a problem is called, and its plugin where that is not the one of this name.
struct NamedProblem {
  std::string name;
  std::optional<std::string> plugin;
};

/// "dir/ball.tch", an existing source where a problem's name is asked for, means the problem "dir/ball" with this
/// plugin; any other text is a name.
NamedProblem named_problem(const std::string& given);

/// The file of formulas that a plugin's name or path stands for; nothing when it is another source, or none.
std::optional<std::string> formulas_of(const std::string& name_or_path);

}  // namespace tchat
