#include "files/block_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/user_error.hpp"
#include "files/disk_sync.hpp"

namespace tchat {

namespace {

/// Size of an ordinary file; -1 for devices and pipes, which cannot be cut.
off_t ordinary_size(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return -1;
  return status.st_size;
}

/// Nothing but system calls. errno of what failed, 0.
int append(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

struct Outcome {
  int error = 0;
  bool whole = true;  ///< no part of the text that failed is left in the file
};

Outcome append_or_cut(int descriptor, std::string_view text) {
  const off_t before = ordinary_size(descriptor);
  const int error = append(descriptor, text);
  return {error, error == 0 || before < 0 || ::ftruncate(descriptor, before) == 0};
}

}  // namespace

BlockFile::BlockFile(std::string path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_APPEND, 0666);
  if (descriptor_ < 0) fail("cannot be opened for writing", errno);
}

BlockFile::BlockFile(int descriptor, std::string path) : path_(std::move(path)), descriptor_(descriptor) {}

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

void BlockFile::write(std::string_view blocks) {
  if (blocks.empty()) return;
  const Outcome outcome = append_or_cut(descriptor_, blocks);
  if (outcome.error == 0) return;
  fail(outcome.whole ? "cannot be written; it holds everything up to the last complete block"
                     : "cannot be written; its last block is not complete",
       outcome.error);
}

void BlockFile::write_before_the_end(std::string_view blocks) noexcept {
  if (is_open() && !blocks.empty()) append_or_cut(descriptor_, blocks);
}

void BlockFile::begin_sync() {
  if (is_open()) tchat::begin_sync(descriptor_);
}

void BlockFile::sync() {
  if (is_open()) sync_file(descriptor_, path_);
}

void BlockFile::close() {
  if (!is_open()) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot be closed", errno);
}

void BlockFile::fail(const std::string& what, int error) const {
  throw ComputationError(fmt::format("{}: {} ({})", path_, what, std::strerror(error)));
}

}  // namespace tchat
