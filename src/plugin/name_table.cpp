#include "plugin/name_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

std::string in_words(Symbol::Kind kind) {
  switch (kind) {
    case Symbol::Kind::state:
      return "a state";
    case Symbol::Kind::parameter:
      return "a parameter";
    case Symbol::Kind::definition:
      return "a definition";
    default:
      return "a function";
  }
}

void refuse_reserved(const Token& name) {
  for (const char* word : {"and", "or", "not", "if", "until", "start", "any"})
    if (name.text == word)
      throw FormulaError{name.at, fmt::format("'{}' is a word of the language; choose another name", name.text)};
  if (name.text == "pi" || find_function(name.text) != nullptr)
    throw FormulaError{name.at, fmt::format("'{}' is built in and cannot be defined again; choose another name, such "
                                            "as {}0",
                                            name.text, name.text)};
}

NameTable::NameTable(const FormulaFile& file, FormulaErrors& errors) {
  add_states(file.shared_equations, errors);
  for (const Block& field : file.fields) add_states(field.lines, errors);
  for (std::size_t k = 0; k < file.parameters.size(); ++k)
    add(file.parameters[k].name, Symbol::Kind::parameter, k, errors);
  for (std::size_t k = 0; k < file.definitions.size(); ++k)
    add(file.definitions[k].name, Symbol::Kind::definition, k, errors);
  for (std::size_t k = 0; k < file.functions.size(); ++k)
    add(file.functions[k].name, Symbol::Kind::function, k, errors);
}

/// Equations of one state stand in several fields.
void NameTable::add_states(const std::vector<Assignment>& equations, FormulaErrors& errors) {
  for (const Assignment& equation : equations) {
    const Symbol* const known = find(equation.name.text);
    if (known != nullptr && known->kind == Symbol::Kind::state) continue;
    add(equation.name, Symbol::Kind::state, states_.size(), errors);
    states_.push_back(equation.name.text);
  }
}

void NameTable::add(const Token& name, Symbol::Kind kind, std::size_t index, FormulaErrors& errors) {
  collecting(errors, [&] {
    refuse_reserved(name);
    const auto [place, is_new] = symbols_.emplace(name.text, Symbol{kind, index, name.at});
    if (is_new) return;
    const Symbol& first = place->second;
    const std::string cure = first.kind == Symbol::Kind::state
                                 ? fmt::format(
                                       "what a jump makes of it stands behind 'jump NAME:', as {} -> ...; else "
                                       "choose another name",
                                       name.text)
                                 : "choose another name";
    throw FormulaError{name.at, fmt::format("'{}' is used twice, it is {} already (line {}); {}", name.text,
                                            in_words(first.kind), first.at.line, cure)};
  });
}

const Symbol* NameTable::find(std::string_view name) const {
  const auto found = symbols_.find(name);
  return found != symbols_.end() ? &found->second : nullptr;
}

std::vector<std::string> NameTable::all() const {
  std::vector<std::string> names;
  for (const auto& [name, symbol] : symbols_) names.push_back(name);
  const std::vector<std::string> functions = function_names();
  names.insert(names.end(), functions.begin(), functions.end());
  names.emplace_back("pi");
  return names;
}

}  // namespace tchat::formulas
