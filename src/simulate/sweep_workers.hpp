/// Tasks done by several threads of this process, which the calling one waits for: it hears of results, of a signal and
/// of the time.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace tchat {

struct SweepWork {
  std::size_t tasks = 0;
  /// In a worker's thread, with the number of the worker, from 0, which no other one has at that time. Looks at `stop`
  /// now and then, and returns early when it is set. What it throws stops all and is thrown to the caller.
  std::function<void(std::size_t task, int worker, const std::atomic<bool>& stop)> work;
  /// In the calling thread, ten times a second and at the end. True stops all.
  std::function<bool()> meanwhile;
};

/// Returns when all tasks are done or have been stopped. workers >= 1.
void run_workers(int workers, const SweepWork& work);

}  // namespace tchat
