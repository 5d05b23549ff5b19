/// Asked before any work is done: can a file be written there?
#pragma once

#include <string>

namespace tchat {

/// Throws UserError when `path` lies in a folder that is missing or closed, or is a directory, a device or a file that
/// may not be replaced.
void require_writable(const std::string& path);

}  // namespace tchat
