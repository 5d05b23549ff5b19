/// The texts that every page consists of, embedded when tchat is built: our own from src/plot/page, and D3 as Debian's
/// package libjs-d3 has it.
#pragma once

#include <string_view>

namespace tchat {

struct PageFiles {
  std::string_view style;            ///< CSS
  std::string_view body;             ///< HTML
  std::string_view script;           ///< JavaScript of all files, one after the other
  std::string_view library;          ///< D3, minified
  std::string_view library_licence;  ///< its licence
};

extern const PageFiles page_files;

}  // namespace tchat
