// p-files of this program, of AUTO-07p and of AUTO 97, written out by hand.
#include "files/point_file_reader.hpp"

#include <pthread.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "base/messages.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using test_support::message_of;

namespace {

const std::string ours =
    "   0   2.5000E+00  3.4000E+00 -1.7976+308  1.7976+308\n"
    "   0   NDIM=   4   IPS = 180   IRS = UZ2   ILP =   1\n"
    "   0   NTST=  50   NCOL=   4   IAD =   3   ISP =   2\n"
    "   0   ISW =   2   IPLT=   0   NBC =   0   NINT=   0\n"
    "   0   unames = {1: 'x1', 2: 'x2'}\n"
    "   0   parnames = {1: 'alpha', 2: 'omega'}\n"
    "   0   NSEG=   2 GRSTOP=   1 GRJUMP=   1   SIGNATURE = [[1, 1, 1], [1, 1, 1]]\n"
    "   0   Active continuation parameters:      2   1  61  62\n"
    "   0   Branch type: 5  TY = 'LP'\n"
    "   0\n"
    "   0    PT  TY  LAB             omega            L2-NORM             MAX x1             alpha\n"
    "   2     1   0    0  1.8901000000E+000  5.4587948815E+000  1.0000000000E+000  1.9706026714E+000\n"
    "   2    -2  54    7  1.8917975771E+000  5.4627028452E-101  1.0000000000E+000  1.9878905293D+000\n";

// Two branches of equilibria and periodic orbits in one section; numbers without exponent letters.
const std::string auto_07p =
    "   0   0.0000E+00  1.0000E+00  0.0000E+00  1.0000E+02\n"
    "   0   NDIM=   2   IPS =   2   IRS =   4   ILP =   1\n"
    "   0   User-specified parameters:      1  11\n"
    "   0   Active continuation parameters:      1  11\n"
    "   0\n"
    "   0    PT  TY  LAB      PAR(1)           L2-NORM           MAX U(1)           MAX U(2)            PERIOD\n"
    "  -1     1   9    5  1.0000000000E-001  1.2000000000E+000  1.5000000000E+000 -2.5000000000-103  "
    "6.2831853072E+000\n"
    "  -1    -2   0    0  2.0000000000E-001  1.3000000000E+000  1.6000000000E+000  2.6000000000E+000  "
    "6.3000000000E+000\n"
    "   0   0.0000E+00  1.0000E+00  0.0000E+00  1.0000E+02\n"
    "   0    PT  TY  LAB      PAR(1)           L2-NORM\n"
    "   1     1   1    6  1.0000000000E-001  1.2000000000E+000\n";

const std::string auto_97 =
    "   0\n"
    "   0    PT  TY LAB    PAR(1)        L2-NORM        MAX U(1)\n"
    "   1     1   9   1  0.100000E+00  0.200000E+01  0.300000D+01\n";

/// Runs `call` in a thread with 128 kB; false when there is no such thread.
bool call_on_small_stack(const std::function<void()>& call) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, 128 * 1024);
  pthread_t thread{};
  const auto run = [](void* argument) -> void* {
    (*static_cast<const std::function<void()>*>(argument))();
    return nullptr;
  };
  const bool made = pthread_create(&thread, &attributes, run, const_cast<std::function<void()>*>(&call)) == 0;
  if (made) pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  return made;
}

}  // namespace

TEST_CASE("a p-file of this program") {
  const PointFile file = parse_point_file(ours, "p.x");
  CHECK(file.warnings.empty());
  REQUIRE(file.sections.size() == 1);
  const PointSection& s = file.sections[0];
  CHECK(s.columns == std::vector<std::string>{"omega", "L2-NORM", "MAX x1", "alpha"});
  CHECK(s.problem_type == 180);
  CHECK(s.branch_mode == 2);
  CHECK(s.dimension == 4);
  CHECK(s.segments == 2);
  CHECK(s.curve_type == 5);
  CHECK(s.is_two_parameter_curve());
  CHECK(s.state_name(2) == "x2");
  CHECK(s.state_name(3) == "U(3)");
  CHECK(s.parameter_name(2) == "omega");
  CHECK(s.parameter_name(3) == "PAR(3)");
  CHECK(s.free_problem_parameters() == std::vector<int>{2, 1});
  REQUIRE(s.rows.size() == 2);
  CHECK(s.rows[0].branch == 2);
  CHECK(s.rows[1].point == -2);
  CHECK(s.rows[1].type == 54);
  CHECK(s.rows[1].label == 7);
  CHECK(s.rows[1].values == std::vector<double>{1.8917975771, 5.4627028452e-101, 1.0, 1.9878905293});
}

TEST_CASE("p-files of AUTO-07p: several sections, fields as wide as their numbers") {
  const PointFile file = parse_point_file(auto_07p, "b.x");
  REQUIRE(file.sections.size() == 2);
  CHECK(file.sections[0].columns == std::vector<std::string>{"PAR(1)", "L2-NORM", "MAX U(1)", "MAX U(2)", "PERIOD"});
  CHECK(file.sections[0].rows[0].values[3] == -2.5e-103);
  CHECK(file.sections[0].rows[1].point == -2);
  CHECK(file.sections[0].free_problem_parameters() == std::vector<int>{1});
  CHECK_FALSE(file.sections[0].is_two_parameter_curve());
  CHECK(file.sections[1].rows.size() == 1);
}

TEST_CASE("p-files of AUTO 97 and files without headers") {
  const PointFile old = parse_point_file(auto_97, "p.x");
  CHECK(old.sections[0].columns == std::vector<std::string>{"PAR(1)", "L2-NORM", "MAX U(1)"});
  CHECK(old.sections[0].rows[0].values == std::vector<double>{0.1, 2.0, 3.0});
  const PointFile bare = parse_point_file("   1     1   9    1  1.0E+00  2.0E+00\r\n", "p.x");
  CHECK(bare.sections[0].columns == std::vector<std::string>{"COLUMN(1)", "COLUMN(2)"});
}

TEST_CASE("numbers that are none are gaps, a cut line is left out") {
  const PointFile gaps =
      parse_point_file("   1     1   9    1  NaN  2.0E+00\n   1     2   0    0  -Infinity  *******\n", "p.x");
  REQUIRE(gaps.warnings.size() == 1);
  CHECK(gaps.warnings[0].find("3 numbers") != std::string::npos);
  CHECK(std::isnan(gaps.sections[0].rows[0].values[0]));
  CHECK(gaps.sections[0].rows[0].values[1] == 2.0);

  const PointFile cut = parse_point_file(ours.substr(0, ours.size() - 5), "p.x");
  CHECK(cut.sections[0].rows.size() == 1);
  REQUIRE(cut.warnings.size() == 1);
  CHECK(cut.warnings[0].find("p.x:13") != std::string::npos);
}

TEST_CASE("files that are no p-files or are damaged are refused with their line") {
  struct Bad {
    std::string text, expected;
  };
  for (const Bad& bad :
       {Bad{"", "no point"}, Bad{"   0\n   0\n", "no point"}, Bad{"hello\n", "p.x:1"},
        Bad{"   1  1  9  x  1.0\n", "LAB"}, Bad{"   1  1  9  1\n", "p.x:1"}, Bad{"   1  1  9  1  1.0  abc\n", "'abc'"},
        Bad{"   1  1  9  1  1.0  2.0\n   1  2  0  0  1.0\n", "p.x:2: 1 values"}}) {
    INFO(bad.text);
    const std::string message = message_of<UserError>([&] { parse_point_file(bad.text, "p.x"); });
    INFO(message);
    CHECK(message.find(bad.expected) != std::string::npos);
  }
  CHECK(message_of<UserError>([] { read_point_file("/nowhere/p.x"); }).find("/nowhere/p.x") != std::string::npos);
}

TEST_CASE("a p-file cut or changed anywhere is read or refused") {
  std::mt19937 random(1);
  for (const std::string& text : {ours, auto_07p, auto_97}) {
    for (std::size_t length = 0; length < text.size(); ++length) {
      try {
        parse_point_file(text.substr(0, length), "p.x");
      } catch (const UserError&) {
      }
    }
    for (int trial = 0; trial < 2000; ++trial) {
      std::string changed = text;
      for (int k = 0; k < 3; ++k)
        changed[random() % changed.size()] = static_cast<char>(std::string(" 09.-E\n'{}=,x")[random() % 13]);
      try {
        for (const PointSection& section : parse_point_file(changed, "p.x").sections)
          for (const PointRow& row : section.rows) REQUIRE(row.values.size() == section.columns.size());
      } catch (const UserError&) {
      }
    }
  }
}

TEST_CASE("kinds of files are told apart by their first line") {
  CHECK(looks_like_point_file(ours));
  CHECK(looks_like_point_file("   1     1   9    1  1.0E+00\n"));
  CHECK_FALSE(looks_like_point_file(
      "     1     1     9     1     2     1     201     5     402   50    4  100    4    4  180    0\n"));
  CHECK_FALSE(looks_like_point_file(""));
}

TEST_CASE("header lines of any length are read on a small stack") {
  std::string names;
  for (int k = 1; k <= 2000; ++k) names += (k > 1 ? ", " : "") + std::to_string(k) + ": 'p" + std::to_string(k) + "'";
  const std::string text = "   0   NDIM=   4   IPS = 180   parnames = {" + names + "}\n   0\n   0    PT  TY  LAB " +
                           std::string(100'000, ' ') + "alpha\n   1     1   9    1  1.0000000000E+000\n";
  PointFile file;
  const auto read = [&] { file = parse_point_file(text, "p.x"); };
  REQUIRE(call_on_small_stack(read));
  REQUIRE(file.sections.size() == 1);
  CHECK(file.sections[0].problem_type == 180);
  CHECK(file.sections[0].parameter_name(2000) == "p2000");
}
