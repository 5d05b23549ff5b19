#include "files/replaced_file.hpp"

#include <filesystem>

#include "files/disk_sync.hpp"
#include "files/writable_file.hpp"

namespace tchat {

namespace {

std::string checked(std::string path) {
  require_writable(path);
  return path;
}

}  // namespace

ReplacedFile::ReplacedFile(std::string path) : path_(checked(std::move(path))), file_(path_) {
  remove_abandoned({path_ + "~"});
}

void ReplacedFile::finish() {
  file_.close();
  std::error_code error;
  if (std::filesystem::exists(path_, error)) {
    keep_as(path_, path_ + "~");
    sync_folder_of(path_);
  }
  file_.put_in_place();
  sync_folder_of(path_);
}

}  // namespace tchat
