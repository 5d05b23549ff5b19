#include "plugin/expression_value.hpp"

#include <fmt/format.h>

#include <cmath>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

namespace {

double arithmetic_value(char symbol, double a, double b) {
  switch (symbol) {
    case '+':
      return a + b;
    case '-':
      return a - b;
    case '*':
      return a * b;
    case '/':
      return a / b;
    default:
      return std::pow(a, b);
  }
}

double call_value(const Node& node, const std::vector<double>& arguments, const std::string& role) {
  const BuiltInFunction* const function = find_function(node.text);
  if (function == nullptr || static_cast<std::size_t>(function->arguments) != arguments.size())
    throw FormulaError{node.at, fmt::format("{} is a number; '{}' is no built-in function of {} argument(s)", role,
                                            node.text, arguments.size())};
  return function->of_one != nullptr ? function->of_one(arguments[0]) : function->of_two(arguments[0], arguments[1]);
}

double node_value(const Node& node, const std::vector<double>& operands, const std::string& role) {
  switch (node.kind) {
    case Node::Kind::number:
      return node.number;
    case Node::Kind::negation:
      return -operands[0];
    case Node::Kind::arithmetic:
      return arithmetic_value(node.text[0], operands[0], operands[1]);
    case Node::Kind::call:
      return call_value(node, operands, role);
    case Node::Kind::name:
      if (node.text == "pi") return 3.14159265358979323846;
      throw FormulaError{
          node.at,
          fmt::format(
              "{} is a number, so '{}' cannot be used in it; write its value, or a definition: NAME = EXPRESSION", role,
              node.text)};
    default:
      throw FormulaError{node.at, fmt::format("{} is a number, not a condition", role)};
  }
}

}  // namespace

double constant_value(const Expression& expression, const std::string& role) {
  std::vector<double> values;
  for (const Node& node : expression.nodes) {
    std::vector<double> operands;
    for (const int place : node.operands) operands.push_back(values[static_cast<std::size_t>(place)]);
    values.push_back(node_value(node, operands, role));
  }
  if (!std::isfinite(values.back())) throw FormulaError{expression.at, fmt::format("{} is not a finite number", role)};
  return values.back();
}

}  // namespace tchat::formulas
