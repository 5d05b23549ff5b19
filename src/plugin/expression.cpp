#include "plugin/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace tchat::formulas {

namespace {

using Nature = BuiltInFunction::Nature;

double heaviside(double x) { return x >= 0.0 ? 1.0 : 0.0; }
double sign_of(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
double remainder_of(double a, double b) { return a - b * std::floor(a / b); }
double larger_of(double a, double b) { return a < b ? b : a; }
double smaller_of(double a, double b) { return b < a ? b : a; }

constexpr BuiltInFunction smooth(const char* name, double (*function)(double), const char* cpp = nullptr) {
  return {name, 1, Nature::smooth, cpp != nullptr ? cpp : name, function, nullptr};
}

const std::array<BuiltInFunction, 33> functions = {{
    smooth("sin", std::sin),
    smooth("cos", std::cos),
    smooth("tan", std::tan),
    smooth("asin", std::asin),
    smooth("acos", std::acos),
    smooth("atan", std::atan),
    smooth("sinh", std::sinh),
    smooth("cosh", std::cosh),
    smooth("tanh", std::tanh),
    smooth("asinh", std::asinh),
    smooth("acosh", std::acosh),
    smooth("atanh", std::atanh),
    smooth("exp", std::exp),
    smooth("log", std::log),
    smooth("ln", std::log, "log"),
    smooth("log10", std::log10),
    smooth("log2", std::log2),
    smooth("sqrt", std::sqrt),
    smooth("cbrt", std::cbrt),
    {"pow", 2, Nature::smooth, "pow", nullptr, std::pow},
    {"atan2", 2, Nature::smooth, "atan2", nullptr, std::atan2},
    {"hypot", 2, Nature::smooth, "hypot", nullptr, std::hypot},
    {"abs", 1, Nature::kinked, "fabs", std::fabs, nullptr},
    {"fabs", 1, Nature::kinked, "fabs", std::fabs, nullptr},
    {"max", 2, Nature::kinked, "larger<T>", nullptr, larger_of},
    {"min", 2, Nature::kinked, "smaller<T>", nullptr, smaller_of},
    {"sign", 1, Nature::stepped, "sign_of<T>", sign_of, nullptr},
    {"sgn", 1, Nature::stepped, "sign_of<T>", sign_of, nullptr},
    {"heav", 1, Nature::stepped, "heaviside<T>", heaviside, nullptr},
    {"heaviside", 1, Nature::stepped, "heaviside<T>", heaviside, nullptr},
    {"floor", 1, Nature::stepped, "floor_of<T>", std::floor, nullptr},
    {"flr", 1, Nature::stepped, "floor_of<T>", std::floor, nullptr},
    {"mod", 2, Nature::stepped, "remainder_of<T>", nullptr, remainder_of},
}};

}  // namespace

const BuiltInFunction* find_function(std::string_view name) {
  const auto found = std::find_if(functions.begin(), functions.end(),
                                  [name](const BuiltInFunction& function) { return function.name == name; });
  return found != functions.end() ? &*found : nullptr;
}

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const BuiltInFunction& function : functions) names.emplace_back(function.name);
  return names;
}

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

namespace {

const std::set<std::string>& taken_names() {
  static const std::set<std::string> names = {
      // keywords and alternative operators
      "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char",
      "char8_t", "char16_t", "char32_t", "class", "compl", "concept", "const", "consteval", "constexpr", "constinit",
      "const_cast", "continue", "co_await", "co_return", "co_yield", "decltype", "default", "delete", "do", "double",
      "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if",
      "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or",
      "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "requires", "return", "short",
      "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this",
      "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual",
      "void", "volatile", "wchar_t", "while", "xor", "xor_eq",
      // macros of the standard headers, in small letters
      "alloca", "be16toh", "be32toh", "be64toh", "errno", "htobe16", "htobe32", "htobe64", "htole16", "htole32",
      "htole64", "issubnormal", "le16toh", "le32toh", "le64toh", "linux", "math_errhandling", "offsetof",
      "pthread_cleanup_pop", "pthread_cleanup_pop_restore_np", "pthread_cleanup_push", "pthread_cleanup_push_defer_np",
      "sched_priority", "stderr", "stdin", "stdout", "unix", "va_arg", "va_copy", "va_end", "va_start",
      // what the translation itself uses
      "T", "std", "tchat", "state", "par", "rate", "image", "index", "from", "values", "i", "field", "event", "jump",
      "successors", "user_value", "dimension", "parameters", "fields", "events", "jumps", "user_values", "state_names",
      "parameter_names", "field_names", "event_names", "jump_names", "user_value_names", "initial_parameters",
      "initial_state", "field_derivatives", "event_derivatives", "jump_derivatives", "square", "cube", "larger",
      "smaller", "sign_of", "heaviside", "floor_of", "remainder_of", "pow", "fabs", "sin", "cos", "tan", "asin", "acos",
      "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp", "log", "log10", "log2", "sqrt", "cbrt", "atan2",
      "hypot"};
  return names;
}

/// Macros of the standard headers have capitals only, or begin with one and have an underscore (M_PIf, L_ctermid).
bool may_be_macro(const std::string& name) {
  const auto is_small = [](unsigned char c) { return std::islower(c) != 0; };
  const bool capital = std::isupper(static_cast<unsigned char>(name[0])) != 0;
  const bool no_small = std::none_of(name.begin(), name.end(), is_small);
  return capital && name.size() > 1 && (no_small || name.find('_') != std::string::npos);
}

bool is_reserved(const std::string& name) { return name[0] == '_' || name.find("__") != std::string::npos; }

}  // namespace

std::string CppNames::unique(const std::string& name) {
  std::string result = name;
  if (is_reserved(result)) {
    result.erase(std::unique(result.begin(), result.end(), [](char a, char b) { return a == '_' && b == '_'; }),
                 result.end());
    result = "name" + std::string(result[0] == '_' ? "" : "_") + result;
  }
  if (may_be_macro(result) || taken_names().count(result) != 0) result += "_";
  for (std::string free = result;; free = result + std::to_string(used_.size()))
    if (taken_names().count(free) == 0 && used_.insert(free).second) return free;
}

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
