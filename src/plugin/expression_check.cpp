#include "plugin/expression_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

namespace {

/// What a name that is not known may have been meant as.
std::string cure_for(const std::string& name, const NameTable& names) {
  if (name == "t")
    return ": time does not appear in formulas; give the forcing two states, or a clock as a state (t' = 1)";
  if (name == "U" || name == "PAR") return ": states and parameters are used by their names here, not by numbers";
  if (name == "if" || name == "then" || name == "else")
    return ": each piece is a field of its own, and an event ends it";
  if (const std::string meant = did_you_mean(name, names.all()); !meant.empty()) return meant;
  return "; define it, as 'par NAME=VALUE' or 'NAME = EXPRESSION'";
}

}  // namespace

void ExpressionCheck::value(const Expression& expression, const std::vector<Token>& arguments) const {
  check(expression, arguments);
  if (const Node& root = expression.nodes.back(); root.is_condition())
    errors_.add(root.at, fmt::format("'{}' gives a condition where a number is needed", root.text));
}

void ExpressionCheck::condition(const Expression& expression) const {
  check(expression, {});
  if (const Node& root = expression.nodes.back(); !root.is_condition())
    errors_.add(root.at, "a condition is needed behind 'if', such as x < 0");
}

void ExpressionCheck::check(const Expression& expression, const std::vector<Token>& arguments) const {
  for (const Node& node : expression.nodes) collecting(errors_, [&] { check_node(expression, node, arguments); });
}

void ExpressionCheck::check_node(const Expression& expression, const Node& node,
                                 const std::vector<Token>& arguments) const {
  if (node.kind == Node::Kind::name) check_name(node, arguments);
  if (node.kind == Node::Kind::call) check_call(node);
  const bool takes_conditions = node.kind == Node::Kind::logic || node.kind == Node::Kind::inversion;
  for (const int place : node.operands)
    if (const Node& operand = expression.node(place); operand.is_condition() != takes_conditions)
      throw FormulaError{operand.at, takes_conditions
                                         ? fmt::format("'{}' joins conditions, such as x < 0", node.text)
                                         : "a condition stands where a number is needed; each piece of a system is a "
                                           "field of its own, and an event ends it"};
}

void ExpressionCheck::check_name(const Node& node, const std::vector<Token>& arguments) const {
  const auto is_same = [&](const Token& token) { return token.text == node.text; };
  if (node.text == "pi" || std::any_of(arguments.begin(), arguments.end(), is_same)) return;
  const Symbol* const symbol = names_.find(node.text);
  if ((symbol != nullptr && symbol->kind == Symbol::Kind::function) || find_function(node.text) != nullptr)
    throw FormulaError{node.at, fmt::format("'{0}' is a function; write its argument, as {0}(...)", node.text)};
  if (symbol == nullptr) refuse_unknown(node);
}

void ExpressionCheck::check_call(const Node& node) const {
  const Symbol* const symbol = names_.find(node.text);
  const bool is_ours = symbol != nullptr && symbol->kind == Symbol::Kind::function;
  const BuiltInFunction* const built_in = is_ours ? nullptr : find_function(node.text);
  if (symbol != nullptr && !is_ours)
    throw FormulaError{
        node.at, fmt::format("'{}' is {}, no function; write * between factors", node.text, in_words(symbol->kind))};
  if (!is_ours && built_in == nullptr) refuse_unknown(node);
  const std::size_t wanted =
      is_ours ? file_.functions[symbol->index].arguments.size() : static_cast<std::size_t>(built_in->arguments);
  if (node.operands.size() != wanted)
    throw FormulaError{node.at, fmt::format("the function {} has {} argument{}, here are {}", node.text, wanted,
                                            wanted == 1 ? "" : "s", node.operands.size())};
}

void ExpressionCheck::refuse_unknown(const Node& node) const {
  throw FormulaError{node.at, fmt::format("'{}' is not known{}", node.text.substr(0, 60), cure_for(node.text, names_))};
}

}  // namespace tchat::formulas
