/// One way to write any table: each format is a TableWriter, and a row in the list of formats.
#pragma once

#include <complex>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "files/table_format.hpp"

namespace tchat {

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
