#include "plot/quantity_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "files/table_format.hpp"
#include "plot/branch_quantity.hpp"

namespace tchat {

namespace {

/// One quantity in all sections.
struct Quantity {
  std::string name;
  std::size_t arms = 0;  // the most that a section has
  std::vector<BranchQuantity> sections;

  TableCell cell(std::size_t section, std::size_t row, std::size_t arm) const {
    const BranchQuantity& values = sections[section];
    if (arm >= values.arms.size()) return {};
    const double value = values.arms[arm][row];
    return std::isfinite(value) ? TableCell(value) : TableCell();
  }
};

Quantity read(const BranchFile& file, const std::string& name, const char* option) {
  Quantity quantity{name, 0, {}};
  for (std::size_t s = 0; s < file.sections.size(); ++s) {
    quantity.sections.push_back(read_quantity(file, s, name, option));
    quantity.arms = std::max(quantity.arms, quantity.sections.back().arms.size());
  }
  return quantity;
}

}  // namespace

void write_quantity_table(TableWriter& out, const BranchFile& file, const std::vector<std::string>& wanted,
                          const char* option) {
  std::vector<Quantity> quantities;
  std::vector<std::string> headings{"section", "point"};
  for (const std::string& name : wanted) {
    quantities.push_back(read(file, name, option));
    headings.insert(headings.end(), quantities.back().arms, name);
  }
  std::vector<TableColumn> columns;
  for (const std::string& heading : distinct_headings(headings)) columns.push_back({heading});
  out.begin(columns);
  for (std::size_t s = 0; s < file.sections.size(); ++s)
    for (std::size_t row = 0; row < file.sections[s].rows.size(); ++row) {
      std::vector<TableValue> values{TableCell(static_cast<int>(s) + 1),
                                     TableCell(std::abs(file.sections[s].rows[row].point))};
      for (const Quantity& quantity : quantities)
        for (std::size_t arm = 0; arm < quantity.arms; ++arm) values.emplace_back(quantity.cell(s, row, arm));
      out.row(values);
    }
  out.end();
}

}  // namespace tchat
