#include "base/words.hpp"

#include <catch2/catch.hpp>
#include <string>

using tchat::parse_fortran_real;

TEST_CASE("Fortran numbers in every spelling", "[start]") {
  const std::pair<const char*, double> cases[] = {
      {"1.5", 1.5},        {"-1.5", -1.5},      {"+1.5", 1.5},          {"3", 3.0},
      {".5", 0.5},         {"5.", 5.0},         {"1.5E-03", 1.5e-3},    {"1.5d2", 150.0},
      {"1.5D+002", 150.0}, {"1.0-100", 1e-100}, {"-2.5+101", -2.5e101}, {"1E+000", 1.0},
      {"1.0E-400", 0.0},   {"-0.0", 0.0},       {"1.0-400", 0.0},       {"1.2345678901E+000", 1.2345678901}};
  for (const auto& [text, value] : cases) {
    CAPTURE(text);
    REQUIRE(parse_fortran_real(text).has_value());
    CHECK(*parse_fortran_real(text) == value);
  }
}

TEST_CASE("What is no finite number is refused", "[start]") {
  for (const std::string text :
       {"",          "+",    "-",        ".",     "e5",  "1e",  "1e+",   "1.5-", "1,5",     "nan", "NaN",      "inf",
        "-Infinity", "0x10", "1.5E+999", "1+400", "--1", "+-1", "1.5.2", "****", "1.5E5.0", "1 2", "1.0E+00-1"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_fortran_real(text).has_value());
  }
  CHECK_FALSE(parse_fortran_real(std::string(100000, '9')).has_value());
}

TEST_CASE("What is around a text is taken away") {
  CHECK(tchat::trimmed("\t two words \r") == "two words");
  CHECK(tchat::trimmed("none") == "none");
  CHECK(tchat::trimmed(" \t\r").empty());
  CHECK(tchat::trimmed("").empty());
}

TEST_CASE("Words of a line", "[start]") {
  const auto words = tchat::split_words(" \t1.0  -2\t x\r");
  REQUIRE(words.size() == 3);
  CHECK(words[0] == "1.0");
  CHECK(words[1] == "-2");
  CHECK(words[2] == "x");
  CHECK(tchat::split_words("   ").empty());
}
