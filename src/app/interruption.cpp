#include "app/interruption.hpp"

#include <csignal>
#include <exception>
#include <iostream>

namespace tchat {

namespace {

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t caught_signal = 0;

void remember_signal(int signal) {
  caught_signal = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

int run_interruptibly(const std::function<int(const std::function<bool()>&)>& work) {
  std::signal(SIGINT, &remember_signal);
  std::signal(SIGTERM, &remember_signal);
  int status = 0;
  try {
    status = work([] { return caught_signal != 0; });
  } catch (const std::exception& error) {
    if (caught_signal == 0) throw;
    // The failure may be the signal's doing, such as that of a compiler that it ended too.
    std::cerr << "tchat: interrupted: " << error.what() << '\n';
  }
  if (caught_signal == 0) return status;
  return 128 + static_cast<int>(caught_signal);
}

}  // namespace tchat
