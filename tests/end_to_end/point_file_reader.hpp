/// A strict reader of p-files, written from the description of the format alone: what it returns went through checks of
/// every header line, every count and every column; a violation fails the test that reads.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace test_support {

struct PointRow {
  int branch = 0, point = 0, type = 0, label = 0;  ///< point signed
  std::vector<double> values;
};

struct PointSection {
  std::map<std::string, std::string> constants;  ///< KEY -> text of the value
  std::vector<double> bounds;                    ///< RL0 RL1 A0 A1
  std::vector<std::string> names;                ///< of the columns after LAB
  std::vector<PointRow> rows;

  int integer(const std::string& key) const;
  double real(const std::string& key) const;
  /// The column of that name; fails the test when there is none.
  std::size_t column(const std::string& name) const;
};

std::vector<PointSection> read_points(const std::string& text);

}  // namespace test_support
