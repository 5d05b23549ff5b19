#include "simulate/sweep_workers.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <vector>

#include "base/messages.hpp"
#include "plugin/exit_guard.hpp"

namespace tchat {

namespace {

constexpr std::size_t worker_stack = 8 << 20;  // as much as a program's first thread usually has

/// What the threads share.
struct Team {
  explicit Team(const SweepWork& what) : work(what) {}

  /// Tasks one after the other, for as long as there are any.
  void do_tasks(int worker) {
    try {
      const SignalStack signals;
      for (std::size_t task = next++; task < work.tasks && !stop; task = next++) work.work(task, worker, stop);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!thrown) thrown = std::current_exception();
      stop = true;
    }
    const std::lock_guard lock(mutex);
    --running;
    ended.notify_all();
  }

  const SweepWork& work;
  std::atomic<bool> stop = false;
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::condition_variable ended;
  int running = 0;
  std::exception_ptr thrown;
};

/// One worker's number in its team, for the thread that is it.
struct Member {
  Team* team;
  int worker;
};

extern "C" void* run_member(void* member) {
  const auto* const self = static_cast<const Member*>(member);
  self->team->do_tasks(self->worker);
  return nullptr;
}

/// Joins its threads at the end, which stop early when not all of them could be started.
class Threads {
 public:
  Threads(Team& team, int count) : members_(static_cast<std::size_t>(count)) {
    team.running = count;
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, worker_stack);
    int error = 0;
    for (int worker = 0; worker < count && error == 0; ++worker) {
      Member& member = members_[static_cast<std::size_t>(worker)];
      member = {&team, worker};
      pthread_t thread{};
      error = pthread_create(&thread, &attributes, &run_member, &member);
      if (error == 0) started_.push_back(thread);
    }
    pthread_attr_destroy(&attributes);
    if (error == 0) return;
    team.stop = true;
    join();
    throw ComputationError(
        fmt::format("only {} of {} threads can be started ({}).\n"
                    "  Use fewer workers (-j {}), or raise the limits on threads and memory (ulimit -u, ulimit -v).",
                    started_.size(), count, std::strerror(error), std::max<std::size_t>(1, started_.size() / 2)));
  }
  ~Threads() { join(); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  void join() {
    for (; joined_ < started_.size(); ++joined_) pthread_join(started_[joined_], nullptr);
  }

  std::vector<Member> members_;
  std::vector<pthread_t> started_;
  std::size_t joined_ = 0;
};

/// Calls `meanwhile` ten times a second and at the end.
void wait_for(Team& team) {
  std::unique_lock lock(team.mutex);
  const auto is_done = [&team] { return team.running == 0; };
  while (!is_done()) {
    team.ended.wait_for(lock, std::chrono::milliseconds(100), is_done);
    lock.unlock();
    if (team.work.meanwhile()) team.stop = true;
    lock.lock();
  }
}

}  // namespace

void run_workers(int workers, const SweepWork& work) {
  Team team(work);
  const auto count =
      static_cast<int>(std::min(static_cast<std::size_t>(workers), std::max<std::size_t>(1, work.tasks)));
  const Threads threads(team, count);
  try {
    wait_for(team);
  } catch (...) {
    team.stop = true;
    throw;
  }
  if (team.thrown) std::rethrow_exception(team.thrown);
}

}  // namespace tchat
