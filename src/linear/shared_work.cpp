#include "linear/shared_work.hpp"

#include <tbb/info.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <exception>
#include <thread>
#include <vector>

namespace tchat {

namespace {

/// A queue of pieces 0 .. prepared - 1, of which the first `taken` have somebody who does them.
class Pieces {
 public:
  /// One more is prepared.
  void add() { prepared_.fetch_add(1, std::memory_order_release); }
  /// There will be no more; or nobody is to begin another one.
  void close() { closed_ = true; }
  void stop() { stopped_ = true; }
  bool ended() const { return stopped_ || (closed_ && waiting() == 0); }
  int waiting() const { return prepared_.load(std::memory_order_acquire) - taken_; }
  /// The number of a piece to do now, or -1.
  int take() {
    int next = taken_;
    while (!stopped_ && next < prepared_.load(std::memory_order_acquire))
      if (taken_.compare_exchange_weak(next, next + 1)) return next;
    return -1;
  }

 private:
  std::atomic<int> prepared_ = 0;
  std::atomic<int> taken_ = 0;
  std::atomic<bool> closed_ = false;
  std::atomic<bool> stopped_ = false;
};

}  // namespace

/// What run() was called for. The others' pieces are a queue from the last one on.
class SharedWork::Job {
 public:
  Job(int count, const Calls& calls) : count_(count), calls_(calls) {}

  /// The caller prepares pieces for `others`, so that one waits for each of them, does its own in between, and in the
  /// end what nobody has taken.
  void lead(int others) {
    guard([&] {
      int queued = 0;
      for (int own = 0; own + queued < count_ && !others_.ended();)
        if (others_.waiting() < others) {
          prepare(last() - queued++);
          others_.add();
        } else {
          prepare(own);
          work(own++, 0);
        }
      others_.close();
      while (do_one(0)) {
      }
    });
  }
  /// Pieces until there will be none.
  void help(int thread) {
    guard([&] {
      while (!others_.ended())
        if (!do_one(thread)) std::this_thread::yield();
    });
  }
  /// What the first one threw that did; when nobody works any more.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  int last() const { return count_ - 1; }
  void prepare(int piece) const { calls_.prepare(calls_.object, piece); }
  void work(int piece, int thread) const { calls_.work(calls_.object, piece, thread); }
  bool do_one(int thread) {
    const int place = others_.take();
    if (place >= 0) work(last() - place, thread);
    return place >= 0;
  }
  template <class Part>
  void guard(const Part& part) {
    try {
      part();
    } catch (...) {
      if (!failed_.exchange(true)) thrown_ = std::current_exception();
      others_.stop();
    }
  }

  int count_;
  const Calls& calls_;
  Pieces others_;
  std::atomic<bool> failed_ = false;
  std::exception_ptr thrown_;
};

/// The other threads. To wake one takes as long as many a job, where its processor has been halted, so that they look
/// out for the next one for a while before they are given back to oneTBB.
class SharedWork::Team {
 public:
  /// oneTBB complains on the screen of more threads than there are processors.
  explicit Team(int threads)
      : present_(std::min(threads, tbb::info::default_concurrency())),
        arena_(present_),
        awake_(static_cast<std::size_t>(present_)) {}
  ~Team() {
    leaving_ = true;
    arena_.execute([&] { helpers_.wait(); });
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  void run(Job& job) {
    assert(job_ == nullptr);
    job_ = &job;
    for (int thread = 1; thread < present_; ++thread)
      if (!awake(thread).exchange(true)) wake(thread);
    job.lead(present_ - 1);
    job_ = nullptr;
    while (inside_ != 0) std::this_thread::yield();  // they read the job
  }

 private:
  std::atomic<bool>& awake(int thread) { return awake_[static_cast<std::size_t>(thread)]; }

  /// Where there is no memory for it the others do the work.
  void wake(int thread) {
    try {
      arena_.enqueue(helpers_.defer([this, thread] { help(thread); }));
    } catch (const std::exception&) {
      awake(thread) = false;
    }
  }

  void help(int thread) {
    while (true) {
      help_while_needed(thread);
      if (!falls_asleep_too_early(thread)) return;
    }
  }

  void help_while_needed(int thread) {
    using Clock = std::chrono::steady_clock;
    constexpr auto patience = std::chrono::microseconds(300);
    for (auto last = Clock::now(); !leaving_ && Clock::now() - last < patience;) {
      if (job_ == nullptr) {
        std::this_thread::yield();
        continue;
      }
      ++inside_;
      if (Job* const job = job_) job->help(thread);
      --inside_;
      std::this_thread::yield();  // the caller may be at its own last piece
      last = Clock::now();
    }
  }

  /// Whoever has a job thinks that this thread looks out for it, unless it was told in time; then it is woken.
  bool falls_asleep_too_early(int thread) {
    awake(thread) = false;
    return job_ != nullptr && !awake(thread).exchange(true);
  }

  int present_;
  tbb::task_arena arena_;
  tbb::task_group helpers_;
  std::atomic<Job*> job_ = nullptr;
  std::atomic<int> inside_ = 0;  // so many may be reading the job
  std::atomic<bool> leaving_ = false;
  std::vector<std::atomic<bool>> awake_;  // the caller's is not used
};

SharedWork::SharedWork(int threads)
    : threads_(threads), team_(threads > 1 ? std::make_unique<Team>(threads) : nullptr) {}

SharedWork::~SharedWork() = default;
SharedWork::SharedWork(SharedWork&&) noexcept = default;
SharedWork& SharedWork::operator=(SharedWork&&) noexcept = default;

void SharedWork::share(int count, const Calls& calls) const {
  Job job(count, calls);
  team_->run(job);
  job.rethrow();
}

}  // namespace tchat
