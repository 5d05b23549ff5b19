#include "output/block_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "constants/user_error.hpp"

namespace tchat {

namespace {

/// Size of an ordinary file; -1 for devices and pipes, which cannot be cut.
off_t ordinary_size(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return -1;
  return status.st_size;
}

}  // namespace

BlockFile::BlockFile(std::string path, Mode mode) : path_(std::move(path)) {
  const int how = O_WRONLY | O_CREAT | O_CLOEXEC | O_APPEND | (mode == Mode::replace ? O_TRUNC : 0);
  descriptor_ = ::open(path_.c_str(), how, 0666);
  if (descriptor_ < 0) fail("cannot be opened for writing", errno);
}

BlockFile::BlockFile(BlockFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

BlockFile& BlockFile::operator=(BlockFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

BlockFile::~BlockFile() {
  if (is_open()) ::close(descriptor_);
}

void BlockFile::write(std::string_view block) {
  const off_t before = ordinary_size(descriptor_);
  while (!block.empty()) {
    const ssize_t written = ::write(descriptor_, block.data(), block.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = written < 0 ? errno : ENOSPC;
      const bool restored = before < 0 || ::ftruncate(descriptor_, before) == 0;
      fail(restored ? "cannot be written; it holds everything up to the last complete block"
                    : "cannot be written; its last block is not complete",
           error);
    }
    block.remove_prefix(static_cast<std::size_t>(written));
  }
}

void BlockFile::close() {
  if (!is_open()) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot be closed", errno);
}

void BlockFile::fail(const std::string& what, int error) const {
  throw ComputationError(fmt::format("{}: {} ({})", path_, what, std::strerror(error)));
}

}  // namespace tchat
