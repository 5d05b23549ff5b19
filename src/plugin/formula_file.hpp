/// A file of formulas: its statements as they are written, and what each name stands for.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plugin/expression.hpp"
#include "plugin/tokens.hpp"

namespace tchat::formulas {

// A file of formulas as it is written: its statements, sorted, with nothing checked between them.

/// par a = 1, x' = v, v -> -r*v, event wall = 1 - x, aux E = v^2: a name and what it is.
struct Assignment {
  Token name;
  Expression value;
};

/// f(a, b) = a*b
struct FunctionDefinition {
  Token name;
  std::vector<Token> arguments;
  Expression body;
};

/// field NAME or jump NAME with the lines that belong to it.
struct Block {
  Token name;
  std::vector<Assignment> lines;
  std::optional<Token> target = {};  ///< jump NAME to FIELD
};

/// mode FIELD: states a, b, c: the states that the field has, of all the first ones.
struct ModeStatement {
  Token field;
  std::vector<Token> states;
};

/// slide NAME on SURFACE: EVENT -> FIELD, EVENT -> FIELD: the field NAME slides where the event SURFACE is 0, until one
/// of two events leads to the field below it (first) or above it. NAME and both events are made by the statement.
struct SlideStatement {
  Token name;
  Token surface;
  std::array<std::pair<Token, Token>, 2> ends;  ///< event, field: below, above
};

/// contact NAME on SURFACE until RELEASE: FIELD, IMPACT -> LIMIT: where impacts in FIELD at SURFACE accumulate, LIMIT
/// is the jump to contact, in which the field NAME holds until RELEASE. The statement makes NAME, RELEASE, LIMIT, the
/// events LIMIT_margin and LIMIT_time and the jump NAME_end (tchat/chatter.hpp).
struct ContactStatement {
  Token name, surface, release, field, impact, limit;
};

/// after FROM... [if CONDITION]: [FIELD until] EVENT -> JUMP, ...
struct SuccessorLine {
  Position at;
  std::vector<Token> from;
  std::optional<Expression> condition;
  std::optional<Token> field;
  std::vector<std::pair<Token, Token>> ends;  ///< event, jump
};

struct FormulaFile {
  std::vector<Assignment> parameters;
  std::vector<Assignment> initial;
  std::vector<Assignment> definitions;
  std::vector<FunctionDefinition> functions;
  std::vector<Assignment> shared_equations;  ///< those before the first field
  std::vector<Block> fields;
  std::vector<ModeStatement> modes;
  std::vector<Assignment> events;
  std::vector<Block> jumps;
  std::vector<SlideStatement> slides;
  std::vector<ContactStatement> contacts;
  std::vector<SuccessorLine> successors;
  std::vector<Assignment> user_values;
};

/// Reads all statements; mistakes are collected, the statements that have them left out.
FormulaFile read_formula_file(std::string_view text, FormulaErrors& errors);

struct Symbol {
  enum class Kind { state, parameter, definition, function };
  Kind kind = Kind::state;
  std::size_t index = 0;  ///< among its kind; states in the order of their first equations
  Position at;
};

/// "a state", "a parameter", ...
std::string in_words(Symbol::Kind kind);

/// The names that expressions may use. Fields, events and jumps have names of their own.
class NameTable {
 public:
  /// Names used twice, or those of built-in functions and words, are mistakes.
  NameTable(const FormulaFile& file, FormulaErrors& errors);

  /// Null when the name stands for nothing.
  const Symbol* find(std::string_view name) const;
  const std::vector<std::string>& states() const { return states_; }
  /// All of them, with built-in functions and pi, for suggestions.
  std::vector<std::string> all() const;

 private:
  void add(const Token& name, Symbol::Kind kind, std::size_t index, FormulaErrors& errors);
  void add_states(const std::vector<Assignment>& equations, FormulaErrors& errors);

  std::map<std::string, Symbol, std::less<>> symbols_;
  std::vector<std::string> states_;
};

/// Throws FormulaError for a name that means something in every file: pi, a function, a word of conditions.
void refuse_reserved(const Token& name);

}  // namespace tchat::formulas
