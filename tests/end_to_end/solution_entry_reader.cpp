#include "end_to_end/solution_entry_reader.hpp"

#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

namespace test_support {

namespace {

/// Hands out lines and the fixed-width numbers on them.
class LineReader {
 public:
  explicit LineReader(const std::string& text) : in_(text) {}

  bool at_end() { return in_.peek() == std::istringstream::traits_type::eof(); }
  int line_number() const { return number_; }

  std::string line() {
    std::string text;
    REQUIRE(std::getline(in_, text));
    ++number_;
    return text;
  }

  /// `count` numbers, seven to a line after four blanks, beginning on a new line.
  std::vector<double> reals(std::size_t count) {
    static const std::regex pattern(" +-?[0-9]\\.[0-9]{10}E[+-][0-9]{3}");
    return reals(count, 19, pattern);
  }

  /// The same, or with all digits, as the first line has them.
  std::vector<double> states(std::size_t count) {
    const auto here = in_.tellg();
    std::string text;
    std::getline(in_, text);
    in_.seekg(here);
    return text.size() == 4 + 26 * std::min<std::size_t>(7, count) ? exact_reals(count) : reals(count);
  }

  /// The same with all digits.
  std::vector<double> exact_reals(std::size_t count) {
    static const std::regex pattern(" +-?[0-9]\\.[0-9]{16}E[+-][0-9]{3}");
    return reals(count, 26, pattern);
  }

  /// `count` integers of five columns, twenty to a line.
  std::vector<int> integers(std::size_t count) {
    std::vector<int> values;
    while (values.size() < count) {
      const std::string text = line();
      const std::size_t here = std::min<std::size_t>(20, count - values.size());
      REQUIRE(text.size() == 5 * here);
      for (std::size_t k = 0; k < here; ++k) values.push_back(std::stoi(text.substr(5 * k, 5)));
    }
    return values;
  }

 private:
  std::vector<double> reals(std::size_t count, std::size_t width, const std::regex& pattern) {
    std::vector<double> values;
    while (values.size() < count) {
      const std::string text = line();
      const std::size_t here = std::min<std::size_t>(7, count - values.size());
      INFO("line " << number_ << ": " << text);
      REQUIRE(text.size() == 4 + width * here);
      REQUIRE(text.compare(0, 4, "    ") == 0);
      for (std::size_t k = 0; k < here; ++k) {
        const std::string field = text.substr(4 + width * k, width);
        REQUIRE(std::regex_match(field, pattern));
        values.push_back(std::stod(field));
      }
    }
    return values;
  }

  std::istringstream in_;
  int number_ = 0;
};

std::vector<int> read_identifier(const std::string& line) {
  static const std::vector<std::size_t> widths{6, 6, 6, 6, 6, 6, 8, 6, 8, 5, 5, 5, 5, 5, 5, 5};
  static const std::regex pattern(" *-?[0-9]+");
  INFO(line);
  REQUIRE(line.size() == 93);
  REQUIRE(line.front() == ' ');
  std::vector<int> values;
  std::size_t at = 0;
  for (const std::size_t width : widths) {
    const std::string field = line.substr(at, width);
    REQUIRE(std::regex_match(field, pattern));
    values.push_back(std::stoi(field));
    at += width;
  }
  return values;
}

SolutionEntry read_entry(LineReader& reader) {
  const std::vector<int> id = read_identifier(reader.line());
  const int first_line = reader.line_number();
  SolutionEntry entry;
  entry.branch = id[0], entry.point = id[1], entry.type = id[2], entry.label = id[3], entry.branch_mode = id[5];
  entry.intervals = id[9], entry.collocation = id[10], entry.dimension = id[13], entry.problem_type = id[14];
  const int free = id[4], points = id[6], states = id[7] - 1, lines = id[8], parameters = id[11], internal = id[12];
  REQUIRE(entry.branch >= 1);
  REQUIRE(entry.point >= 1);
  REQUIRE(points == entry.intervals * entry.collocation + 1);
  REQUIRE(states % entry.dimension == 0);
  REQUIRE(internal > 0);
  REQUIRE(internal % 4 == 0);
  entry.problem_parameters = id[15];
  REQUIRE((id[15] == 0 || id[15] >= 60));
  REQUIRE(parameters >= std::max(100, std::max(60, id[15]) + states / entry.dimension) + internal);
  const int plain = (states / 7 + 1) * points + (parameters + 6) / 7;
  const int direction = (free + 19) / 20 + (free + 6) / 7 + (states + 6) / 7 * points;
  REQUIRE((lines == plain || lines == plain + direction));

  for (int k = 0; k < points; ++k) {
    std::vector<double> record = reader.states(static_cast<std::size_t>(states) + 1);
    entry.t.push_back(record.front());
    record.erase(record.begin());
    entry.states.push_back(std::move(record));
  }
  REQUIRE(entry.t.front() == 0.0);
  REQUIRE(entry.t.back() == (points == 1 ? 0.0 : 1.0));  // an equilibrium is one point
  if (lines != plain) {
    entry.free_parameters = reader.integers(static_cast<std::size_t>(free));
    entry.parameter_direction = reader.reals(static_cast<std::size_t>(free));
    for (int k = 0; k < points; ++k) entry.direction.push_back(reader.states(static_cast<std::size_t>(states)));
  }
  entry.par = reader.exact_reals(static_cast<std::size_t>(parameters));
  entry.internal.assign(entry.par.end() - internal, entry.par.end());
  entry.par.resize(static_cast<std::size_t>(parameters - internal));
  REQUIRE(reader.line_number() - first_line == lines);
  return entry;
}

}  // namespace

std::vector<SolutionEntry> read_solutions(const std::string& text) {
  REQUIRE((text.empty() || text.back() == '\n'));
  std::vector<SolutionEntry> entries;
  for (LineReader reader(text); !reader.at_end();) entries.push_back(read_entry(reader));
  return entries;
}

}  // namespace test_support
