#include "explore/explored_diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "tables/table_format.hpp"

namespace tchat {

namespace {

std::string label_text(const ExploredLabel& label) {
  std::string text = fmt::format("{} {} at {:.10g}", label.type, label.label, label.parameter);
  if (!label.leads_to.empty()) text += " -> " + label.leads_to;
  if (!label.remark.empty()) text += ": " + label.remark;
  return text;
}

std::string json(const std::string& text) { return json_value(text); }
std::string json(double value) { return json_value(value); }
std::string json(int value) { return json_value(value); }

template <class List, class Text>
std::string json_list(const List& list, const Text& text) {
  std::string result;
  for (const auto& one : list) result += (result.empty() ? "" : ", ") + text(one);
  return "[" + result + "]";
}

std::string branch_json(const ExploredBranch& branch) {
  const std::string labels = json_list(branch.labels, [](const ExploredLabel& label) {
    return fmt::format(R"({{"label": {}, "type": {}, "parameter": {}, "leads_to": {}, "remark": {}}})",
                       json(label.label), json(label.type), json(label.parameter), json(label.leads_to),
                       json(label.remark));
  });
  const auto texts = [](const std::string& text) { return json(text); };
  return fmt::format(
      R"({{"name": {}, "parent": {}, "origin": {}, "from": {}, "to": {}, "signatures": {}, "labels": {}, "commands": {}}})",
      json(branch.name), json(branch.parent), json(branch.origin), json(branch.from), json(branch.to),
      json_list(branch.signatures, texts), labels, json_list(branch.job.lines, texts));
}

std::string share(const ExploredDiagram& diagram) {
  if (diagram.periodic == 0) return "no periodic attractor";
  return fmt::format("{} of {} periodic attractors of the sweep lie on branches ({:.4g} %)", diagram.on_branches,
                     diagram.periodic, 100.0 * diagram.on_branches / diagram.periodic);
}

}  // namespace

std::string tree_text(const ExploredDiagram& diagram) {
  std::string text = fmt::format("Branches over {}:\n", diagram.parameter);
  const std::function<void(const std::string&, int)> add = [&](const std::string& parent, int depth) {
    for (const ExploredBranch& branch : diagram.branches) {
      if (branch.parent != parent) continue;
      const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
      text += fmt::format("{}{}  {:.6g} to {:.6g}, {}\n", indent, branch.name, branch.from, branch.to, branch.origin);
      for (const ExploredLabel& label : branch.labels) text += fmt::format("{}    {}\n", indent, label_text(label));
      add(branch.name, depth + 1);
    }
  };
  add("", 0);
  if (diagram.branches.empty()) text += "  none\n";
  text += fmt::format("\n{} branches. Coverage: {}.\n", diagram.branches.size(), share(diagram));
  if (diagram.other > 0) text += fmt::format("{} attractors are not periodic.\n", diagram.other);
  for (const UnexplainedAttractor& one : diagram.unexplained)
    text += fmt::format("On no branch: attractor {} ({}), {} times from {:.6g} to {:.6g}{}\n", one.attractor, one.kind,
                        one.count, one.first, one.last, one.command.empty() ? "" : ": " + one.command);
  if (!diagram.left.empty()) text += fmt::format("Left: {}.\n", diagram.left);
  if (!diagram.complete) text += "Not complete: the same command goes on.\n";
  return text;
}

std::string tree_json(const ExploredDiagram& diagram) {
  const std::string unexplained = json_list(diagram.unexplained, [](const UnexplainedAttractor& one) {
    return fmt::format(R"({{"attractor": {}, "kind": {}, "count": {}, "first": {}, "last": {}, "command": {}}})",
                       json(one.attractor), json(one.kind), json(one.count), json(one.first), json(one.last),
                       json(one.command));
  });
  return fmt::format(
      "{{\"parameter\": {}, \"quantity\": {}, \"complete\": {}, \"periodic\": {}, \"on_branches\": {}, "
      "\"not_periodic\": {},\n"
      "\"unexplained\": {},\n\"joins\": {},\n\"branches\": {}}}\n",
      json(diagram.parameter), json(diagram.quantity), diagram.complete, json(diagram.periodic),
      json(diagram.on_branches), json(diagram.other), unexplained,
      json_list(diagram.joins, [](const std::string& text) { return json(text); }),
      json_list(diagram.branches, branch_json));
}

std::vector<CommandJob> jobs_of(const ExploredDiagram& diagram) {
  std::vector<CommandJob> jobs = diagram.first_jobs;
  for (const ExploredBranch& branch : diagram.branches) jobs.push_back(branch.job);
  return jobs;
}

}  // namespace tchat
