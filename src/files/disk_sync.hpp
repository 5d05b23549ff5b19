/// What must be on the disk before something else may happen, for the case that the power fails.
#pragma once

#include <string>

namespace tchat {

/// Has the contents of an open file written to the disk without waiting, so that several files come there at once: one
/// that is synced afterwards waits less. Says nothing about success.
void begin_sync(int descriptor);

/// Waits until the contents of an open file are on the disk (nothing to wait for when they are already). Devices and
/// file systems that know no such thing are passed over. Throws ComputationError naming `path` when the disk fails.
void sync_file(int descriptor, const std::string& path);

/// The same by name; a file that is missing needs nothing.
void sync_file(const std::string& path);

/// Waits until the names in the folder of `path` are on the disk: files created, renamed, removed.
void sync_folder_of(const std::string& path);

}  // namespace tchat
