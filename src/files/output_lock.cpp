#include "files/output_lock.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>

#include "base/user_error.hpp"

namespace tchat {

std::unique_ptr<FileLock> lock_output(const std::string& name, const std::string& cure) {
  // A process that was killed may still be storing its last block; a run that is going on takes longer.
  constexpr std::chrono::milliseconds patience{1000};
  const std::filesystem::path path(name);
  const std::string file = fmt::format(".{}.lock", path.filename().string());
  auto lock = std::make_unique<FileLock>((path.parent_path() / file).string(), patience);
  if (lock->error() != EWOULDBLOCK) return lock;
  const std::string who = lock->holder() > 0 ? fmt::format(" (process {})", lock->holder()) : "";
  throw UserError(
      fmt::format("{}: another tchat{} is writing the files of this name; wait for its end, or choose another name "
                  "with {}",
                  name, who, cure));
}

}  // namespace tchat
