/// Checks of formulas: names and types in expressions, dependence on states, and the cost of an evaluation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plugin/formula_file.hpp"
#include "plugin/tokens.hpp"

namespace tchat::formulas {

// Whether the names of an expression are known and its parts are numbers or conditions where they must be.

/// Adds what is wrong to `errors`; file, names and errors outlive this object.
class ExpressionCheck {
 public:
  ExpressionCheck(const FormulaFile& file, const NameTable& names, FormulaErrors& errors)
      : file_(file), names_(names), errors_(errors) {}

  /// An expression that stands for a number; `arguments` are the names of those of its function.
  void value(const Expression& expression, const std::vector<Token>& arguments = {}) const;
  /// One that stands behind 'if'.
  void condition(const Expression& expression) const;

 private:
  void check(const Expression& expression, const std::vector<Token>& arguments) const;
  void check_node(const Expression& expression, const Node& node, const std::vector<Token>& arguments) const;
  void check_name(const Node& node, const std::vector<Token>& arguments) const;
  void check_call(const Node& node) const;
  [[noreturn]] void refuse_unknown(const Node& node) const;

  const FormulaFile& file_;
  const NameTable& names_;
  FormulaErrors& errors_;
};

// How expressions depend on states: through which definitions and functions, and where not smoothly.

/// The first call of a function that is not smooth in something that moves with the states.
struct Roughness {
  std::string function;  ///< as written
  Position at;
};

struct StateDependence {
  bool on_states = false;
  std::optional<Roughness> step;  ///< a jump in value: sign, heav, floor, mod
  std::optional<Roughness> kink;  ///< a jump in slope: abs, max, min

  void join(const StateDependence& other);
};

/// The dependences of all definitions and functions.
class DependenceTable {
 public:
  /// Names must be those of the table. A definition that leads back to itself is a mistake; then of() is not to be
  /// called.
  DependenceTable(const FormulaFile& file, const NameTable& names, FormulaErrors& errors);

  StateDependence of(const Expression& expression) const;

 private:
  enum class Progress { open, begun, done };
  struct Entry {
    Progress progress = Progress::open;
    StateDependence result;
  };

  /// A function has two entries: with arguments that move with the states, and with such that do not.
  struct Use {
    const Symbol& symbol;
    bool moving_arguments = false;
  };

  const StateDependence& resolve(const Use& use, const std::string& name, Position at);
  struct Arguments {
    const std::vector<Token>& names;
    bool move = false;
  };
  /// `look_up` gives the dependence of a definition or function.
  template <class LookUp>
  StateDependence of(const Expression& expression, const Arguments& arguments, const LookUp& look_up) const;
  std::size_t place(const Use& use) const;

  const FormulaFile& file_;
  const NameTable& names_;
  std::vector<Entry> entries_;     ///< definitions, functions, functions of what moves
  std::vector<std::string> path_;  ///< names that are being resolved
};

// How much work a function of formulas is: each call of it computes anew what it uses, so that functions which call
// others twice double the work at every level.

/// Adds a mistake for each function whose value takes more than 100,000 operations, counting those of the functions and
/// definitions that it uses. Nothing may be defined by itself (DependenceTable finds that).
void refuse_expensive_functions(const FormulaFile& file, const NameTable& names, FormulaErrors& errors);

}  // namespace tchat::formulas
