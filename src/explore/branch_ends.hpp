/// Why the directions of a branch ended, as `tchat run` reports it.
#pragma once

#include <string>
#include <vector>

namespace tchat {

/// The sentences behind "stopped:" in the summaries of a log, one for each direction, each in one line.
std::vector<std::string> branch_ends(const std::string& log);

/// The last message of a command that has failed, without its "tchat:" and long explanations; the last line of a log
/// without one.
std::string failure_text(const std::string& log);

}  // namespace tchat
