// Which states on a section give way to those of the flow that comes in: a section passed every 3 of time.
#include "simulate/recorded_states.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;

namespace {

TimedState at(double time, double x) { return {time, 3, Eigen::VectorXd::Constant(1, x)}; }

/// The motion's states are 1, 2, ...; those of the incoming flow minus the number of the impact, `wait` behind it.
std::vector<double> values(const std::vector<TimedState>& crossings, const std::vector<double>& impacts,
                           const TimeSpan& span, double wait) {
  std::vector<double> found;
  for (const TimedState& state : incoming_states(crossings, impacts, span, [&](std::size_t k, double within) {
         return wait <= within ? std::optional(at(impacts[k] + wait, -1.0 - static_cast<double>(k))) : std::nullopt;
       }))
    found.push_back(state.state(0));
  return found;
}

}  // namespace

TEST_CASE("incoming states: only shortly behind an impact, and of several impacts the first") {
  const std::vector<TimedState> crossings = {at(3, 1), at(6, 2), at(9, 3)};
  const TimeSpan span{0.0, {}};
  CHECK(values(crossings, {}, span, 0.5) == std::vector<double>{1, 2, 3});
  CHECK(values(crossings, {5.5}, span, 0.5) == std::vector<double>{1, -1, 3});
  CHECK(values(crossings, {4.5}, span, 1.5) == std::vector<double>{1, 2, 3});  // half a return before
  CHECK(values(crossings, {6.2}, span, 2.8) == std::vector<double>{1, 2, 3});  // behind the section
  CHECK(values(crossings, {5.2, 5.8, 8.5}, span, 0.6) == std::vector<double>{1, -1, -3});
  // P, where h is least, is passed by the incoming flow alone: the outgoing one begins behind it.
  CHECK(values({at(3, 1), at(9, 2), at(12, 3)}, {5.9}, span, 0.1) == std::vector<double>{1, -1, 2, 3});
}

TEST_CASE("incoming states: a period begins anew behind its end") {
  const TimeSpan turn{1.0, 6.0};
  CHECK(turn.from_to(6.5, 1.5) == Approx(1.0));
  CHECK(std::isinf(TimeSpan{1.0, {}}.from_to(6.5, 1.5)));
  // The impact at 6.8 belongs to the section at 7.2, which is 1.2 of the next turn.
  CHECK(values({at(1.2, 1), at(4.2, 2)}, {6.8}, turn, 0.4) == std::vector<double>{-1, 2});
}

TEST_CASE("incoming states: each has the penetration of the contact beside it") {
  const std::vector<TimedState> states = {at(3, 1), at(6, 2), at(9, 3)};
  const TimeSpan span{0.0, {}};
  CHECK(nearest_contacts(states, {at(2.5, 0), at(6.4, 0), at(6.1, 0)}, TimeSpan{0.0, 9.0}) ==
        std::vector<int>{0, 2, -1});
  CHECK(nearest_contacts(states, {at(2.5, 0), at(6.1, 0), at(6.4, 0)}, span) == std::vector<int>{0, 1, -1});
  CHECK(nearest_contacts(states, {}, span) == std::vector<int>{-1, -1, -1});
}
