#include "files/block_write.hpp"

#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

namespace tchat {

namespace {

/// Size of an ordinary file; -1 for devices and pipes, which cannot be cut.
off_t ordinary_size(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return -1;
  return status.st_size;
}

bool in_one_page(off_t begin, std::size_t size) {
  const auto page = static_cast<off_t>(::sysconf(_SC_PAGESIZE));
  return begin / page == (begin + static_cast<off_t>(size) - 1) / page;
}

struct Block {
  int descriptor;
  std::string_view text;
};

// The outcome as an exit status: errno in seven bits, and whether a part is left.
constexpr int largest_error = 127;
constexpr int part_left = 128;

/// In the writing process: nothing but system calls. A process group of its own keeps it out of the reach of a signal
/// to the group of the run.
int write_and_end(void* argument) {
  const Block& block = *static_cast<const Block*>(argument);
  ::setpgid(0, 0);
  const BlockOutcome outcome = append_block(block.descriptor, block.text);
  const int error = outcome.error > largest_error ? EIO : outcome.error;
  return error + (outcome.whole ? 0 : part_left);
}

/// Signals wait while one lives; the child has their mask.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

/// Keeps this thread, and what it starts, where it runs: on another processor, which may sleep, a child begins so late
/// that waiting for it takes several times as long as what it does.
class OnThisProcessor {
 public:
  OnThisProcessor() {
    const int here = ::sched_getcpu();
    if (here < 0 || here >= CPU_SETSIZE || ::sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(here, &only);
    kept_ = ::sched_setaffinity(0, sizeof only, &only) == 0;
  }
  ~OnThisProcessor() {
    if (!kept_ || ::sched_setaffinity(0, sizeof before_, &before_) == 0) return;
    // None of those before is left to this process: all that there are.
    std::memset(&before_, 0xff, sizeof before_);
    ::sched_setaffinity(0, sizeof before_, &before_);
  }
  OnThisProcessor(const OnThisProcessor&) = delete;
  OnThisProcessor& operator=(const OnThisProcessor&) = delete;

 private:
  cpu_set_t before_{};
  bool kept_ = false;
};

}  // namespace

BlockOutcome append_block(int descriptor, std::string_view block) {
  const off_t before = ordinary_size(descriptor);
  while (!block.empty()) {
    const ssize_t written = ::write(descriptor, block.data(), block.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = written < 0 ? errno : ENOSPC;
      return {error, before < 0 || ::ftruncate(descriptor, before) == 0};
    }
    block.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

BlockOutcome append_block_through_kill(int descriptor, std::string_view block) {
  const off_t before = ordinary_size(descriptor);
  if (block.empty() || before < 0 || in_one_page(before, block.size())) return append_block(descriptor, block);

  constexpr std::size_t stack_size = 65536;
  const auto stack = std::make_unique<std::byte[]>(stack_size);
  Block task{descriptor, block};
  const BlockedSignals blocked;
  const OnThisProcessor kept_here;
  // Without a signal at its end no handler of SIGCHLD hears of it; this process goes on when it has ended.
  const pid_t writer = ::clone(&write_and_end, stack.get() + stack_size, CLONE_VM | CLONE_VFORK, &task);
  if (writer < 0) return append_block(descriptor, block);
  int status = 0;
  while (::waitpid(writer, &status, __WALL) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status)) return {EINTR, false};
  return {WEXITSTATUS(status) & largest_error, (WEXITSTATUS(status) & part_left) == 0};
}

}  // namespace tchat
