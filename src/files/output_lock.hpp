/// One process at a time writes the files of one output name.
#pragma once

#include <memory>
#include <string>

#include "plugin/file_lock.hpp"

namespace tchat {

/// Holds the lock .O.lock in the folder of `name` = O. Throws UserError naming the other process that is writing these
/// files; `cure` says how to give them another name. A folder in which no lock can be made is no obstacle here.
std::unique_ptr<FileLock> lock_output(const std::string& name, const std::string& cure = "-o");

}  // namespace tchat
