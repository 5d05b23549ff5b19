/// A checked problem as the C++ source of a plugin.
#pragma once

#include <string>

#include "plugin/problem_model.hpp"

namespace tchat::formulas {

/// `class_name` is a name of C++; `origin` says in the first line where the formulas come from.
std::string cpp_source(const ProblemModel& model, const std::string& class_name, const std::string& origin);

}  // namespace tchat::formulas
