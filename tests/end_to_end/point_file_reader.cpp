#include "end_to_end/point_file_reader.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

namespace test_support {

namespace {

constexpr std::size_t prefix = 19;  // BR I4, PT I6, TY I4, LAB I5
constexpr std::size_t width = 19;   // of a number

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool is_header(const std::string& line) { return line.compare(0, 4, "   0") == 0; }

/// One field of a line that must be right-justified digits.
int integer_field(const std::string& line, std::size_t begin, std::size_t length) {
  static const std::regex pattern(" *-?[0-9]+");
  const std::string field = line.substr(begin, length);
  INFO("columns " << begin + 1 << " to " << begin + length << " of: " << line);
  REQUIRE(std::regex_match(field, pattern));
  return std::stoi(field);
}

PointRow read_row(const std::string& line, std::size_t columns) {
  static const std::regex pattern(" +-?[0-9]\\.[0-9]{10}E[+-][0-9]{3}");
  INFO(line);
  REQUIRE(line.size() == prefix + width * columns);
  PointRow row{
      integer_field(line, 0, 4), integer_field(line, 4, 6), integer_field(line, 10, 4), integer_field(line, 14, 5), {}};
  REQUIRE(std::count(line.begin(), line.end(), '.') == static_cast<std::ptrdiff_t>(columns));
  for (std::size_t k = 0; k < columns; ++k) {
    const std::string field = line.substr(prefix + k * width, width);
    REQUIRE(std::regex_match(field, pattern));
    row.values.push_back(std::stod(field));
  }
  return row;
}

/// KEY = value pairs; a value is a number, a list in [] or a dictionary in {}.
void read_constants(const std::string& line, std::map<std::string, std::string>& constants) {
  static const std::regex pattern("([A-Za-z0-9]+) *= *(\\[.*\\]|\\{[^}]*\\}|[^ ]+)");
  for (std::sregex_iterator it(line.begin(), line.end(), pattern), end; it != end; ++it) {
    INFO("constant " << (*it)[1]);
    REQUIRE(constants.count((*it)[1]) == 0);
    constants[(*it)[1]] = (*it)[2];
  }
}

/// Columns as wide as the numbers, counted from the right end of the data as other readers do.
std::vector<std::string> read_names(const std::string& line, std::size_t data_width) {
  REQUIRE(line.compare(0, 20, "   0    PT  TY  LAB ") == 0);
  REQUIRE(data_width > prefix);
  std::vector<std::string> names;
  for (std::size_t at = prefix; at < data_width; at += width)
    names.push_back(trimmed(at < line.size() ? line.substr(at, width) : ""));
  for (const std::string& name : names) REQUIRE_FALSE(name.empty());
  REQUIRE(trimmed(line.size() > data_width ? line.substr(data_width) : "").empty());
  return names;
}

void read_bounds(const std::string& line, PointSection& section) {
  static const std::regex pattern("   0 ( *-?[0-9]\\.[0-9]{4}(E[+-][0-9]{2}|[+-][0-9]{3})){4}");
  INFO(line);
  REQUIRE(std::regex_match(line, pattern));
  REQUIRE(line.size() == 5 + 4 * 12);
  for (std::size_t k = 0; k < 4; ++k) {
    std::string number = trimmed(line.substr(5 + 12 * k, 12));
    if (number.find('E') == std::string::npos) number.insert(number.find_last_of("+-"), "E");
    section.bounds.push_back(std::stod(number));
  }
}

/// The constants that every section must tell.
void check_constants(const PointSection& section) {
  for (const char* key : {"EPSL", "EPSU", "EPSS", "DS",   "DSMIN", "DSMAX", "NDIM", "IPS", "IRS", "ILP",  "NTST",
                          "NCOL", "IAD",  "ISP",  "ISW",  "IPLT",  "NBC",   "NINT", "NMX", "NPR", "MXBF", "IID",
                          "IADS", "ITMX", "ITNW", "NWTN", "JAC",   "NUZR",  "NPAR", "THL", "THU"}) {
    INFO("constant " << key);
    REQUIRE(section.constants.count(key) == 1);
  }
}

void check_rows(const PointSection& section) {
  int number = 0;
  for (const PointRow& row : section.rows) {
    INFO("point " << row.point);
    REQUIRE(std::abs(row.point) == number % 9999 + 1);
    ++number;
    REQUIRE(row.branch == section.rows.front().branch);
    REQUIRE(row.branch >= 1);
    REQUIRE((row.label > 0) == (row.type != 0));
  }
}

}  // namespace

int PointSection::integer(const std::string& key) const { return std::stoi(constants.at(key)); }
double PointSection::real(const std::string& key) const { return std::stod(constants.at(key)); }

std::size_t PointSection::column(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  INFO("column " << name);
  REQUIRE(found != names.end());
  return static_cast<std::size_t>(found - names.begin());
}

std::vector<PointSection> read_points(const std::string& text) {
  REQUIRE_FALSE(text.empty());
  REQUIRE(text.back() == '\n');
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);

  std::vector<PointSection> sections;
  std::size_t at = 0;
  while (at < lines.size()) {
    PointSection section;
    REQUIRE(is_header(lines[at]));
    read_bounds(lines[at++], section);
    while (at < lines.size() && lines[at] != "   0") {
      REQUIRE(is_header(lines[at]));
      read_constants(lines[at++], section.constants);
    }
    REQUIRE(at + 2 < lines.size());  // the bare line, the headings and a point
    const std::string& headings = lines[at + 1];
    const std::size_t data_width = lines[at + 2].size();
    REQUIRE((data_width - prefix) % width == 0);
    section.names = read_names(headings, data_width);
    for (at += 2; at < lines.size() && !is_header(lines[at]); ++at)
      section.rows.push_back(read_row(lines[at], section.names.size()));
    check_constants(section);
    check_rows(section);
    sections.push_back(std::move(section));
  }
  return sections;
}

}  // namespace test_support
