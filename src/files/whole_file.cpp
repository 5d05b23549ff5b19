#include "files/whole_file.hpp"

#include "files/replaced_file.hpp"

namespace tchat {

void write_whole_file(const std::string& path, std::string_view text) {
  ReplacedFile file(path);
  file.write(text);
  file.finish();
}

}  // namespace tchat
