/// Runs that must be refused: exit status 2 and one message that names what is wrong, where, and the cure.
#pragma once

#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "end_to_end/workspace.hpp"

namespace test_support {

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// One message on the standard error, exit status 2, no crash, no sanitizer's report; every part is in the message.
inline void check_refused(const Outcome& outcome, const std::vector<std::string>& parts) {
  INFO(outcome.text());
  CHECK_FALSE(outcome.timed_out);
  CHECK(outcome.signal == 0);
  CHECK(outcome.status == 2);
  CHECK_FALSE(contains(outcome.err, "Sanitizer"));
  CHECK_FALSE(contains(outcome.err, "runtime error"));
  CHECK_FALSE(contains(outcome.err, "internal error"));
  for (const std::string& part : parts) {
    INFO("expected: " << part);
    CHECK(contains(outcome.err, part));
  }
}

/// `text` with line `number` (from 1) replaced.
inline std::string with_line(const std::string& text, int number, const std::string& replacement) {
  std::istringstream in(text);
  std::string result, line;
  for (int k = 1; std::getline(in, line); ++k) result += (k == number ? replacement : line) + "\n";
  return result;
}

}  // namespace test_support
