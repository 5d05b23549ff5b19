/// A text file the user named, read whole.
#pragma once

#include <string>

namespace tchat {

/// The bytes of the file. Throws UserError when it is missing, a directory or cannot be opened, ComputationError when
/// the device fails while it is read; `what` says what it is
/// ("starting data"), `cure` where it comes from.
std::string read_text_file(const std::string& path, const std::string& what, const std::string& cure);

}  // namespace tchat
