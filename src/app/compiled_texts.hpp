/// Texts that are compiled in: the files of template/, and what this program is.
#pragma once

#include <string>

namespace tchat {

/// "tchat 1.1.0", then lines for the commit, the compiler and the libraries with their versions.
std::string version_text();

/// @NAME@ stands for the problem's name, @CLASS@ for its class.
namespace template_files {

extern const char* const problem;
extern const char* const start;
extern const char* const constants;
extern const char* const makefile;

}  // namespace template_files

}  // namespace tchat
