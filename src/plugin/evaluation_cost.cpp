#include "plugin/evaluation_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

namespace tchat::formulas {

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
