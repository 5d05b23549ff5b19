#include "sweep/sweep_workers.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>

#include "plugin/exit_guard.hpp"

namespace tchat {

namespace {

constexpr std::size_t worker_stack = 8 << 20;  // as much as a program's first thread usually has

void give_signal_stack() {
  static thread_local const SignalStack stack;
  static_cast<void>(stack);
}

}  // namespace

void run_workers(int workers, const SweepWork& work) {
  const auto allowed = static_cast<std::size_t>(workers) + 1;  // the calling thread counts, and does none of the work
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, allowed);
  const tbb::global_control stack(tbb::global_control::thread_stack_size, worker_stack);
  std::atomic<bool> stop = false;
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::condition_variable ended;
  bool is_done = false;
  std::exception_ptr thrown;

  tbb::task_arena arena(workers, 0);
  arena.enqueue([&] {
    try {
      // A worker is a task that takes one after the other, for as long as there are any: its number is its own, however
      // many threads there are.
      tbb::parallel_for(
          tbb::blocked_range<int>(0, workers, 1),
          [&](const tbb::blocked_range<int>& numbers) {
            give_signal_stack();
            for (int worker = numbers.begin(); worker < numbers.end(); ++worker)
              for (std::size_t task = next++; task < work.tasks && !stop; task = next++) work.work(task, worker, stop);
          },
          tbb::simple_partitioner());
    } catch (...) {
      thrown = std::current_exception();
      stop = true;
    }
    const std::lock_guard lock(mutex);
    is_done = true;
    ended.notify_all();
  });
  std::unique_lock lock(mutex);
  while (!is_done) {
    ended.wait_for(lock, std::chrono::milliseconds(100), [&] { return is_done; });
    lock.unlock();
    try {
      if (work.meanwhile()) stop = true;
    } catch (...) {
      stop = true;
      lock.lock();
      ended.wait(lock, [&] { return is_done; });
      throw;
    }
    lock.lock();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace tchat
