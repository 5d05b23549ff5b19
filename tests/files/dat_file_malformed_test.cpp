#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;

namespace {

struct Malformed {
  const char* what;
  std::string text;
  int dimension;
  int segments;
  std::vector<std::string> expected;  ///< each must be part of the message
};

std::vector<Malformed> corpus() {
  return {
      {"empty file", "", 1, 1, {"x.dat", "no row of data", "at least 2"}},
      {"blank lines only", "\n\n  \n", 1, 1, {"no row of data"}},
      {"comments only", "# PAR(1) = 2\n# nothing else\n", 1, 1, {"no row of data"}},
      {"heading only", "t x\n", 1, 1, {"no row of data"}},
      {"one row", "0 1\n", 1, 1, {"only one row"}},
      {"one column too few", "0 1\n1\n", 1, 1, {"x.dat:2", "found 1 number,", "expected 1 + n m = 2"}},
      {"one column too many", "0 1 2\n", 1, 1, {"x.dat:1", "found 3 numbers", "seems to hold 2 segments"}},
      {"no t", "1 2\n2 3\n", 2, 1, {"found 2 numbers", "1 + n m = 3", "(n = 2, m = 1)"}},
      {"two segments for one", "0 1 2 3 4\n1 1 2 3 4\n", 2, 1, {"found 5", "seems to hold 2 segments"}},
      {"one segment for two", "0 1 2\n1 1 2\n", 2, 2, {"found 3", "1 + n m = 5", "seems to hold 1 segment:"}},
      {"columns change", "0 1\n1 2\n2 3 4\n", 1, 1, {"x.dat:3", "found 3"}},
      {"t repeated", "0 1\n0.5 2\n0.5 3\n", 1, 1, {"x.dat:3", "t = 0.5 repeats t = 0.5 of line 2", "remove one"}},
      {"t falls", "0 1\n0.5 2\n0.25 3\n", 1, 1, {"x.dat:3", "t = 0.25 falls below t = 0.5 of line 2"}},
      {"t falls behind a comment", "0 1\n# cut\n\n-1 3\n", 1, 1, {"x.dat:4", "of line 1"}},
      {"two headings", "t x\ntime position\n0 1\n1 2\n", 1, 1, {"x.dat:2", "'time'", "only one header line"}},
      {"heading after data", "0 1\nt x\n1 2\n", 1, 1, {"x.dat:2", "'t'"}},
      {"word in a row", "0 1\n1 two\n", 1, 1, {"x.dat:2", "'two' is not a finite number"}},
      {"dots of a printed table", "0 1 .\n1 2 .\n", 1, 1, {"x.dat:1", "'.'"}},
      {"elision of a printed table", "0 1\n...\n1 2\n", 1, 1, {"x.dat:2", "'...'"}},
      {"NaN", "0 1\n1 NaN\n", 1, 1, {"x.dat:2", "'NaN' is not a finite number"}},
      {"inf", "0 inf\n1 2\n", 1, 1, {"x.dat:1", "'inf'"}},
      {"minus infinity as t", "0 1\n-Infinity 2\n", 1, 1, {"x.dat:2", "'-Infinity'"}},
      {"too large", "0 1\n1 1e999\n", 1, 1, {"x.dat:2", "'1e999'"}},
      {"t span too large", "-1.7e308 1\n1.7e308 1\n", 1, 1, {"too far"}},
      {"hexadecimal", "0 0x1p3\n1 2\n", 1, 1, {"'0x1p3'"}},
      {"stars of Fortran", "0 1\n1 *****\n", 1, 1, {"'*****'"}},
      {"binary", std::string("0 1\n1 \0\x01\x02\n", 10), 1, 1, {"x.dat:2", "is not a finite number"}},
      {"an executable",
       std::string("\x7f"
                   "ELF\x02\x01\0\0\n\xff\xfe\n",
                   12),
       1,
       1,
       {"x.dat:2"}},
      {"semicolons", "0;1\n1;2\n", 1, 1, {"x.dat:2", "'1;2'"}},
      {"decimal comma", "0,0 1,5\n1,0 2,5\n", 1, 1, {"found 4 numbers"}},
      {"PAR without number", "# PAR(1) = fast\n0 1\n1 2\n", 1, 1, {"x.dat:1", "PAR(1) = 'fast'", "`# PAR(2) = 0.8`"}},
      {"PAR without value", "# PAR(1) =\n0 1\n1 2\n", 1, 1, {"x.dat:1", "PAR(1)"}},
      {"PAR NaN", "# PAR(1) = nan\n0 1\n1 2\n", 1, 1, {"x.dat:1", "'nan'"}},
      {"PAR(0)", "# PAR(0) = 1\n0 1\n1 2\n", 1, 1, {"x.dat:1", "PAR(0)", "from 1 on"}},
      {"PAR(-3)", "0 1\n# PAR(-3) = 1\n1 2\n", 1, 1, {"x.dat:2", "PAR(-3)"}},
      {"PAR(2000000)", "# PAR(2000000) = 1\n0 1\n1 2\n", 1, 1, {"PAR(2000000)", "from 1 on"}},
      {"PAR(99999999999)", "# PAR(99999999999) = 1\n0 1\n1 2\n", 1, 1, {"from 1 on"}},
      {"PAR()", "# PAR() = 1\n0 1\n1 2\n", 1, 1, {"PAR()", "parameter's name"}},
      {"a q-file",
       "     1     1     9     1     2     1       3     5      21\n    0.0 1.0\n",
       4,
       1,
       {"x.dat:1", "found 9 numbers", "1 + n m = 5"}},
  };
}

}  // namespace

TEST_CASE("Malformed starting data are refused with the place and the cure", "[start][malformed]") {
  const auto cases = corpus();
  REQUIRE(cases.size() >= 30);
  for (const Malformed& malformed : cases) {
    INFO(malformed.what);
    const std::string message = message_of<UserError>(
        [&] { parse_dat_file(malformed.text, "x.dat", malformed.dimension, malformed.segments); });
    for (const std::string& part : malformed.expected) CHECK_THAT(message, Contains(part));
  }
}

TEST_CASE("Starting data that are no file", "[start][malformed]") {
  const test_support::TemporaryFolder folder;
  CHECK_THAT(message_of<UserError>([&] { read_dat_file(folder.file("none.dat"), 1, 1); }),
             Contains("none.dat: there is no such file"));
  CHECK_THAT(message_of<UserError>([&] { read_dat_file(folder.file("."), 1, 1); }), Contains("is a directory"));
  CHECK_THAT(message_of<UserError>([] { read_dat_file("/dev/null", 1, 1); }), Contains("device"));
  CHECK_THAT(message_of<UserError>([&] { read_dat_file(folder.write("e.dat", ""), 1, 1); }),
             Contains("no row of data"));
}

TEST_CASE("Starting data cut at every byte give a message or fewer rows", "[start][malformed]") {
  const std::string text = "# PAR(1) = 2.5E-1\nt x y\n0.0 1.0 2.0E+000\n0.5 -1.5D-1 3.25\n1.0 7.0 8.0\n";
  for (std::size_t length = 0; length < text.size(); ++length) {
    CAPTURE(length);
    try {
      const DatFile file = parse_dat_file(std::string_view(text).substr(0, length), "x.dat", 2, 1);
      CHECK((file.tau.size() == 2 || file.tau.size() == 3));
    } catch (const UserError& error) {
      CHECK_THAT(error.what(), Contains("x.dat"));
    }
  }
}
