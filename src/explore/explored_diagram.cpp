#include "explore/explored_diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "explore/json_list.hpp"

namespace tchat {

namespace {

std::string json(const std::string& text) { return json_value(text); }
std::string json(double value) { return json_value(value); }
std::string json(int value) { return json_value(value); }

std::string percent(int part, int whole) { return fmt::format("{:.4g} %", 100.0 * part / whole); }

/// How periodic attractors are known to lie on branches.
std::string evidence_text(const ExploredDiagram& diagram) {
  if (diagram.periodic == 0) return "";
  const std::string several =
      diagram.on_several == 0 ? "" : fmt::format("; {} match more than one branch", diagram.on_several);
  return fmt::format(", {}by signature, period and largest values{}", diagram.at_rest > 0 ? "periodic ones " : "",
                     several);
}

/// "341 of 341 periodic attractors of the sweep lie on branches (100 %), by signature, period and largest values"
std::string coverage_text(const ExploredDiagram& diagram) {
  const int known = diagram.periodic + diagram.at_rest;
  if (known == 0) return "no periodic attractor, none at rest";
  const char* const kinds = diagram.at_rest == 0    ? "periodic attractors"
                            : diagram.periodic == 0 ? "equilibria"
                                                    : "periodic attractors and equilibria";
  return fmt::format("{} of {} {} of the sweep lie on branches ({}){}", diagram.on_branches, known, kinds,
                     percent(diagram.on_branches, known), evidence_text(diagram));
}

/// Values and starts that lead elsewhere, with their share of all.
std::string others_text(const ExploredDiagram& diagram) {
  int all = diagram.periodic + diagram.at_rest;
  for (const auto& [kind, count] : diagram.others) all += count;
  std::string text;
  for (const auto& [kind, count] : diagram.others)
    text += fmt::format("{}{} {} ({})", text.empty() ? "" : ", ", count, kind, percent(count, all));
  return text.empty() ? "" : "Other motions: " + text + ".\n";
}

std::string left_text(const ExploredDiagram& diagram) {
  int all = 0;
  std::string text;
  for (const auto& [budget, count] : diagram.left) {
    all += count;
    text += fmt::format("{}{} by {}", text.empty() ? "" : ", ", count, budget);
  }
  return all == 0 ? "" : fmt::format("Left: {} starts of branches, at least; {}.\n", all, text);
}

std::string counts_json(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [key, count] : counts)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", json(key), json(count));
  return "{" + text + "}";
}

}  // namespace

std::vector<std::string> signatures_of(const PointFile& points) {
  std::vector<std::string> list;
  for (const PointSection& section : points.sections) {
    Signature signature;
    for (const auto& v : section.signature) signature.push_back({v[0], v[1], v[2]});
    const std::string text = to_string(signature);
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
  }
  return list;
}

void describe_points(const PointFile& points, const SweptRange& range, ExploredBranch& branch) {
  branch.signatures = signatures_of(points);
  branch.from = std::numeric_limits<double>::infinity();
  branch.to = -branch.from;
  for (const PointSection& section : points.sections)
    for (const PointRow& row : section.rows) {
      branch.from = std::max(range.from, std::min(branch.from, row.values.front()));
      branch.to = std::min(range.to, std::max(branch.to, row.values.front()));
    }
}

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
      for (const std::string& end : branch.ends) text += fmt::format("{}    ends: {}\n", indent, end);
      add(branch.name, depth + 1);
    }
  };
  add("", 0);
  if (diagram.branches.empty()) text += "  none\n";
  text += fmt::format("\n{} branches. Coverage: {}.\n", diagram.branches.size(), coverage_text(diagram));
  text += others_text(diagram);
  for (const std::string& failure : diagram.failures) text += "Failed: " + failure + ".\n";
  for (const UnexplainedAttractor& one : diagram.unexplained)
    text +=
        fmt::format("On no branch: attractor {} ({}{}), {} times from {:.6g} to {:.6g}{}\n", one.attractor, one.kind,
                    one.segments > 0 ? fmt::format(", {} segments", one.segments) : "", one.count, one.first, one.last,
                    (one.leads_to.empty() ? "" : "; a start there leads to " + one.leads_to) +
                        (one.command.empty() ? "" : ": " + one.command));
  text += left_text(diagram);
  if (!diagram.complete) text += "Not complete: the same command goes on.\n";
  return text;
}

std::string tree_json(const ExploredDiagram& diagram, const std::string& further) {
  const std::string unexplained = json_list(diagram.unexplained, [](const UnexplainedAttractor& one) {
    return fmt::format(
        R"({{"attractor": {}, "kind": {}, "count": {}, "first": {}, "last": {}, "segments": {}, "leads_to": {}, "command": {}}})",
        json(one.attractor), json(one.kind), json(one.count), json(one.first), json(one.last), json(one.segments),
        json(one.leads_to), json(one.command));
  });
  return fmt::format(
      "{{\"parameter\": {}, \"quantity\": {}, \"complete\": {}, \"periodic\": {}, \"at_rest\": {}, \"on_branches\": "
      "{}, \"on_several\": {}, "
      "\"others\": {}, \"left\": {},\n\"unexplained\": {},\n\"joins\": {},\n\"failures\": {},\n\"branches\": {}{}}}\n",
      json(diagram.parameter), json(diagram.quantity), diagram.complete, json(diagram.periodic), json(diagram.at_rest),
      json(diagram.on_branches), json(diagram.on_several), counts_json(diagram.others), counts_json(diagram.left),
      unexplained, json_list(diagram.joins), json_list(diagram.failures), json_list(diagram.branches, branch_json),
      further);
}

std::vector<CommandJob> jobs_of(const ExploredDiagram& diagram) {
  std::vector<CommandJob> jobs = diagram.first_jobs;
  for (const ExploredBranch& branch : diagram.branches) jobs.push_back(branch.job);
  return jobs;
}

}  // namespace tchat
