#include "plugin/exit_guard.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "plugin/plugin_call.hpp"
#include "plugin/signal_text.hpp"

namespace tchat {

namespace {

constexpr int bad_input = 2;
constexpr std::size_t handler_stack_size = 1 << 16;

struct FatalSignal {
  int number;
  const char* text;
};
// Those that end a process unless it says otherwise; without those by which people and systems end programs (HUP, INT,
// TERM, KILL, PIPE, XCPU, XFSZ).
constexpr std::array<FatalSignal, 13> fatal_signals = {{
    {SIGSEGV, "SIGSEGV: memory that is not its own; an array overrun, or a pointer to nothing"},
    {SIGBUS, "SIGBUS: memory that is not there; was the library changed while it ran?"},
    {SIGFPE, "SIGFPE: an integer divided by zero"},
    {SIGILL, "SIGILL: an instruction that this processor does not have, or a place that must not be reached"},
    {SIGABRT, "SIGABRT: abort, or an exception that nobody catches"},
    {SIGTRAP, "SIGTRAP: a breakpoint"},
    {SIGSYS, "SIGSYS: a system call that does not exist"},
    {SIGALRM, "SIGALRM: an alarm"},
    {SIGVTALRM, "SIGVTALRM: an alarm"},
    {SIGPROF, "SIGPROF: a timer of a profiler"},
    {SIGUSR1, "SIGUSR1"},
    {SIGUSR2, "SIGUSR2"},
    {SIGSTKFLT, "SIGSTKFLT"},
}};

/// What the handlers know. Never destroyed: exit handlers run among the destructors of static objects.
struct Watch {
  std::list<std::string> plugins;             // the paths of the guards that live
  std::atomic<const char*> plugin = nullptr;  // of the youngest
  std::atomic<LastAct*> last_act = nullptr;
  pid_t process = 0;                             // children that a plugin forks are none of ours
  std::array<struct sigaction, 65> before = {};  // handlers that ours replaced, by signal
  std::array<char, handler_stack_size> stack;    // for handlers: a plugin's endless recursion leaves none
};

Watch& watch() {
  static Watch& state = *new Watch;
  return state;
}

// The lowest address that this thread's stack may grow to.
thread_local std::uintptr_t stack_end = 0;
thread_local bool is_ours = false;  // not started by a plugin

bool on_plugins_thread() { return !is_ours && !PluginCall::in_calling_thread(); }

SignalText& add_place(SignalText& text) {
  const PluginCall* const call = PluginCall::running();
  if (on_plugins_thread()) return text << " in a thread of its own";
  if (call == nullptr) return text;
  text << " " << call->where();
  return call->index() > 0 ? text << " " << call->index() : text;
}

const char* plugin_name() {
  const PluginCall* const call = PluginCall::running();
  return call != nullptr ? call->plugin() : watch().plugin.load();
}

void tell_end(const char* how) {
  SignalText text;
  text << "tchat: the plugin " << plugin_name() << " ended the process (by " << how << ")";
  add_place(text) << ".\n  A problem's functions must always return; where one cannot be evaluated it returns NaN.\n";
  text.print_to_standard_error();
}

bool is_armed() { return watch().plugin.load() != nullptr && ::getpid() == watch().process; }

void leave_if_armed() {
  if (!is_armed()) return;
  std::cout.flush();
  tell_end("exit, or STOP in Fortran");
  std::fflush(nullptr);
  leave_process(bad_input);
}

bool fills_stack(const siginfo_t& info) {
  constexpr std::uintptr_t above = 1 << 18;  // a frame's arrays may lie below what the stack has grown to
  constexpr std::uintptr_t below = 1 << 24;
  const auto address = reinterpret_cast<std::uintptr_t>(info.si_addr);
  return address < stack_end + above && address > stack_end - below;
}

const char* cause_of(const siginfo_t& info) {
  if (info.si_signo == SIGSEGV && info.si_code > 0 && fills_stack(info))
    return "SIGSEGV: the stack is full; endless recursion, or local arrays that are too large";
  for (const FatalSignal& signal : fatal_signals)
    if (signal.number == info.si_signo) return signal.text;
  return "";
}

void on_fatal_signal(int signal, siginfo_t* info, void*) {
  const bool sent = info->si_code == SI_USER || info->si_code == SI_TKILL || info->si_code == SI_QUEUE;
  const bool from_outside = sent && info->si_pid != ::getpid();
  const bool by_plugin = PluginCall::running() != nullptr || on_plugins_thread();
  if (!from_outside && is_armed()) {
    SignalText text;
    text << "tchat: ";
    if (by_plugin) {
      text << "the plugin " << plugin_name() << " died";
      add_place(text);
    } else {
      text << "internal error";
    }
    text << " by signal " << signal << " (" << cause_of(*info) << ").\n";
    if (by_plugin)
      text << "  Compiled with CXX='c++ -g -fsanitize=undefined' (Fortran: FC='gfortran -g -fcheck=all'), or run in a "
              "debugger, it tells the line.\n";
    else
      text << "  This happened outside of the functions of " << plugin_name()
           << ", but one of them may have written where it must not: valgrind tells.\n";
    text.print_to_standard_error();
    if (by_plugin) leave_process(bad_input);
  }
  ::sigaction(signal, &watch().before[static_cast<std::size_t>(signal)], nullptr);
  if (sent || info->si_code == SI_KERNEL) ::raise(signal);  // else what caused it happens again on return
}

void install_signal_handlers() {
  Watch& state = watch();
  struct rlimit limit {};
  const auto here = reinterpret_cast<std::uintptr_t>(&limit);
  const bool limited = ::getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  stack_end = limited && limit.rlim_cur < here ? here - limit.rlim_cur : 0;
  stack_t stack{};
  stack.ss_sp = state.stack.data();
  stack.ss_size = state.stack.size();
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_sigaction = &on_fatal_signal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (const FatalSignal& signal : fatal_signals)
    ::sigaction(signal.number, &action, &state.before[static_cast<std::size_t>(signal.number)]);
}

void restore_signal_handlers() {
  for (const FatalSignal& signal : fatal_signals)
    ::sigaction(signal.number, &watch().before[static_cast<std::size_t>(signal.number)], nullptr);
}

/// Exit handlers are registered once per process and stay.
void register_exit_handlers() {
  static const bool registered = [] {
    const bool at_exit = std::atexit(leave_if_armed) == 0;
    const bool at_quick_exit = std::at_quick_exit(leave_if_armed) == 0;
    return at_exit && at_quick_exit;
  }();
  static_cast<void>(registered);
}

}  // namespace

ExitGuard::ExitGuard(const std::string& plugin) {
  Watch& state = watch();  // before the handlers that use it: there may be no memory for it
  register_exit_handlers();
  if (state.plugins.empty()) install_signal_handlers();
  name_ = state.plugins.insert(state.plugins.end(), plugin.empty() ? "(unnamed)" : plugin);
  state.plugin = name_->c_str();
  state.process = ::getpid();
  is_ours = true;
}

ExitGuard::~ExitGuard() {
  Watch& state = watch();
  state.plugin = nullptr;
  state.plugins.erase(name_);
  if (state.plugins.empty())
    restore_signal_handlers();
  else
    state.plugin = state.plugins.back().c_str();
}

SignalStack::SignalStack() : memory_(handler_stack_size) {
  is_ours = true;
  stack_t stack{};
  stack.ss_sp = memory_.data();
  stack.ss_size = memory_.size();
  ::sigaltstack(&stack, nullptr);
  pthread_attr_t attributes;
  if (::pthread_getattr_np(::pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  std::size_t size = 0;
  if (::pthread_attr_getstack(&attributes, &lowest, &size) == 0) stack_end = reinterpret_cast<std::uintptr_t>(lowest);
  ::pthread_attr_destroy(&attributes);
}

SignalStack::~SignalStack() {
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  ::sigaltstack(&none, nullptr);
}

LastAct::LastAct() : before_(watch().last_act.exchange(this)) {}

LastAct::~LastAct() { watch().last_act = before_; }

void leave_process(int status) noexcept {
  // Taken away first: what it does may be interrupted, by a signal that ends the process too.
  LastAct* const last = ::getpid() == watch().process ? watch().last_act.exchange(nullptr) : nullptr;
  if (last != nullptr) last->act();
  while (true) ::syscall(SYS_exit_group, status);
}

namespace {

[[noreturn]] void leave_or_tell(int status) noexcept {
  if (PluginCall::running() != nullptr && is_armed()) {
    tell_end("_exit");
    leave_process(bad_input);
  }
  leave_process(status);
}

}  // namespace

}  // namespace tchat

// The C library's functions of these names are replaced for plugins, which look symbols up in the program first.
extern "C" {
__attribute__((visibility("default"))) void _exit(int status) { tchat::leave_or_tell(status); }
__attribute__((visibility("default"))) void _Exit(int status) noexcept { tchat::leave_or_tell(status); }
}
