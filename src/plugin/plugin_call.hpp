/// Marks which function of a plugin runs at the moment, so that what ends the process there can be laid at its door.
///
/// Two stores to one pointer for each call. Signal handlers and exit handlers can reach nothing but a global, and this
/// is the only one that they read about calls. Each thread has its own: a signal that a function causes, and the exit
/// handlers where one ends the process, run in the thread that called it.
#pragma once

#include <atomic>

namespace tchat {

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

}  // namespace tchat
