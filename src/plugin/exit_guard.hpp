/// Guards against plugins that end the process or throw: which function runs at the moment, and what is reported of its
/// end.
#pragma once

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "tchat/problem.h"

namespace tchat {

// Marks which function of a plugin runs at the moment, so that what ends the process there can be laid at its door.
//
// Two stores to one pointer for each call. Signal handlers and exit handlers can reach nothing but a global, and this
// is the only one that they read about calls. Each thread has its own: a signal that a function causes, and the exit
// handlers where one ends the process, run in the thread that called it.

class PluginCall {
 public:
  /// `plugin`, its path, and `where`, as "in field", outlive the object; index 0: there is only one such function.
  PluginCall(const char* plugin, const char* where, int index = 0) noexcept
      : plugin_(plugin), where_(where), index_(index), outer_(running_.load(std::memory_order_relaxed)) {
    running_.store(this, std::memory_order_release);
    calls_plugins_ = true;
  }
  ~PluginCall() { running_.store(outer_, std::memory_order_release); }
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

  /// The call that runs, null when none does. Safe in a signal handler.
  static const PluginCall* running() noexcept { return running_.load(std::memory_order_acquire); }

  /// Has this thread called a plugin? A thread that a plugin started has not.
  static bool in_calling_thread() noexcept { return calls_plugins_; }

  const char* plugin() const { return plugin_; }
  const char* where() const { return where_; }
  int index() const { return index_; }

 private:
  static inline thread_local std::atomic<const PluginCall*> running_ = nullptr;
  static inline thread_local bool calls_plugins_ = false;

  const char* plugin_;
  const char* where_;
  int index_;
  const PluginCall* outer_;
};

// A message put together in a signal handler: no allocation, no locks, one write at the end.

class SignalText {
 public:
  SignalText& operator<<(std::string_view text) noexcept {
    for (const char c : text)
      if (size_ < buffer_.size()) buffer_[size_++] = c;
    return *this;
  }
  SignalText& operator<<(int number) noexcept {
    if (number < 0) return *this << "-" << -number;
    if (number >= 10) *this << number / 10;
    const char digit = static_cast<char>('0' + number % 10);
    return *this << std::string_view(&digit, 1);
  }

  void print_to_standard_error() const noexcept {
    std::size_t written = 0;
    while (written < size_) {
      const ssize_t count = ::write(STDERR_FILENO, buffer_.data() + written, size_ - written);
      if (count <= 0) return;
      written += static_cast<std::size_t>(count);
    }
  }

 private:
  std::array<char, 2048> buffer_;
  std::size_t size_ = 0;
};

// Catches a plugin that ends the process: names it, says where it was, and makes it status 2.
//
// While an ExitGuard lives, these are caught, from a plugin's function (PluginCall) or from a thread that the
// plugin started:
//   - exit, quick_exit (STOP in Fortran), and from a function _exit and _Exit, which the program defines itself so
//   that
//     a plugin's call of them comes here;
//   - a signal that the plugin caused: invalid memory, a full stack, an integer divided by zero, abort (CALL ABORT, an
//     exception that nobody catches), and the like.
// The message is written without allocation, open C and C++ streams are flushed where that is safe, and the process
// ends with status 2. A signal that tchat's own code caused is told as such and ends the process as usual; signals
// sent by others are left alone.
//
// ProblemLibrary holds a guard as long as the plugin is loaded. Guards may be destroyed in any order; the youngest one
// names the plugin. They are made and destroyed by one thread; others that call plugins give their handlers a stack
// (SignalStack), without which a full stack ends the process untold.
//
// The process has one list of exit handlers and one table of signal handlers, so what they read has to be global: it
// is all in ExitGuard and PluginCall.

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

// A plugin's table with every function behind a PluginCall, and with an end to exceptions.
//
// A function that throws counts as one that cannot be evaluated: its results are NaN (of the index jump function: a
// negative count). For user functions, which nothing else asks about, the exception's text is kept.

class GuardedProblem {
 public:
  /// A copy of the table, what it points to outlives this object; `path` is what messages show.
  GuardedProblem(const tchat_problem& plugin, const std::string& path);
  GuardedProblem(const GuardedProblem&) = delete;
  GuardedProblem& operator=(const GuardedProblem&) = delete;
  ~GuardedProblem() = default;

  /// Lives as long as this object.
  const tchat_problem& table() const { return table_; }
  /// What user_value or output_parameters threw first; "" when they did not.
  const std::string& thrown() const { return thrown_; }

 private:
  struct Calls;

  tchat_problem plugin_;
  std::string path_;
  tchat_problem table_;
  mutable std::string thrown_;
};

}  // namespace tchat
