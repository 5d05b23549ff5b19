#include "output/replaced_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "constants/user_error.hpp"

namespace tchat {

namespace fs = std::filesystem;

ReplacedFile::ReplacedFile(std::string path)
    : path_(std::move(path)), file_(path_ + ".new", BlockFile::Mode::replace) {}

ReplacedFile::~ReplacedFile() {
  std::error_code ignored;
  if (file_.is_open()) fs::remove(path_ + ".new", ignored);
}

void ReplacedFile::finish() {
  file_.close();
  std::error_code error;
  if (fs::exists(path_, error)) fs::rename(path_, path_ + "~", error);
  fs::rename(path_ + ".new", path_, error);
  if (error) throw ComputationError(fmt::format("{} cannot be written: {}", path_, error.message()));
}

}  // namespace tchat
