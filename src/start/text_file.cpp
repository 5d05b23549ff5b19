#include "start/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "constants/user_error.hpp"

namespace tchat {

std::string read_text_file(const std::string& path, const std::string& what, const std::string& cure) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw UserError(fmt::format("{}: there is no such file ({}); {}", path, what, cure));
  if (!std::filesystem::is_regular_file(status))
    throw UserError(fmt::format("{}: is {}, not a file ({}); {}", path,
                                std::filesystem::is_directory(status) ? "a directory" : "a device or pipe", what,
                                cure));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(fmt::format("{}: cannot be read ({}): {}", path, what, std::strerror(errno)));
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw UserError(fmt::format("{}: cannot be read ({})", path, what));
  return text;
}

}  // namespace tchat
