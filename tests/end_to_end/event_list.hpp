/// A strict reader of NAME.events as src/docs/simulation.md describes it.
#pragma once

#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "end_to_end/workspace.hpp"

namespace test_support {

struct ListedEvent {
  long segment = 0;
  int field = 0, event = 0, jump = 0;
  double time = 0.0, h = 0.0, rate = 0.0;
  std::vector<double> before, after;
  std::string what;
};

/// Fails the test for a line that does not have 4 + 3 + 2 n numbers and a word.
inline std::vector<ListedEvent> read_event_list(const std::string& text, std::size_t n) {
  std::vector<ListedEvent> events;
  std::istringstream in(text);
  int comments = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) {
      ++comments;
      continue;
    }
    INFO(line);
    const std::vector<std::string> words = words_of(line);
    REQUIRE(words.size() == 8 + 2 * n);
    ListedEvent e{std::stol(words[0]),
                  std::stoi(words[1]),
                  std::stoi(words[2]),
                  std::stoi(words[3]),
                  std::stod(words[4]),
                  std::stod(words[5]),
                  std::stod(words[6]),
                  {},
                  {},
                  words.back()};
    for (std::size_t k = 0; k < n; ++k) {
      e.before.push_back(std::stod(words[7 + k]));
      e.after.push_back(std::stod(words[7 + n + k]));
    }
    if (!events.empty()) CHECK(e.time >= events.back().time);
    events.push_back(std::move(e));
  }
  CHECK(comments == 2);
  CHECK((text.empty() || text.back() == '\n'));
  return events;
}

}  // namespace test_support
