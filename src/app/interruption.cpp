#include "app/interruption.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <exception>
#include <iostream>
#include <optional>

#include "plugin/exit_guard.hpp"

namespace tchat {

namespace {

constexpr int shortest_patience = 5;  // seconds
constexpr double longest_patience = 3600.0;

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t caught_signal = 0;
volatile std::sig_atomic_t patience = shortest_patience;

[[noreturn]] void leave_at_once(const char* why) {
  SignalText text;
  text << "tchat: ended at once, " << why << "; the files hold what was complete before.\n";
  text.print_to_standard_error();
  leave_process(128 + static_cast<int>(caught_signal));
}

void install(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART | SA_ONSTACK;
  ::sigaction(signal, &action, nullptr);
}

void end_of_patience(int) { leave_at_once("the work at hand would not end"); }

void on_signal(int signal) {
  const bool second = caught_signal != 0;
  caught_signal = signal;
  if (second) leave_at_once("by a second signal");
  install(SIGALRM, &end_of_patience);
  ::alarm(static_cast<unsigned>(patience));
}

/// Has a signal come? Learns on the way how long the work goes between two questions.
class Question {
 public:
  bool operator()() {
    const Clock::time_point now = Clock::now();
    const double seconds = last_ ? 3.0 * std::chrono::duration<double>(now - *last_).count() : 0.0;
    last_ = now;
    if (seconds > static_cast<double>(patience))
      patience = static_cast<int>(std::ceil(std::min(seconds, longest_patience)));
    return caught_signal != 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> last_;
};

}  // namespace

int run_interruptibly(const std::function<int(const std::function<bool()>&)>& work) {
  install(SIGINT, &on_signal);
  install(SIGTERM, &on_signal);
  int status = 0;
  try {
    status = work(Question());
  } catch (const std::exception& error) {
    if (caught_signal == 0) throw;
    // The failure may be the signal's doing, such as that of a compiler that it ended too.
    std::cerr << "tchat: interrupted: " << error.what() << '\n';
  }
  if (caught_signal == 0) return status;
  return 128 + static_cast<int>(caught_signal);
}

}  // namespace tchat
