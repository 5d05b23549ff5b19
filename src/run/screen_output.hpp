/// The table of a run on the screen.
#pragma once

#include <memory>
#include <ostream>

#include "run/branch_output.hpp"

namespace tchat {

/// `terminal` may be null: nothing shows where the branch is between the lines of the table.
std::unique_ptr<BranchOutput> screen_output(const BranchSection& section, std::ostream& screen, std::ostream* terminal);

}  // namespace tchat
