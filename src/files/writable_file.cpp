#include "files/writable_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/user_error.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

void refuse(const std::string& path, const std::string& what) {
  throw UserError(fmt::format("{}: {}; choose another name with -o, or mend the file's place", path, what));
}

void check_folder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (!fs::is_directory(folder, error)) refuse(path, fmt::format("cannot be written, there is no folder {}", folder));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(path, fmt::format("cannot be written in folder {} ({})", folder, std::strerror(errno)));
}

}  // namespace

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

void require_writable(const std::string& path) {
  check_folder(path);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) refuse(path, "cannot be written, it is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(path, "cannot be written, it is a device or pipe");
  if (fs::exists(status) && ::access(path.c_str(), W_OK) != 0)
    refuse(path, fmt::format("cannot be written ({})", std::strerror(errno)));
  const std::string kept = path + "~";
  if (fs::exists(status) && fs::is_directory(kept, error))
    throw UserError(
        fmt::format("{} cannot be replaced: it is to be kept as {}, and that is a directory; move the directory away, "
                    "or choose another name with -o",
                    path, kept));
}

}  // namespace tchat
