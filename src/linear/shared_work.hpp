/// Pieces of work that have nothing to do with one another, shared by the calling thread with others of this process.
///
/// What a piece computes is written where no other one reads or writes, so that results are the same to the last bit
/// for any number of threads, and in whatever order pieces are done.
#pragma once

#include <memory>
#include <utility>

namespace tchat {

class SharedWork {
 public:
  /// threads >= 1, the calling one among them; no more than this machine has processors take part. One: everything is
  /// done by the caller, in order.
  explicit SharedWork(int threads);
  ~SharedWork();
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;
  SharedWork(SharedWork&&) noexcept;
  SharedWork& operator=(SharedWork&&) noexcept;

  int threads() const { return threads_; }

  /// For each i of 0 .. count - 1 prepare(i) by the calling thread, and then work(i, thread) by any thread; `thread` is
  /// less than threads(), and no two at a time have the same. The caller begins at 0, the others at count - 1, and they
  /// go on until they meet, with little that is prepared ahead: as a rule a piece is done by the thread that did it
  /// last time, whose cache may still hold what it needs. One thread: in order, each piece done as soon as it is
  /// prepared. Returns when all that began has ended; throws what a piece or a preparation throws. One call at a time,
  /// and none from within a piece. The other threads look out for the next call for some tenths of a millisecond;
  /// another object's pieces are done by its caller alone meanwhile.
  template <class Prepare, class Work>
  void run(int count, Prepare&& prepare, Work&& work) const {
    if (threads_ > 1 && count > 1) {
      const auto both = std::pair<Prepare&, Work&>(prepare, work);
      using Both = decltype(both);
      share(count, {&both, [](const void* p, int i) { static_cast<Both*>(p)->first(i); },
                    [](const void* p, int i, int thread) { static_cast<Both*>(p)->second(i, thread); }});
      return;
    }
    for (int i = 0; i < count; ++i) {
      prepare(i);
      work(i, 0);
    }
  }

  /// work(i, thread) for i = 0 .. count - 1.
  template <class Work>
  void each(int count, Work&& work) const {
    run(
        count, [](int) {}, work);
  }
  /// The same; one thread begins with the last one, several do as in each().
  template <class Work>
  void each_in_reverse(int count, Work&& work) const {
    if (threads_ > 1) return each(count, work);
    for (int i = count - 1; i >= 0; --i) work(i, 0);
  }

 private:
  struct Calls {
    const void* object;
    void (*prepare)(const void*, int);
    void (*work)(const void*, int, int);
  };
  class Job;
  class Team;
  void share(int count, const Calls& calls) const;

  int threads_;
  std::unique_ptr<Team> team_;  // none for one thread
};

}  // namespace tchat
