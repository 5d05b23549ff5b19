/// The C++ or Fortran compiler that turns a plugin's source into a shared library, as a process of its own.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "plugin/compiler_process.hpp"

namespace tchat {

struct PluginBuildOptions {
  std::string compiler = {};          ///< command, with arguments if any; empty: $CXX, else c++
  std::string include_folder = {};    ///< folder with tchat/problem.hpp; empty: see find_include_folder
  std::string fortran_compiler = {};  ///< empty: $FC, else gfortran
  std::ostream* progress = nullptr;   ///< a terminal on which a compilation is told; null: none
};

enum class Language { cpp, fortran, formulas };  // formulas are translated to C++

/// What is compiled, and to what.
struct Compilation {
  std::string source;
  std::string library;              ///< the shared library
  std::string include_folder = {};  ///< with tchat/problem.hpp, tchat/gccont.h
  std::string dependencies;         ///< C++: the files read, system headers left out, are listed here as make rules
  std::string scratch_folder;       ///< Fortran: module files are put here, and includes are also looked for here
};

class Compiler {
 public:
  Compiler(const PluginBuildOptions& options, Language language);

  /// The command's words, without a source.
  const std::vector<std::string>& command() const { return command_; }
  /// Text that changes when the compiler does (command, resolved programs, their sizes and times), or the instructions
  /// of this processor that it may use; empty when the compiler is not installed.
  std::string identity() const;

  /// Throws UserError with the compiler's own message.
  void compile(const Compilation& what) const;

 private:
  std::vector<std::string> options(const Compilation& what, bool is_gnu) const;
  ProcessResult compile_with(std::vector<std::string> words, const Compilation& what,
                             const std::vector<std::string>& precompiled) const;
  std::string instructions() const;

  Language language_;
  std::vector<std::string> command_;
};

/// The folder with tchat/problem.hpp: the one of the options, $TCHAT_INCLUDE, ../include beside the running program's
/// folder (installed), or the source tree that tchat was built from. Throws UserError when there is none.
std::string find_include_folder(const PluginBuildOptions& options);

}  // namespace tchat
