#include "explore/explored_diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

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

std::string lines_json(const CommandJob& job) {
  return json_list(job.commands, [](const Command& command) { return json(shell_line(command)); });
}

}  // namespace

std::vector<std::string> signatures_of(const PointFile& points) {
  std::vector<std::string> list;
  for (const PointSection& section : points.sections) {
    const std::string text = to_string(section.signature);
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

std::string losses_json(const std::vector<RecordedLoss>& losses) {
  return json_list(losses, [](const RecordedLoss& lost) {
    return fmt::format(R"({{"from": {}, "to": {}, "text": {}}})", json(lost.from), json(lost.to), json(lost.text));
  });
}

std::string losses_text(const std::vector<RecordedLoss>& losses, const std::string& indent,
                        const std::string& parameter) {
  std::string text;
  for (const RecordedLoss& lost : losses)
    text += fmt::format("{}    a special point may be missing between {} = {:.8g} and {:.8g}: {}\n", indent, parameter,
                        lost.from, lost.to, lost.text);
  return text;
}

std::string branch_json(const ExploredBranch& branch) {
  const std::string labels = json_list(branch.labels, [](const ExploredLabel& label) {
    return fmt::format(R"({{"label": {}, "type": {}, "parameter": {}, "leads_to": {}, "remark": {}, "curve": {}}})",
                       json(label.label), json(label.type), json(label.parameter), json(label.leads_to),
                       json(label.remark), json(label.curve));
  });
  return fmt::format(
      R"({{"name": {}, "parent": {}, "origin": {}, "mirror_of": {}, "from": {}, "to": {}, "points": {}, "inadmissible": {}, "signatures": {}, "ends": {}, "may_be_missing": {}, "labels": {}, "commands": {}}})",
      json(branch.name), json(branch.parent), json(branch.origin), json(branch.mirror_of), json(branch.from),
      json(branch.to), json(branch.points), json(branch.inadmissible), json_list(branch.signatures),
      json_list(branch.ends,
                [](const RecordedEnd& end) {
                  return fmt::format(R"({{"reason": {}, "text": {}}})", json(end.reason), json(end.text));
                }),
      losses_json(branch.lost), labels, lines_json(branch.job));
}

std::string tree_text(const ExploredDiagram& diagram) {
  std::string text = fmt::format("Branches over {}:\n", diagram.parameter);
  const std::function<void(const std::string&, int)> add = [&](const std::string& parent, int depth) {
    for (const ExploredBranch& branch : diagram.branches) {
      if (branch.parent != parent) continue;
      const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
      text += fmt::format("{}{}  {:.6g} to {:.6g}, {}\n", indent, branch.name, branch.from, branch.to, branch.origin);
      for (const ExploredLabel& label : branch.labels) text += fmt::format("{}    {}\n", indent, label_text(label));
      if (branch.inadmissible > 0)
        text += fmt::format("{}    {} of {} points are inadmissible\n", indent, branch.inadmissible, branch.points);
      text += losses_text(branch.lost, indent, diagram.parameter);
      for (const RecordedEnd& end : branch.ends) text += fmt::format("{}    ends: {}\n", indent, end.text);
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
                        (one.command.empty() ? "" : ": " + shell_line(one.command)));
  text += left_text(diagram);
  if (!diagram.complete) text += "Not complete: the same command goes on.\n";
  return text;
}

std::string tree_json(const ExploredDiagram& diagram, const std::string& further) {
  const std::string unexplained = json_list(diagram.unexplained, [](const UnexplainedAttractor& one) {
    return fmt::format(
        R"({{"attractor": {}, "kind": {}, "count": {}, "first": {}, "last": {}, "segments": {}, "leads_to": {}, "command": {}}})",
        json(one.attractor), json(one.kind), json(one.count), json(one.first), json(one.last), json(one.segments),
        json(one.leads_to), json(one.command.empty() ? "" : shell_line(one.command)));
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

namespace {

std::string place_text(double first, double second) { return fmt::format("({:.10g}, {:.10g})", first, second); }

std::string label_text(const CurveLabel& label) {
  std::string text = fmt::format("{} {} at {}", label.type, label.label, place_text(label.first, label.second));
  if (!label.detail.empty()) text += ": " + label.detail;
  if (!label.leads_to.empty()) text += fmt::format(" -> {}", fmt::join(label.leads_to, ", "));
  return text;
}

std::string end_text(const CurveEnd& end) {
  return fmt::format("ends at {}: {}", place_text(end.first, end.second), end.reason);
}

std::string curve_text(const ExploredCurves& all, const ExploredCurve& curve) {
  std::string text = fmt::format("{}  {}: {}; {}\n", curve.name, origin_text(curve), range_text(all, curve),
                                 fmt::join(curve.signatures, ", "));
  if (curve.inadmissible > 0)
    text += fmt::format("    {} of {} points are inadmissible\n", curve.inadmissible, curve.points);
  for (const CurveEnd& end : curve.ends) text += "    " + end_text(end) + "\n";
  text += losses_text(curve.lost, "", all.first);
  for (const CurveLabel& label : curve.labels) text += "    " + label_text(label) + "\n";
  return text;
}

std::string slice_text(const ExploredCurves& all, const ExploredBranch& slice) {
  std::string text =
      fmt::format("{}  {}: {} {:.6g} to {:.6g}\n", slice.name, slice.origin, all.first, slice.from, slice.to);
  for (const ExploredLabel& label : slice.labels) text += fmt::format("    {}\n", label_text(label));
  return text;
}

std::string member_text(const JoinedCurve& member) {
  std::string text =
      member.label > 0 ? fmt::format("{} {} of {}", member.type, member.label, member.curve) : "on " + member.curve;
  return text + (member.is_end ? " (its end)" : "");
}

std::string joint_text(const JoinedPoint& point) {
  std::string members;
  for (const JoinedCurve& one : point.curves) members += (members.empty() ? "" : ", ") + member_text(one);
  return fmt::format("{}: {}\n", place_text(point.first, point.second), members);
}

std::string curve_json(const ExploredCurve& curve) {
  const auto label_json = [](const CurveLabel& label) {
    return fmt::format(R"({{"label": {}, "type": {}, "first": {}, "second": {}, "detail": {}, "leads_to": {}}})",
                       label.label, json_value(label.type), json_value(label.first), json_value(label.second),
                       json_value(label.detail), json_list(label.leads_to));
  };
  const auto end_json = [](const CurveEnd& end) {
    return fmt::format(R"({{"first": {}, "second": {}, "reason": {}}})", json_value(end.first), json_value(end.second),
                       json_value(end.reason));
  };
  return fmt::format(
      R"({{"name": {}, "kind": {}, "parent": {}, "origin": {}, "first": [{}, {}], "second": [{}, {}], "points": {}, )"
      R"("inadmissible": {}, "signatures": {}, "ends": {}, "may_be_missing": {}, "labels": {}, "commands": {}}})",
      json_value(curve.name), json_value(curve.kind), json_value(curve.parent), json_value(curve.origin),
      json_value(curve.first_from), json_value(curve.first_to), json_value(curve.second_from),
      json_value(curve.second_to), curve.points, curve.inadmissible, json_list(curve.signatures),
      json_list(curve.ends, end_json), losses_json(curve.lost), json_list(curve.labels, label_json),
      lines_json(curve.job));
}

std::string joint_json(const JoinedPoint& point) {
  const auto member_json = [](const JoinedCurve& member) {
    return fmt::format(R"({{"curve": {}, "label": {}, "type": {}, "is_end": {}}})", json_value(member.curve),
                       member.label, json_value(member.type), member.is_end);
  };
  return fmt::format(R"({{"first": {}, "second": {}, "curves": {}}})", json_value(point.first),
                     json_value(point.second), json_list(point.curves, member_json));
}

}  // namespace

std::string origin_text(const ExploredCurve& curve) {
  return fmt::format("{} curve {} {}", curve.kind, curve.is_born ? "born at" : "from", curve.origin);
}

std::string range_text(const ExploredCurves& all, const ExploredCurve& curve) {
  return fmt::format("{} {:.6g} to {:.6g}, {} {:.6g} to {:.6g}", all.first, curve.first_from, curve.first_to,
                     all.second, curve.second_from, curve.second_to);
}

std::string curves_text(const ExploredCurves& all) {
  if (all.second.empty()) return "";
  std::string text = fmt::format("\nCurves in ({}, {}):\n", all.first, all.second);
  for (const ExploredCurve& curve : all.curves) text += curve_text(all, curve);
  if (all.curves.empty()) text += "  none\n";
  if (!all.slices.empty()) text += fmt::format("\nBranches over {} from grazing curves:\n", all.first);
  for (const ExploredBranch& slice : all.slices) text += slice_text(all, slice);
  if (!all.joints.empty()) text += "\nCodimension two, on several curves:\n";
  for (const JoinedPoint& point : all.joints) text += joint_text(point);
  text += fmt::format("\n{} curves.\n", all.curves.size());
  for (const auto& [reason, labels] : all.without)
    text += fmt::format("Without a curve: {}: {}.\n", fmt::join(labels, ", "), reason);
  for (const std::string& note : all.failures) text += note + "\n";
  if (all.left > 0) text += fmt::format("Left: at least {} more, --branches {} reached.\n", all.left, all.budget);
  return text;
}

std::string curves_json(const ExploredCurves& all) {
  if (all.second.empty()) return "";
  std::string without;
  for (const auto& [reason, labels] : all.without)
    without += fmt::format(R"({}{{"labels": {}, "reason": {}}})", without.empty() ? "" : ", ", json_list(labels),
                           json_value(reason));
  return fmt::format(
      ",\n\"second_parameter\": {}, \"curves_left\": {},\n\"curves\": {},\n\"slices\": {},\n\"codimension_two\": "
      "{},\n\"curve_joins\": {},\n\"without_curve\": [{}],\n\"curve_failures\": {}",
      json_value(all.second), all.left, json_list(all.curves, curve_json), json_list(all.slices, branch_json),
      json_list(all.joints, joint_json), json_list(all.again), without, json_list(all.failures));
}

std::vector<const CommandJob*> curve_jobs(const ExploredCurves& curves) {
  std::vector<const CommandJob*> jobs;
  for (const ExploredCurve& curve : curves.curves) jobs.push_back(&curve.job);
  for (const ExploredBranch& slice : curves.slices) jobs.push_back(&slice.job);
  return jobs;
}

}  // namespace tchat
