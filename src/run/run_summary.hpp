/// The paragraph that ends a run: how many points, which are special, why it stopped, how accurate it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "continuation/branch.hpp"
#include "run/branch_writer.hpp"

namespace tchat {

/// The command that most users give next at a label, or "".
using NextCommand = std::function<std::string(const BranchWriter::Labelled&)>;

/// `output` is O of p.O; `parameter` the name of ICP(1). Several lines, each with its newline. The first label of each
/// type is followed by its next command.
std::string summary_text(const BranchSummary& summary, const std::vector<BranchWriter::Labelled>& labels,
                         const std::string& parameter, const std::string& output, const NextCommand& next);

}  // namespace tchat
