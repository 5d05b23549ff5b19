#include "linear_algebra/shared_work.hpp"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace tchat {

struct SharedWork::Arena {
  explicit Arena(int threads) : arena(threads) {}
  tbb::task_arena arena;
};

SharedWork::SharedWork(int threads)
    : threads_(threads), arena_(threads > 1 ? std::make_unique<Arena>(threads) : nullptr) {}

SharedWork::~SharedWork() = default;
SharedWork::SharedWork(SharedWork&&) noexcept = default;
SharedWork& SharedWork::operator=(SharedWork&&) noexcept = default;

void SharedWork::share(int count, const Calls& calls) const {
  arena_->arena.execute([&] {
    tbb::task_group pieces;
    const auto begin = [&] {
      for (int i = 0; i < count && calls.prepare(calls.object, i); ++i)
        pieces.run([&calls, i] { calls.work(calls.object, i, tbb::this_task_arena::current_thread_index()); });
    };
    try {
      begin();
    } catch (...) {
      pieces.wait();  // they write to what the caller is about to destroy
      throw;
    }
    pieces.wait();
  });
}

}  // namespace tchat
