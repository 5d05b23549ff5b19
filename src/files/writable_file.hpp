/// Asked before any work is done: is a file there, can one be written there?
#pragma once

#include <string>

namespace tchat {

/// False also where it cannot be told.
bool exists(const std::string& path);

/// Throws UserError when `path` lies in a folder that is missing or closed, or is a directory, a device or a file that
/// may not be replaced, or when there is one that cannot be kept as `path~`.
void require_writable(const std::string& path);

}  // namespace tchat
