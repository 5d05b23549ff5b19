/// A small text file that is written whole: readers find the old one or the new one, never a part.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

/// Writes a file beside it and renames it; an existing file is kept as path~. Throws UserError, ComputationError naming
/// the file.
void write_whole_file(const std::string& path, std::string_view text);

}  // namespace tchat
