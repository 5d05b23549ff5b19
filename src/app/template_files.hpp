/// The texts of the files in template/, compiled in. @NAME@ stands for the problem's name, @CLASS@ for its class.
#pragma once

namespace tchat::template_files {

extern const char* const problem;
extern const char* const start;
extern const char* const constants;
extern const char* const makefile;

}  // namespace tchat::template_files
