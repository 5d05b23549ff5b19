#include "plugin/dependence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "plugin/function_table.hpp"

namespace tchat::formulas {

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

}  // namespace tchat::formulas
