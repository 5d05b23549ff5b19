// q-files: counts agree with what was read, every label is found again, complete entries do not depend on what follows.

#include <cmath>

#include "files/solution_file_reader.hpp"
#include "fuzz_target.hpp"
#include "settings/constant_value.hpp"

using namespace tchat;

namespace {

void check(const LabelledSolution& solution) {
  const auto points = static_cast<Eigen::Index>(solution.tau.size());
  fuzz::require(solution.states.cols() == points, "a column of states for each time");
  fuzz::require(solution.states.allFinite(), "finite states");
  for (const double value : solution.parameters) fuzz::require(std::isfinite(value), "finite parameters");
  if (solution.has_direction())
    fuzz::require(
        solution.state_direction.rows() == solution.states.rows() && solution.state_direction.cols() == points,
        "a direction like the states");
  fuzz::require(segment_count(solution) >= 0 && std::isfinite(period(solution)), "segments and period");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  SolutionFile file;
  if (!fuzz::accepts([&] { file = parse_solution_file(text, fuzz::source); })) return 0;
  for (const std::string& warning : file.warnings) fuzz::require_readable(warning);
  fuzz::require(file.complete_bytes <= size, "complete entries lie within the text");
  for (const LabelledSolution& solution : file.solutions) {
    check(solution);
    StartLabel wanted;
    wanted.number = solution.label;
    if (solution.label > 0)
      fuzz::require(find_solution(file.solutions, wanted, fuzz::source).label == solution.label, "labels are found");
  }
  const auto names = counted_names(file.solutions);
  for (std::size_t k = 0; k < names.size(); ++k)
    for (const std::string& name : names[k])
      if (const auto wanted = parse_typed_label(name))
        fuzz::require(&find_solution(file.solutions, *wanted, fuzz::source) == &file.solutions[k], "names are found");
  StartLabel absent;
  absent.type = "PD";
  absent.number = 7;
  fuzz::accepts([&] { find_solution(file.solutions, absent, fuzz::source); });
  const SolutionFile complete = parse_solution_file(text.substr(0, file.complete_bytes), fuzz::source);
  fuzz::require(complete.solutions.size() == file.solutions.size(), "complete entries stand by themselves");
  return 0;
}
