// Pieces of work done by several threads.
#include "linear/shared_work.hpp"

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace tchat;

TEST_CASE("every piece is done once, after it was prepared by the caller") {
  for (const int threads : {1, 2, 4}) {
    CAPTURE(threads);
    const SharedWork shared(threads);
    CHECK(shared.threads() == threads);
    const std::thread::id caller = std::this_thread::get_id();
    constexpr int count = 200;
    std::vector<std::atomic<int>> prepared(count), done(count);
    std::vector<std::atomic<int>> busy(static_cast<std::size_t>(threads));
    std::atomic<int> faults = 0;
    shared.run(
        count,
        [&](int i) {
          if (std::this_thread::get_id() != caller) ++faults;
          ++prepared[static_cast<std::size_t>(i)];
        },
        [&](int i, int thread) {
          const auto k = static_cast<std::size_t>(i);
          if (thread < 0 || thread >= threads || prepared[k] != 1) ++faults;
          if (busy[static_cast<std::size_t>(thread)]++ != 0) ++faults;  // nobody else has this number
          ++done[k];
          --busy[static_cast<std::size_t>(thread)];
        });
    CHECK(faults == 0);
    for (const auto& times : done) CHECK(times == 1);
  }
}

TEST_CASE("one thread does pieces in order, or from the last one on") {
  const SharedWork alone(1);
  std::vector<int> order;
  alone.run(
      3, [&](int i) { order.push_back(10 * i); }, [&](int i, int) { order.push_back(10 * i + 1); });
  CHECK(order == std::vector<int>{0, 1, 10, 11, 20, 21});
  order.clear();
  alone.each_in_reverse(3, [&](int i, int) { order.push_back(i); });
  CHECK(order == std::vector<int>{2, 1, 0});
}

TEST_CASE("many short jobs, now and then with a pause in which threads fall asleep") {
  for (const int threads : {2, 3}) {
    const SharedWork shared(threads);
    int faults = 0;
    for (int job = 0; job < 3000; ++job) {
      std::array<std::atomic<int>, 7> done{};
      const auto work = [&](int i, int) { done[static_cast<std::size_t>(i)] += job; };
      if (job % 2 == 0)
        shared.each(7, work);
      else
        shared.each_in_reverse(7, work);
      for (const auto& times : done) faults += times == job ? 0 : 1;
      if (job % 100 == 0) std::this_thread::sleep_for(std::chrono::microseconds(job / 5));
    }
    CHECK(faults == 0);
  }
}

TEST_CASE("an exception of a preparation or of a piece reaches the caller when all that began has ended") {
  for (const int threads : {1, 3}) {
    const SharedWork shared(threads);
    std::atomic<int> running = 0;
    const auto work = [&](int, int) {
      ++running;
      --running;
    };
    CHECK_THROWS_WITH(shared.run(
                          20,
                          [](int i) {
                            if (i == 9) throw std::runtime_error("prepared");
                          },
                          work),
                      "prepared");
    CHECK(running == 0);
    CHECK_THROWS_WITH(shared.each(20,
                                  [&](int i, int) {
                                    if (i == 5) throw std::runtime_error("worked");
                                  }),
                      "worked");
    CHECK(running == 0);
    int sum = 0;  // and work goes on
    shared.run(
        3, [&](int i) { sum += i; }, work);
    CHECK(sum == 3);
  }
}
