#include "output/whole_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "constants/user_error.hpp"
#include "output/block_file.hpp"

namespace tchat {

void write_whole_file(const std::string& path, std::string_view text) {
  namespace fs = std::filesystem;
  const std::string temporary = path + ".new";
  {
    BlockFile file(temporary, BlockFile::Mode::replace);
    file.write(text);
    file.close();
  }
  std::error_code error;
  if (fs::exists(path, error)) fs::rename(path, path + "~", error);
  fs::rename(temporary, path, error);
  if (error) throw ComputationError(fmt::format("{} cannot be written: {}", path, error.message()));
}

}  // namespace tchat
