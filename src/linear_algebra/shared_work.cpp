#include "linear_algebra/shared_work.hpp"

#include <tbb/info.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace tchat {

struct SharedWork::Arena {
  /// oneTBB complains on the screen of more threads than there are processors.
  explicit Arena(int threads) : arena(std::min(threads, tbb::info::default_concurrency())) {}
  tbb::task_arena arena;
};

SharedWork::SharedWork(int threads)
    : threads_(threads), arena_(threads > 1 ? std::make_unique<Arena>(threads) : nullptr) {}

SharedWork::~SharedWork() = default;
SharedWork::SharedWork(SharedWork&&) noexcept = default;
SharedWork& SharedWork::operator=(SharedWork&&) noexcept = default;

namespace {

/// Pieces 0 .. prepared - 1, of which the first `taken` have somebody who does them.
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

/// Every other thread takes pieces until there will be none. The caller prepares no more than one ahead for each of
/// them, and does pieces itself in between: what is prepared is then still in the cache when it is done.
void SharedWork::share(int count, const Calls& calls) const {
  arena_->arena.execute([&] {
    Pieces pieces;
    const auto do_one = [&](int thread) {
      const int piece = pieces.take();
      if (piece >= 0) calls.work(calls.object, piece, thread);
      return piece >= 0;
    };
    tbb::task_group others;
    try {
      const int present = arena_->arena.max_concurrency();
      for (int thread = 1; thread < present; ++thread)
        others.run([&, thread] {
          while (!pieces.ended())
            if (!do_one(thread)) std::this_thread::yield();
        });
      for (int i = 0; i < count && calls.prepare(calls.object, i); ++i) {
        pieces.add();
        while (pieces.waiting() >= present) do_one(0);
      }
      pieces.close();
      while (do_one(0)) {
      }
    } catch (...) {
      pieces.stop();
      others.wait();  // they write to what the caller is about to destroy
      throw;
    }
    others.wait();
  });
}

}  // namespace tchat
