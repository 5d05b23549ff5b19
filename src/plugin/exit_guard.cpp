#include "plugin/exit_guard.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>

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

namespace tchat {

namespace {

const char* place_of(std::int32_t kind) {
  if (kind == TCHAT_FIELD) return "in field";
  if (kind == TCHAT_EVENT) return "in event function";
  return kind == TCHAT_JUMP ? "in jump" : "in the integrand of segment";
}

void set_nan(double* values, int count) { std::fill(values, values + count, NAN); }

/// The text of the exception that is being caught.
std::string caught_text() {
  try {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "no std::exception";
  }
}

}  // namespace

struct GuardedProblem::Calls {
  static const GuardedProblem& object(const void* self) { return *static_cast<const GuardedProblem*>(self); }

  /// A function of the table that is called with a kind and an index; `fail` sets what it would have computed.
  template <auto function, auto fail, class... Arguments>
  static void evaluate(const void* self, std::int32_t kind, std::int32_t index, Arguments... arguments) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), place_of(kind), index);
    try {
      (plugin.*function)(plugin.self, kind, index, arguments...);
    } catch (...) {
      fail(plugin, kind, arguments...);
    }
  }

  static void fail_value(const tchat_problem& plugin, std::int32_t kind, const double*, const double*, double* out) {
    set_nan(out, rows(plugin, kind));
  }

  static void fail_first(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                         const std::int32_t* active, std::int32_t count, double* out, double* dx, double* dp) {
    fail_points(plugin, kind, 1, x, par, active, count, out, dx, dp);
  }

  static void fail_second(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                          const std::int32_t* active, std::int32_t count, const double*, double* out, double* dx,
                          double* dp) {
    fail_points(plugin, kind, 1, x, par, active, count, out, dx, dp);
  }

  static void fail_third(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                         double* out) {
    fail_third_at_points(plugin, kind, 1, x, par, out);
  }

  static void fail_third_at_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points, const double*,
                                   const double*, double* out) {
    set_nan(out, points * 8 * rows(plugin, kind));
  }

  static void fail_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points, const double*,
                          const double*, const std::int32_t*, std::int32_t count, double* out, double* dx, double* dp) {
    const int numbers = points * rows(plugin, kind);
    set_nan(out, numbers);
    set_nan(dx, numbers * plugin.dimension);
    if (count > 0) set_nan(dp, numbers * count);
  }

  static void fail_lanes(const tchat_problem& plugin, std::int32_t kind, std::int32_t sets, const double* x,
                         const double* par, const std::int32_t* active, std::int32_t count, double* out, double* dx,
                         double* dp) {
    fail_points(plugin, kind, sets * TCHAT_POINTS_OF_SET, x, par, active, count, out, dx, dp);
  }

  static void fail_second_at_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points,
                                    std::int32_t directions, const double*, const double*, const std::int32_t*,
                                    std::int32_t count, const double*, const double*, const double*, double* out,
                                    double* gradient) {
    set_nan(out, points * directions * rows(plugin, kind));
    set_nan(gradient, points * (plugin.dimension + count));
  }

  static std::int32_t successors(const void* self, const std::int32_t from[3], const double* x, const double* par,
                                 std::int32_t* to, std::int32_t capacity) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the index jump function (successors)");
    try {
      return plugin.successors(plugin.self, from, x, par, to, capacity);
    } catch (...) {
      return -1;
    }
  }

  static void boundary(const void* self, std::int32_t segments, const double* starts, const double* ends,
                       const double* par, double* out) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the boundary conditions");
    try {
      plugin.boundary(plugin.self, segments, starts, ends, par, out);
    } catch (...) {
      set_nan(out, plugin.boundary_conditions);
    }
  }

  static void boundary_first(const void* self, std::int32_t segments, const double* starts, const double* ends,
                             const double* par, const std::int32_t* active, std::int32_t count, double* out,
                             double* dstarts, double* dends, double* dp) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the boundary conditions");
    try {
      plugin.boundary_first(plugin.self, segments, starts, ends, par, active, count, out, dstarts, dends, dp);
    } catch (...) {
      const int rows = plugin.boundary_conditions;
      set_nan(out, rows);
      set_nan(dstarts, rows * plugin.dimension * segments);
      set_nan(dends, rows * plugin.dimension * segments);
      if (count > 0) set_nan(dp, rows * count);
    }
  }

  static void user_value(const void* self, const double* x, const double* par, double* out) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the user functions (user_value)");
    try {
      plugin.user_value(plugin.self, x, par, out);
    } catch (...) {
      set_nan(out, plugin.user_values);
      note_thrown(self, "user_value");
    }
  }

  static void output_parameters(const void* self, std::int32_t segment, const double* x, double* par) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the output parameters (GCPVLS) of segment", segment);
    try {
      plugin.output_parameters(plugin.self, segment, x, par);
    } catch (...) {
      note_thrown(self, "output_parameters");
    }
  }

 private:
  static int rows(const tchat_problem& plugin, std::int32_t kind) {
    if (kind == TCHAT_EVENT) return 1;
    return kind == TCHAT_INTEGRAND ? plugin.integral_conditions : plugin.dimension;
  }

  static void note_thrown(const void* self, const char* function) {
    if (object(self).thrown_.empty()) object(self).thrown_ = std::string(function) + ": " + caught_text();
  }
};

GuardedProblem::GuardedProblem(const tchat_problem& plugin, const std::string& path)
    : plugin_(plugin), path_(path), table_(plugin) {
  table_.self = this;
  table_.value = &Calls::evaluate<&tchat_problem::value, &Calls::fail_value>;
  if (plugin.first != nullptr) table_.first = &Calls::evaluate<&tchat_problem::first, &Calls::fail_first>;
  if (plugin.second != nullptr) table_.second = &Calls::evaluate<&tchat_problem::second, &Calls::fail_second>;
  if (plugin.third != nullptr) table_.third = &Calls::evaluate<&tchat_problem::third, &Calls::fail_third>;
  if (plugin.third_at_points != nullptr)
    table_.third_at_points = &Calls::evaluate<&tchat_problem::third_at_points, &Calls::fail_third_at_points>;
  if (plugin.first_at_points != nullptr)
    table_.first_at_points = &Calls::evaluate<&tchat_problem::first_at_points, &Calls::fail_points>;
  if (plugin.first_in_lanes != nullptr)
    table_.first_in_lanes = &Calls::evaluate<&tchat_problem::first_in_lanes, &Calls::fail_lanes>;
  if (plugin.second_at_points != nullptr)
    table_.second_at_points = &Calls::evaluate<&tchat_problem::second_at_points, &Calls::fail_second_at_points>;
  if (plugin.boundary != nullptr) table_.boundary = &Calls::boundary;
  if (plugin.boundary_first != nullptr) table_.boundary_first = &Calls::boundary_first;
  if (plugin.successors != nullptr) table_.successors = &Calls::successors;
  if (plugin.user_value != nullptr) table_.user_value = &Calls::user_value;
  if (plugin.output_parameters != nullptr) table_.output_parameters = &Calls::output_parameters;
}

}  // namespace tchat
