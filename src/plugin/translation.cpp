#include "plugin/translation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "base/text_file.hpp"
#include "plugin/cpp_writer.hpp"
#include "plugin/problem_model.hpp"

namespace tchat {

namespace {

/// two-walls -> TwoWalls
std::string problem_name(const std::string& path) {
  std::string name;
  bool capital = true;
  for (const char c : std::filesystem::path(path).stem().string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_part = byte < 0x80 && std::isalnum(byte) != 0;
    if (is_part) name += capital ? static_cast<char>(std::toupper(byte)) : c;
    capital = !is_part;
  }
  return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0 ? "Problem" + name : name;
}

/// For a comment of one line, whatever the file is called.
std::string origin(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < 0x20 || c > 0x7e || c == '\\'; }, '_');
  return fmt::format("Translated from the formulas of {}.", name);
}

}  // namespace

Translation translate_formulas(std::string_view text, const std::string& path) {
  formulas::FormulaErrors errors;
  formulas::FormulaFile file = formulas::read_formula_file(text, errors);
  errors.throw_if_any(path, text);
  const formulas::ProblemModel model = formulas::check_formulas(std::move(file), errors);
  errors.throw_if_any(path, text);

  Translation result;
  result.cpp = formulas::cpp_source(model, problem_name(path), origin(path));
  for (const formulas::FormulaError& remark : model.remarks)
    result.remarks.push_back(fmt::format("{}:{}:{}: {}", path, remark.at.line, remark.at.column, remark.message));
  result.has_successors = !model.successors.empty();
  return result;
}

Translation translate_formula_file(const std::string& path) {
  return translate_formulas(read_text_file(path, "formulas of a problem", "give the path of NAME.tch"), path);
}

}  // namespace tchat
