/// `tchat complete -- WORD...`, for the shells' completion: what could stand in the place of the last word.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace tchat {

/// Prints one candidate a line; one that ends in = wants a value at once, one that ends in / a file of that folder.
/// `words` are those after `tchat complete`: any words, so that they are not parsed. Files that cannot be read give no
/// candidates, and no messages. Returns the exit status.
int print_completions(const CLI::App& app, std::vector<std::string> words);

}  // namespace tchat
