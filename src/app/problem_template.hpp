/// A problem to start from: plugin, starting data, constants and Makefile that run as they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tchat {

struct NewFile {
  std::string name;  ///< inside the problem's folder
  std::string text;
};

/// The files of a new problem. Throws UserError unless `name` is a letter followed by letters, digits and underscores:
/// it becomes a class name and part of file names and Makefile rules.
std::vector<NewFile> problem_template(const std::string& name);

/// The one file of a problem written as formulas: its C++, to be changed from then on. Throws UserError as translation
/// does, and for the name.
std::vector<NewFile> translated_problem(const std::string& name, const std::string& formulas_path);

/// Writes them into the new folder `path`, whose last part is the problem's name. Throws UserError when the folder has
/// files already or cannot be written; what is there is never touched. The folder also gets compile_flags.txt for
/// editors.
/// `formulas_path`: a translated problem instead of the template.
std::vector<NewFile> create_problem(const std::string& path,
                                    const std::optional<std::string>& formulas_path = std::nullopt);

}  // namespace tchat
