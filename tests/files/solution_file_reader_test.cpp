#include "files/solution_file_reader.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "base/messages.hpp"
#include "files/sample_solutions.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::SampleEntry;

namespace {

// AUTO 97: 12 integers, two exponent digits, all parameters; NDIM = 2, NTST = 1, NCOL = 2, NPAR = 3.
const std::string older_entry =
    "     1    12     5     3     2     1       3     3       9    1    2    3\n"
    "       0.0000000000E+00   1.0000000000E+00  -2.0000000000E+00\n"
    "       5.0000000000E-01   1.5000000000E+00  -2.5000000000D+00\n"
    "       1.0000000000E+00   1.7500000000-100  -3.0000000000E+00\n"
    "    1   61\n"
    "       2.5000000000E-01  -1.0000000000E+00\n"
    "       1.0000000000E+00   4.0000000000E+00\n"
    "       2.0000000000E+00   5.0000000000E+00\n"
    "       3.0000000000E+00   6.0000000000E+00\n"
    "       7.0000000000E+00   8.0000000000E+00   9.0000000000E+00\n";

}  // namespace

TEST_CASE("A solution of the older generation, 12 integers", "[start]") {
  std::string entry = older_entry;
  entry.replace(entry.find("61"), 2, " 3");  // NPAR is 3
  const SolutionFile file = parse_solution_file(entry, "q.x");
  REQUIRE(file.solutions.size() == 1);
  CHECK(file.warnings.empty());
  const LabelledSolution& s = file.solutions[0];
  CHECK(s.branch == 1);
  CHECK(s.point == 12);
  CHECK(s.type == 5);
  CHECK(s.label == 3);
  CHECK(s.branch_mode == 1);
  CHECK(s.problem_type == 0);
  CHECK(s.dimension == 0);
  CHECK(s.mesh_intervals == 1);
  CHECK(s.collocation_points == 2);
  CHECK(s.tau == std::vector<double>{0.0, 0.5, 1.0});
  CHECK(s.states(0, 1) == 1.5);
  CHECK(s.states(1, 1) == -2.5);
  CHECK(s.states(0, 2) == 1.75e-100);
  CHECK(s.free_parameters == std::vector<int>{1, 3});
  CHECK(s.parameter_direction == std::vector<double>{0.25, -1.0});
  CHECK(s.state_direction(1, 0) == 4.0);
  CHECK(s.state_direction(0, 2) == 3.0);
  CHECK(s.parameters == std::vector<double>{7.0, 8.0, 9.0});
  CHECK(s.kind.kind == UserPointKind::none);
  CHECK(segment_count(s) == 0);
}

TEST_CASE("A solution of ours: segments, direction, internal values", "[start]") {
  SampleEntry entry;
  entry.segments = 3;
  entry.dimension = 3;
  entry.free_parameters = {2, 61, 62, 63};
  entry.type = -4;
  entry.internal = {2, 3, 1, 0.625};
  const SolutionFile file = parse_solution_file(entry.text(), "q.x");
  REQUIRE(file.solutions.size() == 1);
  const LabelledSolution& s = file.solutions[0];
  CHECK(s.problem_type == 180);
  CHECK(s.dimension == 3);
  CHECK(segment_count(s) == 3);
  REQUIRE(s.states.rows() == 9);
  REQUIRE(s.states.cols() == 5);
  CHECK(s.has_direction());
  for (int r = 0; r < 9; ++r)
    for (int p = 0; p < 5; ++p) {
      CHECK(s.states(r, p) == SampleEntry::state(r, p));
      CHECK(s.state_direction(r, p) == SampleEntry::state_direction(r, p));
    }
  CHECK(s.free_parameters == entry.free_parameters);
  CHECK(s.parameter_direction == std::vector<double>{0.5, 15.25, 15.5, 15.75});
  REQUIRE(s.parameters.size() == 100);
  CHECK(s.parameters[0] == 1.0);
  CHECK(s.parameters[99] == 100.0);
  CHECK(period(s) == 61.0 + 62.0 + 63.0);
  CHECK(s.kind.kind == UserPointKind::contact);
  CHECK(s.kind.segment == 3);
  CHECK(s.kind.index == 1);
  CHECK(s.kind.tau == 0.625);
}

TEST_CASE("Without direction, with many free parameters, in sequence, both generations in one file", "[start]") {
  SampleEntry plain;
  plain.label = 4;
  plain.direction = false;
  SampleEntry many;
  many.label = 7;
  many.free_parameters.clear();
  for (int k = 1; k <= 23; ++k) many.free_parameters.push_back(k);
  std::string older = older_entry;
  older.replace(older.find("61"), 2, " 2");
  const std::string text = plain.text() + many.text() + older;
  const SolutionFile file = parse_solution_file(text, "q.x");
  REQUIRE(file.solutions.size() == 3);
  CHECK_FALSE(file.solutions[0].has_direction());
  CHECK(file.solutions[0].free_parameters.empty());
  CHECK(file.solutions[1].free_parameters == many.free_parameters);
  CHECK(file.solutions[2].label == 3);
  CHECK(file.last_label == 7);
  CHECK(file.complete_bytes == text.size());
}

TEST_CASE("Free format: other widths, CRLF, blank lines at the end", "[start]") {
  const std::string text =
      " 1 2 9 1 1 1 2 2 6 1 1 2 0 1 2 0\r\n0 1.5\r\n1. 2d0\r\n 2\r\n1\r\n 0.5 -0.5\r\n3 4.25\r\n\r\n\n";
  const SolutionFile file = parse_solution_file(text, "q.x");
  REQUIRE(file.solutions.size() == 1);
  CHECK(file.solutions[0].states(0, 1) == 2.0);
  CHECK(file.solutions[0].state_direction(0, 1) == -0.5);
  CHECK(file.solutions[0].parameters[1] == 4.25);
  CHECK(file.complete_bytes == text.size());
}

TEST_CASE("A line without solution carries the largest branch and label", "[start]") {
  const std::string last =
      "     7     0     0    31     0     0       0     0       0    0    0    0    0    0    0    0\n";
  const SolutionFile file = parse_solution_file(SampleEntry().text() + last, "q.x");
  CHECK(file.solutions.size() == 1);
  CHECK(file.last_branch == 7);
  CHECK(file.last_label == 31);
  CHECK(file.warnings.empty());
  const SolutionFile longer = parse_solution_file(last + SampleEntry().text(), "q.x");
  CHECK(longer.solutions.size() == 1);
  CHECK(longer.last_label == 31);
}

TEST_CASE("An algebraic solution of AUTO is read", "[start]") {
  const std::string text =
      "     1     1     9     1     1     1       1     3       2    0    0    2    0    2    1    0\n"
      "      0.0000000000E+000  1.0000000000E+000  2.0000000000E+000\n"
      "      3.0000000000E+000  4.0000000000E+000\n";
  const SolutionFile file = parse_solution_file(text, "q.x");
  REQUIRE(file.solutions.size() == 1);
  CHECK(file.solutions[0].states(1, 0) == 2.0);
  CHECK(file.solutions[0].parameters[1] == 4.0);
}

TEST_CASE("No file, no solutions", "[start]") {
  const test_support::TemporaryFolder folder;
  CHECK(read_solution_file(folder.write("q.empty", "")).solutions.empty());
  CHECK_THAT(message_of<UserError>([&] { read_solution_file(folder.file("q.none")); }), Contains("no such file"));
  CHECK_THAT(message_of<UserError>([&] { read_solution_file(folder.file(".")); }), Contains("is a directory"));
}

TEST_CASE("The prefix q. may be left out", "[start]") {
  const test_support::TemporaryFolder folder;
  folder.write("q.mems", "");
  folder.write("q.both", "");
  folder.write("both", "");
  CHECK(resolve_solution_path(folder.file("mems")) == folder.file("q.mems"));
  CHECK(resolve_solution_path(folder.file("both")) == folder.file("both"));
  CHECK(resolve_solution_path(folder.file("q.mems")) == folder.file("q.mems"));
  CHECK(resolve_solution_path(folder.file("none")) == folder.file("none"));
}

namespace {

LabelledSolution labelled(int label, int type, int kind = UserPointKind::none) {
  LabelledSolution s;
  s.label = label;
  s.type = type;
  s.kind.kind = kind;
  return s;
}

std::vector<LabelledSolution> branch() {
  return {labelled(1, 9),
          labelled(2, -4, UserPointKind::contact),
          labelled(3, -4, UserPointKind::user_value),
          labelled(4, 7),
          labelled(5, -4, UserPointKind::xi),
          labelled(6, -4, UserPointKind::impact_velocity),
          labelled(7, 54),
          labelled(8, -54, UserPointKind::none),
          labelled(9, 77),
          labelled(10, 7),
          labelled(11, 55),
          labelled(12, -59),
          labelled(13, 0)};
}

int found(const std::string& type, int number) { return find_solution(branch(), {type, number}, "q.x").label; }

}  // namespace

TEST_CASE("Solutions are found by label and by type with count", "[start]") {
  CHECK(found("", 6) == 6);
  CHECK(found("EP", 1) == 1);
  CHECK(found("UZ", 1) == 3);
  CHECK(found("UZ", 2) == 8);
  CHECK(found("GR", 1) == 2);
  CHECK(found("GR", 2) == 6);
  CHECK(found("XI", 1) == 5);
  CHECK(found("PD", 1) == 4);
  CHECK(found("PD", 2) == 10);
  CHECK(found("RG", 1) == 7);
  CHECK(found("LP", 1) == 11);
  CHECK(found("MX", 1) == 12);
}

TEST_CASE("Read for one label: the same solution, others passed over, damage of the file told", "[start]") {
  std::string text;
  for (int label = 1; label <= 6; ++label) {
    SampleEntry entry;
    entry.label = label;
    entry.type = label % 3 == 0 ? -4 : label % 2 == 0 ? 7 : 9;
    if (entry.type == -4) entry.internal = {label == 3 ? 2.0 : 1.0, 1, 1, 0.625};  // a contact, a user value
    text += entry.text();
  }
  const SolutionFile all = parse_solution_file(text, "q.x");
  REQUIRE(all.solutions.size() == 6);
  struct Asked {
    StartLabel label;
    std::size_t kept;
  };
  for (const auto& [label, kept] : {Asked{{"", 4}, 1}, Asked{{"PD", 2}, 2}, Asked{{"GR", 1}, 1}, Asked{{"EP", 1}, 2}}) {
    const SolutionFile file = parse_solution_file(text, "q.x", label);
    CHECK(file.solutions.size() == kept);
    const LabelledSolution& wanted = find_solution(all.solutions, label, "q.x");
    const LabelledSolution& s = find_solution(file.solutions, label, "q.x");
    CHECK(s.label == wanted.label);
    CHECK(s.states == wanted.states);
    CHECK(s.parameters == wanted.parameters);
    CHECK(s.kind.tau == wanted.kind.tau);
    CHECK(file.last_label == 6);
    CHECK(file.complete_bytes == text.size());
  }
  // None is meant: all are there, for the list of labels.
  CHECK(parse_solution_file(text, "q.x", {"", 9}).solutions.size() == 6);
  CHECK(parse_solution_file(text, "q.x", {"PD", 3}).solutions.size() == 6);

  const StartLabel first{"", 1};
  std::string cut = text.substr(0, text.size() - 30);
  CHECK(parse_solution_file(cut, "q.x", first).warnings == parse_solution_file(cut, "q.x").warnings);
  CHECK(parse_solution_file(cut, "q.x", first).warnings.size() == 1);
  CHECK(parse_solution_file(cut, "q.x", first).complete_bytes == parse_solution_file(cut, "q.x").complete_bytes);
  // A line too much in the second solution: the third does not begin where it should.
  const std::size_t second = text.find('\n', text.size() / 6 + 200) + 1;
  std::string longer = text;
  longer.insert(second, " 1.0\n");
  CHECK_THAT(message_of<UserError>([&] { parse_solution_file(longer, "q.x", first); }),
             Contains("begins with a line of 16 integers"));
  // Damage in the solution that is wanted.
  std::string bad = text;
  bad.replace(bad.find("E+000", 400), 5, "X+000");
  CHECK_THAT(message_of<UserError>([&] { parse_solution_file(bad, "q.x", first); }), Contains("not a finite number"));
}

TEST_CASE("A label that does not exist is answered with those that do", "[start]") {
  const std::string by_number = message_of<UserError>([] { found("", 99); });
  CHECK_THAT(by_number, Contains("q.x: no label 99"));
  CHECK_THAT(by_number, Contains("1 (EP), 2 (GR), 3 (UZ), 4 (PD), 5 (XI)"));
  CHECK_THAT(by_number, Contains("12 (MX), 13"));
  CHECK_THAT(message_of<UserError>([] { found("PD", 3); }), Contains("no point PD3"));
  CHECK_THAT(message_of<UserError>([] { found("TR", 1); }), Contains("no point TR1"));
  const std::vector<LabelledSolution> none;
  CHECK_THAT(message_of<UserError>([&] { find_solution(none, {"", 1}, "q.x"); }), Contains("holds no solution"));
}

TEST_CASE("Segments of older files follow from the free durations", "[start]") {
  LabelledSolution s = labelled(1, 9);
  s.states.resize(10, 3);
  s.tau = {0.0, 0.5, 1.0};
  s.free_parameters = {1, 61, 62};
  s.parameters.assign(100, 0.0);
  s.parameters[60] = 1.5;
  s.parameters[61] = 0.25;
  CHECK(segment_count(s) == 2);
  CHECK(period(s) == 1.75);
  s.free_parameters = {1, 11};
  CHECK(segment_count(s) == 0);
}

TEST_CASE("A solution that is several things at once is found by each of its names", "[start]") {
  std::vector<LabelledSolution> solutions{labelled(1, 6), labelled(2, -4, UserPointKind::contact), labelled(3, 6)};
  solutions[0].further = {{UserPointKind::contact, 2, 1, 0.25}, {UserPointKind::other_type, 0, 5, 0.0}};
  solutions[1].further = {{UserPointKind::user_value, 0, 3, 0.0}, {UserPointKind::contact, 1, 1, 0.5}};
  const auto label = [&](const std::string& type, int number) {
    return find_solution(solutions, {type, number}, "q.x").label;
  };
  CHECK(label("BP", 1) == 1);
  CHECK(label("GR", 1) == 1);
  CHECK_THROWS_AS(label("LP", 1), UserError);  // at a branch point a branch turns by its symmetry
  CHECK(label("GR", 2) == 2);                  // two contacts at once count once
  CHECK(label("UZ", 1) == 2);
  CHECK(label("BP", 2) == 3);
  CHECK_THAT(message_of<UserError>([&] { label("GR", 3); }), Contains("1 (BP GR), 2 (GR UZ), 3 (BP)"));
  CHECK(basic_types(solutions[0], "GR") == std::vector<int>{6, -4});
  CHECK(description(solutions[1], [](int) { return "omega"; }) ==
        "contact inside segment 0, event function 0, tau = 0; user value of omega; contact inside segment 1, event "
        "function 1, tau = 0.5");
}

TEST_CASE("Internal values of several kinds", "[start]") {
  SampleEntry entry;
  entry.internal = {0, 0, 0, 0, 2, 1, 1, 0.625, 6, 0, -5, 0};
  entry.parameters = 112;
  const SolutionFile file = parse_solution_file(entry.text(), "q.x");
  REQUIRE(file.solutions.size() == 1);
  const LabelledSolution& s = file.solutions[0];
  CHECK(s.kind.kind == UserPointKind::none);
  REQUIRE(s.further.size() == 2);
  CHECK(s.further[0] == UserPointKind{UserPointKind::contact, 1, 1, 0.625});
  CHECK(s.further[1] == UserPointKind{UserPointKind::other_type, 0, -5, 0.0});
  CHECK(s.parameters.size() == 100);
}
