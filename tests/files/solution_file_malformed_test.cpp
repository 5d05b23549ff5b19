#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "base/messages.hpp"
#include "files/sample_solutions.hpp"
#include "files/solution_file_reader.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::SampleEntry;

namespace {

/// Integer `position` (from 1) of the first line replaced.
std::string with_integer(std::string text, int position, const std::string& value) {
  static const int widths[] = {6, 6, 6, 6, 6, 6, 8, 6, 8, 5, 5, 5, 5, 5, 5, 5};
  std::size_t begin = 0;
  for (int k = 1; k < position; ++k) begin += static_cast<std::size_t>(widths[k - 1]);
  return text.replace(begin, static_cast<std::size_t>(widths[position - 1]), " " + value);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

/// Line `number` (from 1) replaced.
std::string with_line(const std::string& text, int number, const std::string& line) {
  std::size_t begin = 0;
  for (int k = 1; k < number; ++k) begin = text.find('\n', begin) + 1;
  return text.substr(0, begin) + line + text.substr(text.find('\n', begin));
}

std::string with_kind(const std::vector<double>& internal) {
  SampleEntry entry;
  entry.internal = internal;
  return entry.text();
}

struct Malformed {
  const char* what;
  std::string text;
  std::vector<std::string> expected;
};

// The sample: line 1 identifier, 2..6 states, 7 ICP, 8 its direction, 9..13 direction of states, 14..28 PAR.
std::vector<Malformed> corpus() {
  const std::string good = SampleEntry().text();
  const std::string huge = "2147483647";
  return {
      {"prose", "this is not a q-file\n", {"q.x:1", "'this', not an integer", "16 integers"}},
      {"a p-file", "   0   0.0000E+00  1.0000E+00\n", {"q.x:1", "'0.0000E+00'", "no q-file"}},
      {"a data file", "0.0 1.0\n1.0 2.0\n", {"q.x:1", "'0.0'"}},
      {"too few integers", "     1     2     3\n", {"q.x:1", "found 3 integers"}},
      {"13 integers", " 1 2 3 4 5 6 7 8 9 10 11 12 13\n", {"found 13 integers"}},
      {"17 integers", " 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17\n", {"more than 16 integers"}},
      {"integer out of range", with_integer(good, 2, "99999999999"), {"q.x:1", "'99999999999'"}},
      {"real number", with_integer(good, 5, "1.5"), {"'1.5', not an integer"}},
      {"label too great to go on from", with_integer(good, 4, huge), {"q.x:1", "label 2147483647"}},
      {"branch too great", with_integer(good, 1, huge), {"q.x:1", "branch 2147483647"}},
      {"label negative", with_integer(good, 4, "-1"), {"q.x:1", "label -1"}},
      {"NFPR negative", with_integer(good, 5, "-2"), {"NFPR = -2"}},
      {"NFPR wrong", with_integer(good, 5, "3"), {"q.x:1", "has 133 numbers", "135"}},
      {"NFPR huge", with_integer(good, 5, huge), {"q.x:1", "133 numbers"}},
      {"NTPL negative", with_integer(good, 7, "-5"), {"NTPL = -5"}},
      {"NTPL zero", with_integer(good, 7, "0"), {"NTPL = 0"}},
      {"NTPL off the mesh", with_integer(good, 7, "6"), {"NTPL = 6", "NTST NCOL + 1 = 5"}},
      {"NTPL huge", with_integer(good, 7, huge), {"NTPL = 2147483647"}},
      {"NAR without states", with_integer(good, 8, "1"), {"NAR = 1"}},
      {"NAR negative", with_integer(good, 8, "-3"), {"NAR = -3"}},
      {"NAR no whole segments", with_integer(good, 8, "4"), {"3 states", "dimension 2"}},
      {"NAR wrong", with_integer(good, 8, "5"), {"133 numbers"}},
      {"NAR huge", with_integer(good, 8, "2147483647"), {"1073741823 segments", "at most 100000"}},
      {"NROWPR negative", with_integer(good, 9, "-1"), {"NROWPR = -1"}},
      {"NROWPR too small", with_integer(good, 9, "20"), {"q.x:1", "integer 9"}},
      {"NROWPR too small for PAR only", with_integer(good, 9, "5") + good, {"q.x:1", "numbers"}},
      {"NROWPR too large", with_integer(good, 9, "29") + good, {"q.x:1", "numbers", "integer 9"}},
      {"NROWPR beyond the file", with_integer(good, 9, "28"), {"NROWPR = 28", "the file has fewer", "20 or 27"}},
      {"NROWPR huge", with_integer(good, 9, huge), {"NROWPR = 2147483647"}},
      {"NTST negative", with_integer(good, 10, "-2"), {"NTST = -2"}},
      {"NTST, NCOL huge",
       " 1 2 9 1 2 1 5 3 27 2147483647 2147483647 104 4 2 180 0\n" + good.substr(good.find('\n') + 1),
       {"NTPL = 5", "NTST NCOL + 1 = 4611686014132420610"}},
      {"NCOL negative", with_integer(good, 11, "-2"), {"NCOL = -2"}},
      {"NCOL zero", with_integer(good, 11, "0"), {"NTST NCOL + 1 = 1"}},
      {"NPAR negative", with_integer(good, 12, "-1"), {"NPAR = -1"}},
      {"NPAR wrong", with_integer(good, 12, "103"), {"133 numbers"}},
      {"NPAR without durations", with_integer(good, 12, "60"), {"NPAR = 60", "PAR(61..61)"}},
      {"NPARI negative", with_integer(good, 13, "-4"), {"NPARI = -4"}},
      {"NPARI beyond NPAR", with_integer(good, 13, "105"), {"NPARI = 105"}},
      {"NDIM zero in a file of ours", with_integer(good, 14, "0"), {"dimension 0"}},
      {"NDIM negative", with_integer(good, 14, "-2"), {"NDIM = -2"}},
      {"a word among the states", with_line(good, 3, "   0.25 1.0 wall"), {"q.x:3", "'wall' is not a finite number"}},
      {"NaN", with_line(good, 4, "   0.5 NaN 1.0"), {"q.x:4", "'NaN'"}},
      {"Infinity", with_line(good, 10, "   Infinity 1.0"), {"q.x:10", "'Infinity'"}},
      {"stars", with_line(good, 5, "   0.75 ****************** 1.0"), {"q.x:5", "'*****"}},
      {"a number missing", with_line(good, 5, "   0.75 1.0"), {"q.x:1", "has 132 numbers"}},
      {"a number too many", with_line(good, 5, "   0.75 1.0 2.0 3.0"), {"has 134 numbers"}},
      {"t falls", with_line(good, 4, "   0.1 1.0 2.0"), {"q.x:1", "label 1", "t = 0.1 at time point 3"}},
      {"t does not begin at 0", with_line(good, 2, "   0.1 1.0 2.0"), {"t runs from 0.1 to 1"}},
      {"t does not end at 1", with_line(good, 6, "   0.9 1.0 2.0"), {"t runs from 0 to 0.9"}},
      {"mesh interval without length", with_line(with_line(good, 3, " 0 1.0 2.0"), 4, " 0 1.0 2.0"), {"time point 3"}},
      {"ICP a real number", with_line(good, 7, "    1 61.5"), {"q.x:7", "'61.5' is not the number of a parameter"}},
      {"ICP zero", with_line(good, 7, "    0   61"), {"q.x:7", "'0'", "from 1 to 104"}},
      {"ICP beyond PAR", with_line(good, 7, "    1  999"), {"q.x:7", "'999'"}},
      {"kind unknown", with_kind({12, 0, 0, 0}), {"q.x:28", "12 as kind", "UZ"}},
      {"meshes of segments in place of a kind", with_kind({8, 0, 0, 0}), {"q.x:28", "8 as kind", "UZ"}},
      {"kind not whole", with_kind({1.5, 0, 0, 0}), {"1.5 as kind"}},
      {"segment negative", with_kind({2, -1, 1, 0}), {"-1 as segment"}},
      {"segment huge", with_kind({2, 1e300, 1, 0}), {"as segment"}},
      {"index huge", with_kind({2, 1, 1e19, 0}), {"as index"}},
      {"NUL bytes", with_line(good, 3, std::string("\0\0\0 1.0 2.0", 11)), {"q.x:3"}},
      {"second entry damaged", good + replaced(good, "     1    10", "     1    ab"), {"q.x:29", "'ab'"}},
      {"prose at the end", good + "that is all\n", {"q.x:29", "'that'"}},
  };
}

}  // namespace

TEST_CASE("Malformed q-files are refused with the place and the cure", "[start][malformed]") {
  const auto cases = corpus();
  REQUIRE(cases.size() >= 30);
  for (const Malformed& malformed : cases) {
    INFO(malformed.what);
    const std::string message = message_of<UserError>([&] { parse_solution_file(malformed.text, "q.x"); });
    for (const std::string& part : malformed.expected) CHECK_THAT(message, Contains(part));
  }
}

TEST_CASE("A file cut at every byte: the complete solutions and a warning", "[start][malformed]") {
  SampleEntry first, second;
  first.segments = 2;
  first.free_parameters = {1, 61, 62};
  first.label = 3;
  second.label = 4;
  second.direction = false;
  const int form = GENERATE(0, 1, 2);
  first.parameter_decimals = second.parameter_decimals = form == 0 ? 10 : 16;
  if (form == 2) {  // the last line has one number instead of 6
    second.segments = 42;
    second.dimension = second.intervals = 1;
    second.parameters = 106;
  }
  const std::string one = first.text();
  const std::string text = one + second.text();
  for (std::size_t length = form == 2 ? text.size() - 40 : 0; length <= text.size(); ++length) {
    CAPTURE(length);
    const SolutionFile file = parse_solution_file(std::string_view(text).substr(0, length), "q.x");
    // The newline after the last number may be missing.
    const std::size_t complete = (length + 1 >= one.size() ? 1U : 0U) + (length + 1 >= text.size() ? 1U : 0U);
    REQUIRE(file.solutions.size() == complete);
    REQUIRE(file.complete_bytes <= length);
    const bool between = length == 0 || length + 1 >= text.size() || length + 1 == one.size() || length == one.size();
    const bool only_blanks = text.substr(0, length).find_last_not_of(" \n") + 1 <= (complete > 0 ? one.size() : 0);
    if (!between && !only_blanks) {
      REQUIRE(file.warnings.size() == 1);
      REQUIRE_THAT(file.warnings[0], Contains("q.x:") && Contains("not complete"));
    }
    if (complete > 0) {
      REQUIRE(file.solutions[0].label == 3);
      REQUIRE(file.solutions[0].parameters[99] == 100.0);
    }
  }
}

TEST_CASE("Every byte changed in turn: a message or a solution, never a crash", "[start][malformed]") {
  SampleEntry entry;
  entry.intervals = 1;
  entry.type = -4;
  entry.internal = {2, 1, 1, 0.5};
  const std::string good = entry.text();
  const char replacements[] = {'9', '-', ' ', '\n', 'x', '\0', '\xff'};
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const char c : replacements) {
      std::string text = good;
      text[at] = c;
      try {
        const SolutionFile file = parse_solution_file(text, "q.x");
        REQUIRE(file.solutions.size() <= 1);
      } catch (const UserError& error) {
        REQUIRE_THAT(error.what(), Contains("q.x:"));
      }
    }
}

TEST_CASE("Counts that announce more than memory holds ask for none", "[start][malformed]") {
  // Counts that agree with each other, 1000000 x 100 + 1 time points of 19 states, in a file of two lines.
  const std::string text = " 1 1 9 1 1 1 100000001 20 600000023 1000000 100 104 4 19 180 0\n    0.0 1.0 2.0\n";
  const SolutionFile file = parse_solution_file(text, "q.x");
  CHECK(file.solutions.empty());
  REQUIRE(file.warnings.size() == 1);
  CHECK_THAT(file.warnings[0], Contains("not complete"));
}
