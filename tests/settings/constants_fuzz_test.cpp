// Damaged files either parse or are refused with a UserError; nothing else may happen.
#include <catch2/catch.hpp>
#include <random>

#include "base/messages.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/sample_files.hpp"

using namespace tchat;

namespace {

/// True when the text parses; UserError counts as refused, anything else ends the test.
bool parses(const std::string& text) {
  try {
    read_constants_text(text, "gc.damaged");
    return true;
  } catch (const UserError& error) {
    if (std::string(error.what()).find("gc.damaged") != 0) FAIL("no place: " << error.what());
    return false;
  }
}

std::vector<std::string> good_files() {
  const std::string positional = testing::appendix_b();
  RunSettings settings = read_constants_text(positional, "gc.test");
  apply_overrides(settings, std::vector<std::string>{"UZR={1: [2.5, 3], -2: 4}", "STOP=[PD1, GR1]", "THU={2: 0.5}"});
  return {positional, positional_text(settings), keyword_text(settings)};
}

/// Each good file with flipped bits and exchanged bytes, `rounds` times.
void damage_files(unsigned seed, int rounds) {
  std::mt19937 random(seed);
  const std::string spice = "0159+-.,/*={}[]:#'\"()eEdD \t\n\r\\xNIG_";
  for (const std::string& text : good_files()) {
    int refused = 0;
    for (int round = 0; round < rounds; ++round) {
      std::string damaged = text;
      for (unsigned i = 0, flips = 1 + random() % 4; i < flips; ++i) {
        char& byte = damaged[random() % damaged.size()];
        byte = random() % 2 == 0 ? static_cast<char>(byte ^ (1 << random() % 8)) : spice[random() % spice.size()];
      }
      refused += parses(damaged) ? 0 : 1;
    }
    CHECK(refused > 0);
  }
}

}  // namespace

TEST_CASE("Files cut off at any byte", "[constants][fuzz]") {
  for (const std::string& text : good_files()) {
    // Of Appendix B all values up to the last, the 1 of "2 2 1", are needed.
    const std::size_t last_value = text == testing::appendix_b() ? text.rfind("2 2 1") + 4 : std::string::npos;
    int accepted = 0;
    for (std::size_t length = 0; length <= text.size(); ++length) {
      const bool is_accepted = parses(text.substr(0, length));
      accepted += is_accepted ? 1 : 0;
      CAPTURE(length);
      if (last_value != std::string::npos) REQUIRE(is_accepted == (length > last_value));
    }
    CHECK(accepted >= 1);
  }
}

TEST_CASE("Files with flipped bits and exchanged bytes", "[constants][fuzz]") { damage_files(20061216, 500); }

TEST_CASE("Files with flipped bits and exchanged bytes, thousands of them", "[constants][fuzz][slow]") {
  damage_files(20061215, 4000);
}

TEST_CASE("Overrides of random characters", "[constants][fuzz]") {
  std::mt19937 random(12);
  const std::vector<std::string> parts{"ICP", "=",   "[",   "]",         "{",    "}",       ":",      ",",    "1", "61",
                                       "-2",  "1e5", "PAR", "(",         ")",    "UZR",     "THL",    "'",    "#", " ",
                                       "PD1", "\n",  ".",   "GCHGRZIND", "STOP", "GCNOSEG", "GCFIND", "GCHNO"};
  const RunSettings original = read_constants_text(testing::appendix_b(), "gc.test");
  for (int round = 0; round < 20000; ++round) {
    std::string text = parts[random() % parts.size()] + "=";
    for (unsigned i = 0, count = random() % 8; i < count; ++i) text += parts[random() % parts.size()];
    RunSettings settings = original;
    try {
      apply_overrides(settings, std::vector{text});
    } catch (const UserError&) {
      REQUIRE(testing::same_constants(settings, original));
    }
  }
}
