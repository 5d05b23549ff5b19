#include "app/problem_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "app/template_files.hpp"
#include "base/user_error.hpp"
#include "files/auto_format.hpp"
#include "plugin/compiler.hpp"
#include "plugin/cpp_writer.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_name_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

void require_name(const std::string& name) {
  if (!name.empty() && is_letter(name[0]) && std::all_of(name.begin(), name.end(), is_name_character)) return;
  throw UserError(
      fmt::format("'{}' cannot be the name of a problem; needed is a letter followed by letters, digits and "
                  "underscores, for example: tchat new two_walls",
                  name));
}

/// two_walls -> TwoWalls
std::string class_name(const std::string& name) {
  std::string result;
  bool capital = true;
  for (const char c : name) {
    if (c != '_') result += capital && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    capital = c == '_';
  }
  return result;
}

std::string filled(std::string text, const std::string& mark, const std::string& value) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + value.size()))
    text.replace(at, mark.size(), value);
  return text;
}

void write_new(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  if (!out)
    throw UserError(fmt::format("{} cannot be written; is the folder writable and the disk not full?", path.string()));
}

/// What clangd and other language servers read, so that an editor finds the header and knows the standard.
std::string editor_flags() {
  return fmt::format("-xc++\n-std=c++20\n-I{}\n", fs::absolute(find_include_folder({})).string());
}

}  // namespace

std::vector<NewFile> problem_template(const std::string& name) {
  require_name(name);
  std::vector<NewFile> files{{name + ".cpp", template_files::problem},
                             {name + ".dat", template_files::start},
                             {constants_file_of(name), template_files::constants},
                             {"Makefile", template_files::makefile}};
  for (NewFile& file : files) file.text = filled(filled(file.text, "@NAME@", name), "@CLASS@", class_name(name));
  return files;
}

std::vector<NewFile> translated_problem(const std::string& name, const std::string& formulas_path) {
  require_name(name);
  return {{name + ".cpp", translate_formula_file(formulas_path).cpp}};
}

std::vector<NewFile> create_problem(const std::string& path, const std::optional<std::string>& formulas_path) {
  const fs::path folder = fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path();
  const std::string name = folder.filename().string();
  std::vector<NewFile> files = formulas_path ? translated_problem(name, *formulas_path) : problem_template(name);
  std::error_code failed;
  if (fs::exists(folder, failed) && !(fs::is_directory(folder, failed) && fs::is_empty(folder, failed)))
    throw UserError(fmt::format("{} exists already and is left as it is; choose another name", folder.string()));
  fs::create_directories(folder, failed);
  if (failed) throw UserError(fmt::format("the folder {} cannot be made: {}", folder.string(), failed.message()));
  for (const NewFile& file : files) write_new(folder / file.name, file.text);
  write_new(folder / "compile_flags.txt", editor_flags());
  files.push_back({"compile_flags.txt", editor_flags()});
  return files;
}

}  // namespace tchat
