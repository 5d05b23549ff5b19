/// Tables for other programs in CSV and JSON.
#pragma once

#include <complex>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tchat {

// Tables for other programs: CSV as RFC 4180 has it but for the line ends, which are those of Unix, and JSON.

/// One value; the first alternative is "not known".
using TableCell = std::variant<std::monostate, bool, int, double, std::string>;

/// As a CSV field: numbers with the digits from which they are read back exactly, truth as 1 or 0, infinity as inf or
/// -inf, text in quotes where it must be. Empty when not known or NaN.
std::string csv_field(const TableCell& cell);

/// As a JSON value: null when not known and for numbers that are not finite, which JSON does not have.
std::string json_value(const TableCell& cell);

/// Fields separated by commas, with a newline.
std::string csv_line(const std::vector<std::string>& fields);

/// The headings as they can stand in one table: one that is there already gets a number, "t" -> "t (2)".
std::vector<std::string> distinct_headings(const std::vector<std::string>& headings);
/// A heading of tchat's own beside headings that a problem gives, which stay what they are: `name`, with '_' behind it
/// while one of them is the same.
std::string own_heading(std::string name, const std::vector<std::string>& given);

// One way to write any table: each format is a TableWriter, and a row in the list of formats.

/// A list of complex numbers in one place of a table; not known where it is empty.
using ComplexList = std::vector<std::complex<double>>;
using TableValue = std::variant<TableCell, ComplexList>;

struct TableColumn {
  std::string name;
  std::size_t most = 0;      ///< of lists: how many numbers one has at most
  std::string element = {};  ///< what one of them is called, for formats without lists
};

class TableWriter {
 public:
  virtual ~TableWriter() = default;
  virtual void begin(const std::vector<TableColumn>& columns) = 0;
  /// A value for each column.
  virtual void row(const std::vector<TableValue>& values) = 0;
  virtual void end() {}
};

struct TableFormatName {
  const char* option;  ///< of `tchat table`
  const char* what;
  std::unique_ptr<TableWriter> (*make)(std::ostream&);
};

/// The first one is the default.
std::span<const TableFormatName> table_formats();

}  // namespace tchat
