/// Catches a plugin that ends the process (exit, STOP in Fortran): names it and turns the exit into status 2.
///
/// While an ExitGuard lives, an exit() of the process prints a message to standard error, flushes the open C and C++
/// streams and leaves with status 2. Hold one wherever a plugin's code may run, and let it go out of scope before
/// main returns: the ordinary end of the program is then untouched. Guards nest; the innermost one names the plugin.
/// _exit, abort and signals are not caught.
///
/// The process has one list of exit handlers, so what the handler reads has to be global: it is all in exit_guard.cpp.
#pragma once

#include <string>

namespace tchat {

class ExitGuard {
 public:
  /// `plugin` is the path or name that the message shows.
  explicit ExitGuard(const std::string& plugin);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

 private:
  std::string outer_;  // the name that an enclosing guard had armed
};

}  // namespace tchat
