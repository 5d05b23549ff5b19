/// Marks which function of a plugin runs at the moment, so that what ends the process there can be laid at its door.
///
/// Two stores to one pointer for each call. Signal handlers and exit handlers can reach nothing but a global, and this
/// is the only one that they read about calls. Only tchat's own thread calls plugins.
#pragma once

#include <atomic>

namespace tchat {

class PluginCall {
 public:
  /// `plugin`, its path, and `where`, as "in field", outlive the object; index 0: there is only one such function.
  PluginCall(const char* plugin, const char* where, int index = 0) noexcept
      : plugin_(plugin), where_(where), index_(index), outer_(running_.load(std::memory_order_relaxed)) {
    running_.store(this, std::memory_order_release);
  }
  ~PluginCall() { running_.store(outer_, std::memory_order_release); }
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

  /// The call that runs, null when none does. Safe in a signal handler.
  static const PluginCall* running() noexcept { return running_.load(std::memory_order_acquire); }

  const char* plugin() const { return plugin_; }
  const char* where() const { return where_; }
  int index() const { return index_; }

 private:
  static inline std::atomic<const PluginCall*> running_ = nullptr;

  const char* plugin_;
  const char* where_;
  int index_;
  const PluginCall* outer_;
};

}  // namespace tchat
