/// The C++ compiler that turns a plugin's source into a shared library, as a process of its own.
#pragma once

#include <string>
#include <vector>

namespace tchat {

struct PluginBuildOptions {
  std::string compiler;        ///< command, with arguments if any; empty: $CXX, else c++
  std::string include_folder;  ///< folder with tchat/problem.hpp; empty: see find_include_folder
};

class Compiler {
 public:
  explicit Compiler(const PluginBuildOptions& options);

  /// The command's words, without a source.
  const std::vector<std::string>& command() const { return command_; }
  /// Text that changes when the compiler does (command, resolved programs, their sizes and times); empty when the
  /// compiler is not installed.
  std::string identity() const;

  /// Compiles `source` to the shared library `library` and lists the files it read, system headers left out, as make
  /// rules in `dependencies`. Throws UserError with the compiler's own message.
  void compile(const std::string& source, const std::string& library, const std::string& dependencies,
               const std::string& include_folder) const;

 private:
  std::vector<std::string> command_;
};

/// The folder with tchat/problem.hpp: the one of the options, $TCHAT_INCLUDE, ../include beside the running program's
/// folder (installed), or the source tree that tchat was built from. Throws UserError when there is none.
std::string find_include_folder(const PluginBuildOptions& options);

}  // namespace tchat
