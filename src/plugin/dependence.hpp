/// How expressions depend on states: through which definitions and functions, and where not smoothly.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plugin/formula_file.hpp"
#include "plugin/name_table.hpp"

namespace tchat::formulas {

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

}  // namespace tchat::formulas
