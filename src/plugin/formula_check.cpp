#include "plugin/formula_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "plugin/expression.hpp"

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

namespace {

bool is_argument(const std::vector<Token>& arguments, const std::string& name) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const Token& token) { return token.text == name; });
}

}  // namespace

void StateDependence::join(const StateDependence& other) {
  on_states = on_states || other.on_states;
  if (!step) step = other.step;
  if (!kink) kink = other.kink;
}

DependenceTable::DependenceTable(const FormulaFile& file, const NameTable& names, FormulaErrors& errors)
    : file_(file), names_(names), entries_(file.definitions.size() + 2 * file.functions.size()) {
  const auto resolve_name = [&](const Token& name, bool moving) {
    path_.clear();
    collecting(errors, [&] { resolve({*names_.find(name.text), moving}, name.text, name.at); });
  };
  for (const Assignment& definition : file.definitions) resolve_name(definition.name, false);
  for (const FunctionDefinition& function : file.functions) resolve_name(function.name, false);
  if (!errors.empty()) return;
  for (const FunctionDefinition& function : file.functions) resolve_name(function.name, true);
}

std::size_t DependenceTable::place(const Use& use) const {
  if (use.symbol.kind == Symbol::Kind::definition) return use.symbol.index;
  return file_.definitions.size() + (use.moving_arguments ? file_.functions.size() : 0) + use.symbol.index;
}

const StateDependence& DependenceTable::resolve(const Use& use, const std::string& name, Position at) {
  const Symbol& symbol = use.symbol;
  Entry& found = entries_[place(use)];
  if (found.progress == Progress::done) return found.result;
  path_.push_back(name);
  if (found.progress == Progress::begun)
    throw FormulaError{at, fmt::format("'{}' is defined by itself: {}; a definition uses others only", name,
                                       fmt::join(std::find(path_.begin(), path_.end(), name), path_.end(), " -> "))};
  found.progress = Progress::begun;
  static const std::vector<Token> none;
  const bool is_function = symbol.kind == Symbol::Kind::function;
  const Expression& body = is_function ? file_.functions[symbol.index].body : file_.definitions[symbol.index].value;
  const std::vector<Token>& arguments = is_function ? file_.functions[symbol.index].arguments : none;
  found.result = of(body, {arguments, use.moving_arguments},
                    [&](const Use& next, const Node& node) { return resolve(next, node.text, node.at); });
  found.progress = Progress::done;
  path_.pop_back();
  return found.result;
}

template <class LookUp>
StateDependence DependenceTable::of(const Expression& expression, const Arguments& arguments,
                                    const LookUp& look_up) const {
  StateDependence all;
  std::vector<bool> moves(expression.nodes.size());
  for (std::size_t k = 0; k < expression.nodes.size(); ++k) {
    const Node& node = expression.nodes[k];
    bool moving = std::any_of(node.operands.begin(), node.operands.end(),
                              [&](int place) { return moves[static_cast<std::size_t>(place)]; });
    const bool is_used = node.kind == Node::Kind::name || node.kind == Node::Kind::call;
    const Symbol* const symbol = is_used ? names_.find(node.text) : nullptr;
    if (node.kind == Node::Kind::name && is_argument(arguments.names, node.text)) {
      moving = arguments.move;
    } else if (symbol != nullptr && symbol->kind == Symbol::Kind::state) {
      moving = true;
    } else if (symbol != nullptr && symbol->kind != Symbol::Kind::parameter) {
      const StateDependence inner = look_up({*symbol, moving && symbol->kind == Symbol::Kind::function}, node);
      moving = inner.on_states || moving;
      all.join(inner);
    } else if (const BuiltInFunction* const function = is_used ? find_function(node.text) : nullptr;
               function != nullptr && moving) {
      const Roughness here{node.text, node.at};
      if (function->nature == BuiltInFunction::Nature::stepped && !all.step) all.step = here;
      if (function->nature == BuiltInFunction::Nature::kinked && !all.kink) all.kink = here;
    }
    moves[k] = moving;
    all.on_states = all.on_states || moving;
  }
  return all;
}

StateDependence DependenceTable::of(const Expression& expression) const {
  static const std::vector<Token> none;
  return of(expression, {none, false}, [&](const Use& use, const Node&) { return entries_[place(use)].result; });
}

namespace {

constexpr double most_operations = 1e5;

class CostTable {
 public:
  CostTable(const FormulaFile& file, const NameTable& names)
      : file_(file), names_(names), costs_(file.functions.size(), unknown) {}

  /// Operations of one call. A definition is computed once in it, a function each time it is called.
  double of_function(std::size_t index) {
    if (costs_[index] != unknown) return costs_[index];
    std::set<std::size_t> definitions;
    double cost = of_expression(file_.functions[index].body, definitions);
    std::vector<std::size_t> waiting(definitions.begin(), definitions.end());
    while (!waiting.empty()) {
      std::set<std::size_t> further;
      cost += of_expression(file_.definitions[waiting.back()].value, further);
      waiting.pop_back();
      for (const std::size_t next : further)
        if (definitions.insert(next).second) waiting.push_back(next);
    }
    return costs_[index] = cost;
  }

 private:
  static constexpr double unknown = -1.0;

  /// Of its own parts and the functions that it calls; the definitions that it names are added to `definitions`.
  double of_expression(const Expression& expression, std::set<std::size_t>& definitions) {
    auto cost = static_cast<double>(expression.nodes.size());
    for (const Node& node : expression.nodes) {
      const bool is_named = node.kind == Node::Kind::name || node.kind == Node::Kind::call;
      const Symbol* const symbol = is_named ? names_.find(node.text) : nullptr;
      if (symbol == nullptr) continue;
      if (symbol->kind == Symbol::Kind::definition) definitions.insert(symbol->index);
      if (symbol->kind == Symbol::Kind::function && node.kind == Node::Kind::call) cost += of_function(symbol->index);
    }
    return cost;
  }

  const FormulaFile& file_;
  const NameTable& names_;
  std::vector<double> costs_;
};

}  // namespace

void refuse_expensive_functions(const FormulaFile& file, const NameTable& names, FormulaErrors& errors) {
  CostTable costs(file, names);
  for (std::size_t k = 0; k < file.functions.size(); ++k) {
    const double cost = costs.of_function(k);
    if (cost <= most_operations) continue;
    const Token& name = file.functions[k].name;
    errors.add(name.at,
               fmt::format("a value of the function {} takes {:.2g} operations, as functions that it calls are "
                           "computed anew at every call; at most {:g} are allowed; give results that are "
                           "needed twice a name (NAME = EXPRESSION), which is computed once",
                           name.text, cost, most_operations));
    return;  // those that call it are no better
  }
}

}  // namespace tchat::formulas
