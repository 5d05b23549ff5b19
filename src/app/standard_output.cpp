#include "app/standard_output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

namespace tchat {

std::string lost_output() {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::cout && std::ferror(stdout) == 0) return "";
  // An earlier write may have failed: its reason is gone then.
  const std::string reason = errno != 0 ? fmt::format(" ({})", std::strerror(errno)) : "";
  return fmt::format(
      "standard output cannot be written{}: what was printed is lost, wholly or in part; is the disk full, "
      "or is it closed?",
      reason);
}

}  // namespace tchat
