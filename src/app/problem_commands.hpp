/// Commands that prepare a run: new, check, constants and dat.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tchat {

// A problem to start from: plugin, starting data, constants and Makefile that run as they are.

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

// `tchat new NAME`: a folder with a problem to start from.

void add_new_command(CLI::App& app, std::function<int()>& chosen);

// `tchat check NAME`: the problem's derivatives against finite differences, its dimension, its names.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that does it and returns the exit status:
/// 0 fine, 1 a fault was found. That call throws UserError for a plugin that cannot be loaded and for bad values.
void add_check_command(CLI::App& app, std::function<int()>& chosen);

// `tchat constants [NAME]`: a constants file in the other form, or explained; without NAME, what constants there are.

void add_constants_command(CLI::App& app, std::function<int()>& chosen);

// `tchat dat NAME`: NAME.dat -> q.NAME with the data as label 1 (TC-HAT's @gmdat).

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that does it and returns the exit status.
void add_dat_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat
