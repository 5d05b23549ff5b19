#include "files/solution_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "files/sample_orbits.hpp"
#include "files/solution_file_reader.hpp"

using namespace tchat;
using test_support::sample_orbit;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = text.find('\n', begin);
    REQUIRE(end != std::string::npos);  // the last line ends too
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

int integer_at(const std::string& line, std::size_t begin, std::size_t width) {
  const std::string field = line.substr(begin, width);
  REQUIRE(field.find_first_not_of(" -0123456789") == std::string::npos);
  REQUIRE(field[0] == ' ');
  return std::stoi(field);
}

/// A reader of one entry by columns, as its format is described: 6I6, I8, I6, I8, 7I5; 4X,7E19; 20I5; PAR 4X,7E26.
class FixedColumns {
 public:
  explicit FixedColumns(const std::string& text) : lines_(lines_of(text)) {
    const std::string& first = lines_.at(0);
    REQUIRE(first.size() == 93);
    const std::vector<std::size_t> widths = {6, 6, 6, 6, 6, 6, 8, 6, 8, 5, 5, 5, 5, 5, 5, 5};
    std::size_t begin = 0;
    for (const std::size_t width : widths) {
      identifier.push_back(integer_at(first, begin, width));
      begin += width;
    }
  }

  std::vector<double> numbers(int count, std::size_t width = 19) {
    std::vector<double> values;
    for (int k = 0; k < count; ++k) {
      if (k % 7 == 0) {
        REQUIRE(next_ < lines_.size());
        REQUIRE(lines_[next_].size() == 4 + width * static_cast<std::size_t>(std::min(7, count - k)));
        REQUIRE(lines_[next_].substr(0, 4) == "    ");
        ++next_;
      }
      const std::string field = lines_[next_ - 1].substr(4 + width * static_cast<std::size_t>(k % 7), width);
      REQUIRE(field[0] == ' ');
      REQUIRE(field[width - 5] == 'E');
      REQUIRE(field[width == 19 ? 3 : 4] == '.');
      values.push_back(std::stod(field));
    }
    return values;
  }

  std::vector<int> integers(int count) {
    std::vector<int> values;
    for (int k = 0; k < count; ++k) {
      if (k % 20 == 0) {
        REQUIRE(lines_.at(next_).size() == 5 * static_cast<std::size_t>(std::min(20, count - k)));
        ++next_;
      }
      values.push_back(integer_at(lines_[next_ - 1], 5 * static_cast<std::size_t>(k % 20), 5));
    }
    return values;
  }

  bool at_end() const { return next_ == lines_.size(); }
  int lines_after_first() const { return static_cast<int>(lines_.size()) - 1; }

  std::vector<int> identifier;

 private:
  std::vector<std::string> lines_;
  std::size_t next_ = 1;
};

/// Every number of the entry against the orbit it was made from.
void check_entry(const LabelledSolution& orbit) {
  const int states = static_cast<int>(orbit.states.rows());
  const int points = static_cast<int>(orbit.states.cols());
  const int segments = states / orbit.dimension;
  const int free = static_cast<int>(orbit.free_parameters.size());
  const int own = orbit.layout.parameters();
  const int parameters = std::max(100, (own > 60 ? own : 60) + segments) + 4;
  FixedColumns entry(format_solution(orbit));
  const std::vector<int> expected = {orbit.branch,
                                     (orbit.point - 1) % 9999 + 1,
                                     orbit.type,
                                     orbit.label,
                                     free,
                                     orbit.branch_mode,
                                     points,
                                     states + 1,
                                     entry.lines_after_first(),
                                     orbit.mesh_intervals,
                                     orbit.collocation_points,
                                     parameters,
                                     4,
                                     orbit.dimension,
                                     orbit.problem_type,
                                     own > 60 ? own : 0};
  CHECK(entry.identifier == expected);
  for (int p = 0; p < points; ++p) {
    const auto record = entry.numbers(states + 1);
    REQUIRE(record[0] == Approx(orbit.tau[static_cast<std::size_t>(p)]).epsilon(1e-10));
    for (int r = 0; r < states; ++r)
      REQUIRE(record[static_cast<std::size_t>(r) + 1] == Approx(orbit.states(r, p)).epsilon(1e-10));
  }
  if (orbit.has_direction()) {
    REQUIRE(entry.integers(free) == orbit.free_parameters);
    const auto rates = entry.numbers(free);
    for (std::size_t k = 0; k < rates.size(); ++k) REQUIRE(rates[k] == Approx(orbit.parameter_direction[k]));
    for (int p = 0; p < points; ++p) {
      const auto record = entry.numbers(states);
      for (int r = 0; r < states; ++r)
        REQUIRE(record[static_cast<std::size_t>(r)] == Approx(orbit.state_direction(r, p)).epsilon(1e-10));
    }
  }
  const auto par = entry.numbers(parameters, 26);
  for (std::size_t k = 0; k + 4 < par.size(); ++k)
    REQUIRE(par[k] == (k < orbit.parameters.size() ? orbit.parameters[k] : 0.0));
  CHECK(par[par.size() - 4] == orbit.kind.kind);
  CHECK(par[par.size() - 3] == orbit.kind.segment);
  CHECK(par[par.size() - 2] == orbit.kind.index);
  CHECK(par[par.size() - 1] == orbit.kind.tau);
  CHECK(entry.at_end());
}

}  // namespace

TEST_CASE("An entry written by hand, byte for byte", "[output]") {
  LabelledSolution orbit;
  orbit.branch = 1;
  orbit.point = 10001;
  orbit.type = -4;
  orbit.label = 12;
  orbit.dimension = 1;
  orbit.mesh_intervals = 1;
  orbit.collocation_points = 2;
  orbit.tau = {0.0, 0.5, 1.0};
  orbit.states.resize(1, 3);
  orbit.states << 1.0, -0.25, 1e-100;
  orbit.free_parameters = {2, 61};
  orbit.parameter_direction = {1.0, -2.0};
  orbit.state_direction.resize(1, 3);
  orbit.state_direction << 0.5, 0.0, 3.0;
  orbit.parameters = {3.14159265358979312, 2.0};
  orbit.kind = {UserPointKind::contact, 1, 2, 0.75};
  const auto zeros = [](int count) {
    std::string line = "    ";
    for (int k = 0; k < count; ++k) line += "   0.0000000000000000E+000";
    return line;
  };
  std::string expected =
      "     1     2    -4    12     2     1       3     2      23    1    2  104    4    1  180    0\n"
      "      0.0000000000E+000  1.0000000000E+000\n"
      "      5.0000000000E-001 -2.5000000000E-001\n"
      "      1.0000000000E+000  1.0000000000E-100\n"
      "    2   61\n"
      "      1.0000000000E+000 -2.0000000000E+000\n"
      "      5.0000000000E-001\n"
      "      0.0000000000E+000\n"
      "      3.0000000000E+000\n"
      "       3.1415926535897931E+000   2.0000000000000000E+000" +
      zeros(5).substr(4) + "\n";
  for (int line = 0; line < 13; ++line) expected += zeros(7) + "\n";
  expected += zeros(2) +
              "   2.0000000000000000E+000   1.0000000000000000E+000   2.0000000000000000E+000"
              "   7.5000000000000000E-001\n";
  CHECK(format_solution(orbit) == expected);
}

TEST_CASE("Columns, counts and numbers of entries of many sizes", "[output]") {
  for (const int n : {1, 2, 3, 5, 6, 7, 8, 13, 14})
    for (const int segments : {1, 2, 3, 7})
      for (const bool direction : {true, false}) {
        CAPTURE(n, segments, direction);
        LabelledSolution orbit = sample_orbit(n, segments, 3, 4);
        if (!direction) {
          orbit.state_direction.resize(0, 0);
          orbit.parameter_direction.clear();
        }
        check_entry(orbit);
      }
}

TEST_CASE("The largest number of segments: more free parameters than fit a line, NPAR beyond 100", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 64, 2, 2);
  orbit.kind = {UserPointKind::xi, 1, 5, 0.0};
  orbit.type = -74;
  orbit.branch_mode = 2;
  check_entry(orbit);
}

TEST_CASE("A parameter vector of full length is written when its unused end is zero", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 1, 2, 2);
  const std::string text = format_solution(orbit);
  orbit.parameters.resize(256, 0.0);
  CHECK(format_solution(orbit) == text);
  orbit.parameters[200] = 1.0;
  CHECK_THROWS_AS(format_solution(orbit), std::invalid_argument);
}

TEST_CASE("Parts that do not fit together are refused", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 1, 2, 2);
  orbit.mesh_intervals = 3;
  CHECK_THROWS_AS(format_solution(orbit), std::invalid_argument);
  orbit = sample_orbit(2, 1, 2, 2);
  orbit.parameter_direction.pop_back();
  CHECK_THROWS_AS(format_solution(orbit), std::invalid_argument);
  orbit = sample_orbit(3, 1, 2, 2);
  orbit.dimension = 2;
  CHECK_THROWS_AS(format_solution(orbit), std::invalid_argument);
  orbit = sample_orbit(2, 1, 2, 2);
  orbit.state_direction.resize(2, 4);
  CHECK_THROWS_AS(format_solution(orbit), std::invalid_argument);
}

TEST_CASE("No NaN or inf reaches the file", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 1, 2, 2);
  orbit.states(0, 1) = std::nan("");
  orbit.state_direction(1, 1) = std::numeric_limits<double>::infinity();
  const std::string text = format_solution(orbit);
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("NAN") == std::string::npos);
  CHECK(text.find("INF") == std::string::npos);
  const SolutionFile file = parse_solution_file(text, "q.x");
  CHECK(file.solutions.at(0).states(0, 1) == 1e99);
  CHECK(file.solutions.at(0).state_direction(1, 1) == 1e99);
}

TEST_CASE("What is written is read back, to ten decimals", "[output]") {
  LabelledSolution first = sample_orbit(4, 2, 5, 3);
  LabelledSolution second = sample_orbit(4, 1, 7, 2);
  second.label = 6;
  second.type = -4;
  second.kind = {UserPointKind::impact_velocity, 1, 1, 1.0};
  const SolutionFile file = parse_solution_file(format_solution(first) + format_solution(second), "q.x");
  REQUIRE(file.solutions.size() == 2);
  CHECK(file.warnings.empty());
  CHECK((file.solutions[0].states - first.states).cwiseAbs().maxCoeff() < 1e-10);
  CHECK((file.solutions[0].state_direction - first.state_direction).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(file.solutions[0].free_parameters == first.free_parameters);
  CHECK(segment_count(file.solutions[0]) == 2);
  CHECK(period(file.solutions[0]) == 3.5);
  CHECK(type_name(file.solutions[1]) == "GR");
  CHECK(file.solutions[1].kind.tau == 1.0);
  CHECK(file.last_label == 6);
  CHECK(file.last_branch == 2);
}

TEST_CASE("What is several things at once has four internal values for each", "[output]") {
  LabelledSolution orbit = sample_orbit(2, 3, 2, 2);
  orbit.type = 6;
  orbit.kind = {};
  orbit.further = {{UserPointKind::contact, 1, 2, 0.75}, {UserPointKind::other_type, 0, 5, 0.0}};
  const SolutionFile file = parse_solution_file(format_solution(orbit), "q.x");
  REQUIRE(file.solutions.size() == 1);
  CHECK(file.solutions[0].kind == UserPointKind{});
  CHECK(file.solutions[0].further == orbit.further);
  CHECK(file.solutions[0].parameters[0] == orbit.parameters[0]);
}

TEST_CASE("more than 60 parameters: the file says where the durations begin") {
  for (const int parameters : {60, 61, 99, 130, 700}) {
    CAPTURE(parameters);
    const LabelledSolution orbit = sample_orbit(3, 2, 4, 3, parameters);
    check_entry(orbit);
    const SolutionFile file = parse_solution_file(format_solution(orbit), "q.many");
    REQUIRE(file.solutions.size() == 1);
    const LabelledSolution& read = file.solutions.front();
    CHECK(read.layout.first_duration() == std::max(parameters, 60) + 1);
    CHECK(duration(read, 0) == 1.5);
    CHECK(duration(read, 1) == 2.0);
    CHECK(period(read) == 3.5);
    CHECK(read.free_parameters == orbit.free_parameters);
    CHECK(format_solution(read) == format_solution(orbit));
  }
  std::string damaged = format_solution(sample_orbit(3, 2, 4, 3, 130));
  damaged.replace(88, 5, " 9999");
  CHECK_THROWS_WITH(parse_solution_file(damaged, "q.many"),
                    Catch::Contains("no room for the durations PAR(10000..10001)"));
}

TEST_CASE("the rotation number of a torus has a place behind the durations where PAR(60) is a parameter") {
  for (const int parameters : {4, 59, 60, 61, 200}) {
    CAPTURE(parameters);
    LabelledSolution torus = sample_orbit(3, 7, 4, 3, parameters);
    torus.problem_type = invariant_torus.number;
    const int rho = torus.layout.rotation();
    torus.parameters.resize(static_cast<std::size_t>(std::max<int>(rho, static_cast<int>(torus.parameters.size()))));
    torus.parameters[static_cast<std::size_t>(rho - 1)] = 0.3819660112501051;
    torus.free_parameters.push_back(rho);
    torus.parameter_direction.push_back(0.5);
    const LabelledSolution read = parse_solution_file(format_solution(torus), "q.torus").solutions.at(0);
    CHECK(read.layout.rotation() == rho);
    CHECK(stored_parameter(read, read.layout.rotation()) == 0.3819660112501051);
    CHECK(duration(read, 6) == 4.5);
  }
}

TEST_CASE("a solution goes over into the numbering of a problem that has got more parameters, and back") {
  for (const int before : {4, 60, 61, 80})
    for (const int now : {4, 61, 80, 300}) {
      CAPTURE(before, now);
      const LabelledSolution orbit = sample_orbit(3, 2, 4, 3, before);
      const LabelledSolution placed = in_layout(orbit, ParameterLayout(now));
      CHECK(duration(placed, 0) == 1.5);
      CHECK(duration(placed, 1) == 2.0);
      for (int k = 1; k <= 4; ++k) CHECK(stored_parameter(placed, k) == stored_parameter(orbit, k));
      CHECK(placed.free_parameters == std::vector<int>{1, std::max(now, 60) + 1, std::max(now, 60) + 2});
      const LabelledSolution back = in_layout(placed, orbit.layout);
      CHECK(back.free_parameters == orbit.free_parameters);
      CHECK(period(back) == 3.5);
      if (now >= before) CHECK(stored_parameter(back, before) == stored_parameter(orbit, before));
    }
}
