#include "plugin/exit_guard.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace tchat {

namespace {

/// Name of the plugin whose code may be running; empty when none may. Never destroyed: exit handlers run among the
/// destructors of static objects.
std::string& armed_plugin() {
  static std::string& name = *new std::string;
  return name;
}

void leave_if_armed() {
  if (armed_plugin().empty()) return;
  std::cout.flush();
  fmt::print(stderr,
             "tchat: the plugin {} ended the process (by exit, or STOP in Fortran).\n"
             "  A problem's functions must always return; where one cannot be evaluated it returns NaN.\n",
             armed_plugin());
  std::fflush(nullptr);
  _exit(2);
}

/// The handler is registered once per process and stays.
void register_handler() {
  static const bool registered = [] {
    const bool at_exit = std::atexit(leave_if_armed) == 0;
    const bool at_quick_exit = std::at_quick_exit(leave_if_armed) == 0;
    return at_exit && at_quick_exit;
  }();
  static_cast<void>(registered);
}

}  // namespace

ExitGuard::ExitGuard(const std::string& plugin) : outer_(armed_plugin()) {
  register_handler();
  armed_plugin() = plugin.empty() ? "(unnamed)" : plugin;
}

ExitGuard::~ExitGuard() { armed_plugin() = outer_; }

}  // namespace tchat
