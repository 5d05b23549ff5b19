/// The syntax tree of one expression.
#pragma once

#include <string>
#include <vector>

#include "plugin/formula_errors.hpp"

namespace tchat::formulas {

/// One node; its operands are given by their places in Expression::nodes, always before its own.
struct Node {
  enum class Kind {
    number,
    name,
    call,        ///< text(operands...)
    negation,    ///< -a
    arithmetic,  ///< a text b, with text one of + - * / ^
    comparison,  ///< a text b, with text one of < > <= >= == !=
    logic,       ///< a text b, with text "and" or "or"
    inversion    ///< not a
  };
  Kind kind = Kind::number;
  std::string text;
  double number = 0.0;
  std::vector<int> operands;
  Position at;

  bool is_condition() const { return kind == Kind::comparison || kind == Kind::logic || kind == Kind::inversion; }
};

struct Expression {
  std::vector<Node> nodes;  ///< the last one is the root

  const Node& node(int place) const { return nodes[static_cast<std::size_t>(place)]; }
  int root() const { return static_cast<int>(nodes.size()) - 1; }
  Position at;  ///< where it begins
};

}  // namespace tchat::formulas
