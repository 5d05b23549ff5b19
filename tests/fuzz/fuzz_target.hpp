/// What all fuzz targets share: a reader either accepts a text or throws one UserError that can be shown on a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>

#include "base/messages.hpp"

/// The entry that libFuzzer (and replay.cpp) calls with one text after the other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tchat::fuzz {

/// Stands for the path of the text in messages.
inline const std::string source = "input";

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A property that must hold for every text. It ends the process where it does not, which the fuzzer reports.
inline void require(bool holds, const std::string& property) {
  if (holds) return;
  std::cerr << "violated: " << property << '\n';
  std::abort();
}

/// A message names its source, says something, and is short enough to be read.
inline void require_readable(const std::string& message, const std::string& place = source) {
  require(message.find(place) != std::string::npos && message.size() > place.size() + 10,
          "a message says where and what: " + message);
  require(message.size() < 10'000, "a message is no copy of the file");
}

/// Calls work(), which may throw a readable UserError and nothing else. True when it did not throw.
template <class Work>
bool accepts(Work&& work, const std::string& place = source) {
  try {
    work();
    return true;
  } catch (const UserError& error) {
    require_readable(error.what(), place);
    return false;
  }
}

}  // namespace tchat::fuzz
