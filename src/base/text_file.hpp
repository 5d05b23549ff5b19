/// Text files as they are read everywhere: a device that fails is told, never taken for the end of the file.
#pragma once

#include <cstddef>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace tchat {

/// The bytes of a file the user named. Throws UserError when it is missing, a directory or cannot be opened,
/// ComputationError when the device fails while it is read; `what` says what it is ("starting data"), `cure` where it
/// comes from.
std::string read_text_file(const std::string& path, const std::string& what, const std::string& cure);

/// The bytes of anything that can be opened, a pipe as well, at most `most` of them; nothing, with errno set, when it
/// cannot. Throws ComputationError when the device fails.
std::optional<std::string> read_text_if_there(const std::string& path, const std::string& what,
                                              std::size_t most = std::numeric_limits<std::size_t>::max());

/// The lines of a file one after the other, for files too large to hold. One that is missing has none.
class TextLines {
 public:
  TextLines(std::string path, std::string what);

  /// The next line without its newline; false after the last one. Throws ComputationError when the device fails.
  bool next(std::string& line);

  /// The last line had no newline, or there is none.
  bool ended_within_line() const { return in_.eof(); }

 private:
  std::string path_;
  std::string what_;
  std::ifstream in_;
};

}  // namespace tchat
