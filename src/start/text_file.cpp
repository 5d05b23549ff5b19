#include "start/text_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

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
  std::string text;
  std::array<char, 65536> piece;  // read() tells a failing device by badbit, an iterator by an exception
  while (file.read(piece.data(), piece.size()), file.gcount() > 0)
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad())
    throw ComputationError(fmt::format("{}: reading fails ({}, {}); the disk or the connection to it is at fault", path,
                                       what, std::strerror(errno)));
  return text;
}

}  // namespace tchat
