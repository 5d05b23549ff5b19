/// The p-, q- and d-file of a run as outputs of its branch.
#pragma once

#include <memory>

#include "run/branch_output.hpp"

namespace tchat {

std::unique_ptr<BranchOutput> point_file_output(const BranchSection& section, RunFiles& files);
std::unique_ptr<BranchOutput> solution_file_output(const BranchSection& section, RunFiles& files);
std::unique_ptr<BranchOutput> diagnostics_file_output(const BranchSection& section, RunFiles& files);

}  // namespace tchat
