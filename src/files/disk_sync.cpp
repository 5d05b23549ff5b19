#include "files/disk_sync.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/user_error.hpp"

namespace tchat {

namespace {

/// errno of what failed, 0.
int sync_error(int descriptor) {
  int error = 0;
  do {
    error = ::fsync(descriptor) == 0 ? 0 : errno;
  } while (error == EINTR);
  return error;
}

void tell(int error, const std::string& path) {
  if (error == EIO || error == ENOSPC || error == EDQUOT)
    throw ComputationError(fmt::format("{}: cannot be stored on the disk ({})", path, std::strerror(error)));
}

void sync_opened(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  const int error = sync_error(descriptor);
  ::close(descriptor);
  tell(error, path);
}

}  // namespace

void begin_sync(int descriptor) { ::sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE); }

void sync_file(int descriptor, const std::string& path) { tell(sync_error(descriptor), path); }

void sync_file(const std::string& path) { sync_opened(path, 0); }

void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  sync_opened(folder.empty() ? "." : folder, O_DIRECTORY);
}

}  // namespace tchat
