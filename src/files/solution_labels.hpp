/// The labels in a q-file, without the numbers of its solutions: much faster than reading it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

/// The labels of the whole solutions, in file order; a cut last one is left out. Empty when there is no file, nothing
/// when the file is no q-file.
std::optional<std::vector<int>> whole_solution_labels(const std::string& path);

}  // namespace tchat
