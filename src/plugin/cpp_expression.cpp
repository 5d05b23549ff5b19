#include "plugin/cpp_expression.hpp"

#include <fmt/format.h>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

namespace {

/// How tightly C++ holds a piece of text.
enum Tightness { any_cpp, or_cpp, and_cpp, comparison_cpp, sum_cpp, product_cpp, unary_cpp, operand_cpp };

struct Piece {
  std::string text;
  Tightness tightness = operand_cpp;
  bool is_name = false;

  std::string in(Tightness least) const { return tightness >= least ? text : "(" + text + ")"; }
};

Piece joined(const Piece& a, const std::string& symbol, const Piece& b, Tightness own) {
  const Tightness right = static_cast<Tightness>(own + 1);
  // "- -x" would be "--x" without the blank, and reads badly with it.
  const bool is_signed = b.text.starts_with('-');
  return {fmt::format("{} {} {}", a.in(own), symbol, is_signed ? b.in(operand_cpp) : b.in(right)), own};
}

/// Small powers are products: exact where pow() is rounded twice, and faster.
Piece power_of(const Piece& base, const Piece& exponent, double whole_exponent) {
  if (whole_exponent == 2.0 && base.is_name) return {fmt::format("{0} * {0}", base.text), product_cpp};
  if (whole_exponent == 2.0) return {fmt::format("square({})", base.text), operand_cpp};
  if (whole_exponent == 3.0) return {fmt::format("cube({})", base.text), operand_cpp};
  if (whole_exponent == 4.0) return {fmt::format("square(square({}))", base.text), operand_cpp};
  return {fmt::format("pow({}, {})", base.text, exponent.text), operand_cpp};
}

Piece arithmetic(const Expression& expression, const Node& node, const Piece& a, const Piece& b) {
  const Node& second = expression.node(node.operands[1]);
  switch (node.text[0]) {
    case '+':
    case '-':
      return joined(a, node.text, b, sum_cpp);
    case '*':
    case '/':
      return joined(a, node.text, b, product_cpp);
    default:
      return power_of(a, b, second.kind == Node::Kind::number ? second.number : 0.0);
  }
}

}  // namespace

std::string cpp_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string cpp_expression(const Expression& expression, const std::function<std::string(const std::string&)>& name_of,
                           const std::function<std::string(const std::string&)>& call_of) {
  std::vector<Piece> pieces;
  const auto call = [&](const Node& node) {
    std::string text = call_of(node.text);
    if (text.empty()) text = fmt::format("{}(", find_function(node.text)->cpp);
    for (std::size_t k = 0; k < node.operands.size(); ++k)
      text += (k == 0 ? "" : ", ") + pieces[static_cast<std::size_t>(node.operands[k])].text;
    return Piece{text + ")", operand_cpp};
  };
  const auto piece = [&](const Node& node) -> Piece {
    const auto operand = [&](std::size_t k) -> const Piece& {
      return pieces[static_cast<std::size_t>(node.operands[k])];
    };
    switch (node.kind) {
      case Node::Kind::number:
        return {cpp_number(node.number), operand_cpp};
      case Node::Kind::name:
        return {node.text == "pi" ? cpp_number(3.14159265358979323846) : name_of(node.text), operand_cpp, true};
      case Node::Kind::call:
        return call(node);
      case Node::Kind::negation:
        return {"-" + operand(0).in(operand_cpp), unary_cpp};
      case Node::Kind::arithmetic:
        return arithmetic(expression, node, operand(0), operand(1));
      case Node::Kind::comparison:
        return {fmt::format("{} {} {}", operand(0).in(sum_cpp), node.text, operand(1).in(sum_cpp)), comparison_cpp};
      case Node::Kind::logic:
        return node.text == "and"
                   ? Piece{operand(0).in(and_cpp) + " && " + operand(1).in(and_cpp), and_cpp}
                   : Piece{operand(0).in(comparison_cpp) + " || " + operand(1).in(comparison_cpp), or_cpp};
      default:
        return {"!" + operand(0).in(operand_cpp), unary_cpp};
    }
  };
  for (const Node& node : expression.nodes) pieces.push_back(piece(node));
  return pieces.back().text;
}

}  // namespace tchat::formulas
