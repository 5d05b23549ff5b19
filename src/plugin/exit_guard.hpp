/// Catches a plugin that ends the process: names it, says where it was, and makes it status 2.
///
/// While an ExitGuard lives, these are caught, from a plugin's function (plugin_call.hpp) or from a thread that the
/// plugin started:
///   - exit, quick_exit (STOP in Fortran), and from a function _exit and _Exit, which the program defines itself so
///   that
///     a plugin's call of them comes here;
///   - a signal that the plugin caused: invalid memory, a full stack, an integer divided by zero, abort (CALL ABORT, an
///     exception that nobody catches), and the like.
/// The message is written without allocation, open C and C++ streams are flushed where that is safe, and the process
/// ends with status 2. A signal that tchat's own code caused is told as such and ends the process as usual; signals
/// sent by others are left alone.
///
/// ProblemLibrary holds a guard as long as the plugin is loaded. Guards may be destroyed in any order; the youngest one
/// names the plugin. They are made and destroyed by one thread; others that call plugins give their handlers a stack
/// (SignalStack), without which a full stack ends the process untold.
///
/// The process has one list of exit handlers and one table of signal handlers, so what they read has to be global: it
/// is all in exit_guard.cpp and plugin_call.hpp.
#pragma once

#include <list>
#include <string>
#include <vector>

namespace tchat {

class ExitGuard {
 public:
  /// `plugin` is the path or name that the message shows.
  explicit ExitGuard(const std::string& plugin);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

 private:
  std::list<std::string>::iterator name_;
};

/// The stack of signal handlers of the thread that makes it, while it lives.
class SignalStack {
 public:
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  std::vector<char> memory_;
};

/// What leave_process() does before the process ends, in the process that loaded the plugin: the youngest one that
/// lives acts. It runs in a signal handler, perhaps in the middle of anything else, and must be safe there.
class LastAct {
 public:
  LastAct();
  LastAct(const LastAct&) = delete;
  LastAct& operator=(const LastAct&) = delete;
  virtual ~LastAct();
  virtual void act() noexcept = 0;

 private:
  LastAct* before_;
};

/// Ends the process at once, without exit handlers, flushing and messages, after a LastAct. Safe in a signal handler.
[[noreturn]] void leave_process(int status) noexcept;

}  // namespace tchat
