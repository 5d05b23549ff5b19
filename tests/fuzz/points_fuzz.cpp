// p-files: every row of a section has a value for each column.

#include "files/point_file_reader.hpp"
#include "fuzz_target.hpp"

using namespace tchat;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  looks_like_point_file(text);
  PointFile file;
  if (!fuzz::accepts([&] { file = parse_point_file(text, fuzz::source); })) return 0;
  for (const std::string& warning : file.warnings) fuzz::require_readable(warning);
  fuzz::require(!file.sections.empty(), "a p-file has sections");
  for (const PointSection& section : file.sections) {
    fuzz::require(!section.rows.empty(), "a section has points");
    for (const PointRow& row : section.rows)
      fuzz::require(row.values.size() <= section.columns.size(), "no value without a column");
    for (const int k : section.active_parameters) fuzz::require(!section.parameter_name(k).empty(), "a name");
    for (int k = 1; k <= section.dimension && k <= 20; ++k) fuzz::require(!section.state_name(k).empty(), "a name");
    for (std::size_t k = 0; k < section.columns.size(); ++k) {
      fuzz::require(!section.columns[k].empty(), "a column has a name");
      section.parameter_of_column(k);
    }
    section.free_problem_parameters();
    section.is_two_parameter_curve();
    section.has_stability();
  }
  return 0;
}
