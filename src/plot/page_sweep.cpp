#include "plot/page_sweep.hpp"

#include <fmt/format.h>

#include <vector>

#include "motion/attractor_kind.hpp"
#include "plot/page_json.hpp"

namespace tchat {

namespace {

constexpr std::size_t most_sweep_numbers = 400'000;

}  // namespace

std::string sweep_json(const SweepFile& file) {
  const SweepTable& table = file.table;
  const bool is_written = table.rows() * (table.names.size() + 1) <= most_sweep_numbers;
  std::vector<std::string> names, columns;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    names.push_back(page_text(table.names[c]));
    if (is_written) columns.push_back(page_list(table.columns[c], [](double value) { return page_number(value); }));
  }
  names.push_back(page_text("kind"));
  if (is_written)
    columns.push_back(page_list(table.kinds, [](AttractorKind kind) { return page_text(to_string(kind)); }));
  const auto parameter = [](const std::pair<std::string, double>& one) {
    return page_list({page_text(one.first), page_number(one.second)});
  };
  return page_object({{"name", page_text(file.name)},
                      {"columns", page_list(names)},
                      {"values", is_written ? page_list(columns) : "null"},
                      {"fixed", page_list(table.parameters, parameter)}});
}

}  // namespace tchat
