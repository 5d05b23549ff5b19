#include "base/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "base/messages.hpp"

namespace tchat {

namespace {

[[noreturn]] void tell_failing_device(const std::string& path, const std::string& what) {
  throw ComputationError(fmt::format("{}: reading fails ({}, {}); the disk or the connection to it is at fault", path,
                                     what, std::strerror(errno)));
}

}  // namespace

std::optional<std::string> read_text_if_there(const std::string& path, const std::string& what, std::size_t most) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  std::string text;
  std::error_code unknown;
  if (const auto size = std::filesystem::file_size(path, unknown); !unknown)
    text.reserve(std::min<std::size_t>(size, most));
  std::array<char, 65536> piece;  // read() tells a failing device by badbit, an iterator by an exception
  while (text.size() < most) {
    file.read(piece.data(), static_cast<std::streamsize>(std::min(piece.size(), most - text.size())));
    if (file.bad()) tell_failing_device(path, what);
    if (file.gcount() == 0) break;
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  return text;
}

std::string read_text_file(const std::string& path, const std::string& what, const std::string& cure) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw UserError(fmt::format("{}: there is no such file ({}); {}", path, what, cure));
  if (!std::filesystem::is_regular_file(status))
    throw UserError(fmt::format("{}: is {}, not a file ({}); {}", path,
                                std::filesystem::is_directory(status) ? "a directory" : "a device or pipe", what,
                                cure));
  std::optional<std::string> text = read_text_if_there(path, what);
  if (!text) throw UserError(fmt::format("{}: cannot be read ({}): {}", path, what, std::strerror(errno)));
  return *std::move(text);
}

TextLines::TextLines(std::string path, std::string what)
    : path_(std::move(path)), what_(std::move(what)), in_(path_, std::ios::binary) {}

bool TextLines::next(std::string& line) {
  if (std::getline(in_, line)) return true;
  if (in_.bad()) tell_failing_device(path_, what_);
  return false;
}

}  // namespace tchat
