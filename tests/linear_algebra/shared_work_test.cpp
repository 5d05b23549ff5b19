// Pieces of work done by several threads.
#include "linear_algebra/shared_work.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace tchat;

TEST_CASE("every piece is done once, after it was prepared by the caller in order") {
  for (const int threads : {1, 2, 4}) {
    CAPTURE(threads);
    const SharedWork shared(threads);
    CHECK(shared.threads() == threads);
    const std::thread::id caller = std::this_thread::get_id();
    constexpr int count = 200;
    std::vector<int> order;
    std::vector<std::atomic<int>> prepared(count), done(count);
    std::vector<std::atomic<int>> busy(static_cast<std::size_t>(threads));
    std::atomic<int> faults = 0;
    shared.run(
        count,
        [&](int i) {
          if (std::this_thread::get_id() != caller) ++faults;
          order.push_back(i);
          ++prepared[static_cast<std::size_t>(i)];
          return true;
        },
        [&](int i, int thread) {
          const auto k = static_cast<std::size_t>(i);
          if (thread < 0 || thread >= threads || prepared[k] != 1) ++faults;
          if (busy[static_cast<std::size_t>(thread)]++ != 0) ++faults;  // nobody else has this number
          ++done[k];
          --busy[static_cast<std::size_t>(thread)];
        });
    CHECK(faults == 0);
    CHECK(order.size() == count);
    CHECK(std::is_sorted(order.begin(), order.end()));
    for (const auto& times : done) CHECK(times == 1);
  }
}

TEST_CASE("what is not prepared is not done, and neither is what would come after it") {
  for (const int threads : {1, 3}) {
    const SharedWork shared(threads);
    std::vector<std::atomic<int>> done(20);
    int asked = 0;
    shared.run(
        20, [&](int i) { return ++asked, i != 7; }, [&](int i, int) { ++done[static_cast<std::size_t>(i)]; });
    CHECK(asked == 8);
    for (std::size_t i = 0; i < done.size(); ++i) CHECK(done[i] == (i < 7 ? 1 : 0));
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
                          20, [](int i) { return i < 9 || (throw std::runtime_error("prepared"), false); }, work),
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
        3, [&](int i) { return sum += i, true; }, work);
    CHECK(sum == 3);
  }
}
