#include "run/branch_output.hpp"

#include "run/run_file_outputs.hpp"
#include "run/screen_output.hpp"

namespace tchat {

std::vector<std::unique_ptr<BranchOutput>> branch_outputs(const BranchSection& section, RunFiles& files,
                                                          std::ostream* screen, std::ostream* terminal) {
  std::vector<std::unique_ptr<BranchOutput>> outputs;
  outputs.push_back(solution_file_output(section, files));
  outputs.push_back(point_file_output(section, files));
  outputs.push_back(diagnostics_file_output(section, files));
  if (screen != nullptr) outputs.push_back(screen_output(section, *screen, terminal));
  return outputs;
}

}  // namespace tchat
