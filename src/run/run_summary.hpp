/// The paragraph that ends a run: how many points, which are special, why it stopped, how accurate it is.
#pragma once

#include <string>
#include <vector>

#include "continuation/branch.hpp"
#include "run/branch_writer.hpp"

namespace tchat {

/// `output` is O of p.O; `parameter` the name of ICP(1). Several lines, each with its newline.
std::string summary_text(const BranchSummary& summary, const std::vector<BranchWriter::Labelled>& labels,
                         const std::string& parameter, const std::string& output);

}  // namespace tchat
