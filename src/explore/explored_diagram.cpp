#include "explore/explored_diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "explore/json_list.hpp"

namespace tchat {

namespace {

std::string json(const std::string& text) { return json_value(text); }
std::string json(double value) { return json_value(value); }
std::string json(int value) { return json_value(value); }

std::string share(const ExploredDiagram& diagram) {
  if (diagram.periodic == 0) return "no periodic attractor";
  return fmt::format("{} of {} periodic attractors of the sweep lie on branches ({:.4g} %)", diagram.on_branches,
                     diagram.periodic, 100.0 * diagram.on_branches / diagram.periodic);
}

/// A word in a rule.
std::string in_rule(const std::string& word) {
  std::string text;
  for (const char c : word) {
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

std::string rule(const CommandJob& job) {
  std::string text;
  for (const std::string& file : job.outputs) text += file + " ";
  text += "&:";
  for (const std::string& file : job.inputs) text += " " + file;
  text += " | $(FOLDER)\n";
  for (const std::string& line : job.lines)
    text += "\t" + (line.starts_with("tchat ") ? "$(TCHAT)" + in_rule(line.substr(5)) : in_rule(line)) + "\n";
  return text + "\n";
}

}  // namespace

std::string label_text(const ExploredLabel& label) {
  std::string text = fmt::format("{} {} at {:.10g}", label.type, label.label, label.parameter);
  if (!label.leads_to.empty()) text += " -> " + label.leads_to;
  if (!label.remark.empty()) text += ": " + label.remark;
  if (!label.curve.empty()) text += ", curve " + label.curve;
  return text;
}

std::string branch_json(const ExploredBranch& branch) {
  const std::string labels = json_list(branch.labels, [](const ExploredLabel& label) {
    return fmt::format(R"({{"label": {}, "type": {}, "parameter": {}, "leads_to": {}, "remark": {}, "curve": {}}})",
                       json(label.label), json(label.type), json(label.parameter), json(label.leads_to),
                       json(label.remark), json(label.curve));
  });
  return fmt::format(
      R"({{"name": {}, "parent": {}, "origin": {}, "from": {}, "to": {}, "signatures": {}, "labels": {}, "commands": {}}})",
      json(branch.name), json(branch.parent), json(branch.origin), json(branch.from), json(branch.to),
      json_list(branch.signatures), labels, json_list(branch.job.lines));
}

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

std::string tree_json(const ExploredDiagram& diagram, const std::string& further) {
  const std::string unexplained = json_list(diagram.unexplained, [](const UnexplainedAttractor& one) {
    return fmt::format(R"({{"attractor": {}, "kind": {}, "count": {}, "first": {}, "last": {}, "command": {}}})",
                       json(one.attractor), json(one.kind), json(one.count), json(one.first), json(one.last),
                       json(one.command));
  });
  return fmt::format(
      "{{\"parameter\": {}, \"complete\": {}, \"periodic\": {}, \"on_branches\": {}, \"not_periodic\": {},\n"
      "\"unexplained\": {},\n\"joins\": {},\n\"branches\": {}{}}}\n",
      json(diagram.parameter), diagram.complete, json(diagram.periodic), json(diagram.on_branches), json(diagram.other),
      unexplained, json_list(diagram.joins), json_list(diagram.branches, branch_json), further);
}

std::string makefile_text(const ExploredDiagram& diagram, const std::string& folder,
                          const std::vector<const CommandJob*>& further) {
  std::string all;
  for (const ExploredBranch& branch : diagram.branches) all += " " + branch.job.outputs.front();
  for (const CommandJob* job : further) all += " " + job->outputs.front();
  std::string text = fmt::format(
      "# Makes the branches of {} with make -f, also with -j.\nTCHAT = tchat\nFOLDER = {}\n\nall:{}\n\n{}:\n\tmkdir -p "
      "$@\n\n",
      folder, folder, all, "$(FOLDER)");
  for (const CommandJob& job : diagram.first_jobs) text += rule(job);
  for (const ExploredBranch& branch : diagram.branches) text += rule(branch.job);
  for (const CommandJob* job : further) text += rule(*job);
  return text;
}

}  // namespace tchat
