#include "plugin/expression_parser.hpp"

#include <fmt/format.h>

#include <string_view>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

namespace {

constexpr int deepest = 200;
constexpr std::size_t most_nodes = 2000;

/// How tightly operators hold their operands; 0 is no operator.
enum Binding { no_operator = 0, disjunction, conjunction, inversion, comparison, sum, product, sign, power };

Binding binding_of(const Token& token) {
  if (token.is("or")) return disjunction;
  if (token.is("and")) return conjunction;
  for (const char* symbol : {"<", ">", "<=", ">=", "==", "!="})
    if (token.is(symbol)) return comparison;
  if (token.is("+") || token.is("-")) return sum;
  if (token.is("*") || token.is("/")) return product;
  if (token.is("^")) return power;
  return no_operator;
}

Node::Kind kind_of(Binding binding) {
  if (binding == comparison) return Node::Kind::comparison;
  return binding <= conjunction ? Node::Kind::logic : Node::Kind::arithmetic;
}

class ExpressionParser {
 public:
  explicit ExpressionParser(TokenReader& in) : in_(in) {}

  Expression whole() {
    expression_.at = in_.peek().at;
    operation(disjunction);
    return std::move(expression_);
  }

 private:
  /// An operand and all operators that hold at least as tightly as `least`. Returns the node's place.
  int operation(int least) {
    const Depth depth(*this);
    int left = operand();
    for (Binding binding = binding_of(in_.peek()); binding >= least && binding != no_operator;
         binding = binding_of(in_.peek())) {
      const Token& symbol = in_.next();
      const int right = operation(binding == power ? power : binding + 1);
      left = add({kind_of(binding), symbol.text, 0.0, {left, right}, symbol.at});
      if (binding == comparison && binding_of(in_.peek()) == comparison)
        throw FormulaError{in_.peek().at, "comparisons are not chained; join them with 'and', as 0 < x and x < 1"};
    }
    return left;
  }

  int operand() {
    const Token& token = in_.peek();
    if (token.kind == Token::Kind::number) {
      in_.next();
      return add({Node::Kind::number, token.text, token.number, {}, token.at});
    }
    if (token.is("-") || token.is("+")) return signed_operand();
    if (token.is("(")) return parenthesis();
    if (token.is("not")) {
      in_.next();
      return add({Node::Kind::inversion, "not", 0.0, {operation(inversion)}, token.at});
    }
    if (token.is_name() && binding_of(token) == no_operator) return name_or_call();
    if (token.is("=")) throw FormulaError{token.at, "there is an '=' too many; equality in a condition is =="};
    throw FormulaError{token.at,
                       fmt::format("a number, a name or a parenthesis is expected here, not {}", shown(token))};
  }

  int signed_operand() {
    const Token& symbol = in_.next();
    const int value = operation(sign);
    return symbol.is("+") ? value : add({Node::Kind::negation, "-", 0.0, {value}, symbol.at});
  }

  int parenthesis() {
    const Token& open = in_.next();
    const int value = operation(disjunction);
    close(open);
    refuse_operand_after(")");
    return value;
  }

  int name_or_call() {
    const Token& name = in_.next();
    if (find_function(name.text) != nullptr && (in_.peek().is_name() || in_.peek().kind == Token::Kind::number))
      throw FormulaError{in_.peek().at, fmt::format("the argument of {} stands in parentheses, as {}({})", name.text,
                                                    name.text, in_.peek().text.substr(0, 40))};
    if (!in_.peek().is("(")) return add({Node::Kind::name, name.text, 0.0, {}, name.at});
    const Token& open = in_.next();
    Node call{Node::Kind::call, name.text, 0.0, {}, name.at};
    do {
      call.operands.push_back(operation(disjunction));
    } while (in_.accept(","));
    close(open);
    refuse_operand_after(")");
    return add(std::move(call));
  }

  void close(const Token& open) {
    if (in_.accept(")")) return;
    throw FormulaError{in_.peek().at, fmt::format("a closing parenthesis or an operator is expected here, not {}; the "
                                                  "parenthesis was opened in column {}{}",
                                                  shown(in_.peek()), open.at.column, line_if_other(open))};
  }

  std::string line_if_other(const Token& open) const {
    return open.at.line == in_.peek().at.line ? "" : fmt::format(" of line {}", open.at.line);
  }

  void refuse_operand_after(const std::string& what) {
    if (in_.peek().is("("))
      throw FormulaError{in_.peek().at, fmt::format("'(' follows {} directly; write * between factors", what)};
  }

  int add(Node node) {
    if (expression_.nodes.size() >= most_nodes)
      throw FormulaError{
          node.at, fmt::format("the expression has more than {} parts; name parts of it by definitions", most_nodes)};
    expression_.nodes.push_back(std::move(node));
    return expression_.root();
  }

  /// Counts how deep operations are nested: the recursion must end before the stack does.
  class Depth {
   public:
    explicit Depth(ExpressionParser& parser) : parser_(parser) {
      if (++parser_.depth_ > deepest)
        throw FormulaError{parser_.in_.peek().at,
                           fmt::format("parentheses are nested more than {} deep; name parts of the expression by "
                                       "definitions",
                                       deepest)};
    }
    ~Depth() { --parser_.depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;

   private:
    ExpressionParser& parser_;
  };

  TokenReader& in_;
  Expression expression_;
  int depth_ = 0;
};

}  // namespace

Expression parse_expression(TokenReader& in) { return ExpressionParser(in).whole(); }

}  // namespace tchat::formulas
