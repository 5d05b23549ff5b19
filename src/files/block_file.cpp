#include "files/block_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "files/block_write.hpp"
#include "files/disk_sync.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

const char* state_after(const BlockOutcome& outcome) {
  return outcome.whole ? "cannot be written; it holds everything up to the last complete block"
                       : "cannot be written; its last block is not complete";
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

void BlockFile::write(std::string_view block) {
  const BlockOutcome outcome = append_block_through_kill(descriptor_, block);
  if (outcome.error != 0) fail(state_after(outcome), outcome.error);
}

void BlockFile::write_unread(std::string_view block) {
  const BlockOutcome outcome = append_block(descriptor_, block);
  if (outcome.error != 0) fail("cannot be written", outcome.error);
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
