/// Translation of a file of formulas (NAME.tch) to the C++ source of a plugin.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plugin/problem_model.hpp"

namespace tchat::formulas {

// A checked problem as the C++ source of a plugin.

/// `class_name` is a name of C++; `origin` says in the first line where the formulas come from.
std::string cpp_source(const ProblemModel& model, const std::string& class_name, const std::string& origin);

}  // namespace tchat::formulas

namespace tchat {

// From a file of formulas (NAME.tch) to the C++ source of a plugin. The language: src/docs/formulas.md.
//
// tokens -> expression_parser -> formula_file (statements) -> problem_model (checked) -> cpp_writer. The parser is
// written by hand: the grammar is small, and every mistake must be told with its place and cure, which is where parser
// generators and libraries give least.

struct Translation {
  std::string cpp;                   ///< source of the plugin
  std::vector<std::string> remarks;  ///< "FILE:LINE:COLUMN: what": no mistakes, but things to know
  bool has_successors = false;       ///< there are `after` lines
};

/// `path` is how the file is called in messages and gives the problem its name. Throws UserError with all mistakes.
Translation translate_formulas(std::string_view text, const std::string& path);

/// Reads the file. Throws UserError when it cannot be read, too.
Translation translate_formula_file(const std::string& path);

}  // namespace tchat
