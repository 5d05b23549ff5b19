#include "explore/explored_curves.hpp"

#include <fmt/format.h>

#include "explore/json_list.hpp"

namespace tchat {

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
  std::string text = fmt::format("{}  {} curve from {}: {}; {}\n", curve.name, curve.kind, curve.origin,
                                 range_text(all, curve), fmt::join(curve.signatures, ", "));
  if (curve.inadmissible > 0)
    text += fmt::format("    {} of {} points are inadmissible\n", curve.inadmissible, curve.points);
  for (const CurveEnd& end : curve.ends) text += "    " + end_text(end) + "\n";
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
      R"("inadmissible": {}, "signatures": {}, "ends": {}, "labels": {}, "commands": {}}})",
      json_value(curve.name), json_value(curve.kind), json_value(curve.parent), json_value(curve.origin),
      json_value(curve.first_from), json_value(curve.first_to), json_value(curve.second_from),
      json_value(curve.second_to), curve.points, curve.inadmissible, json_list(curve.signatures),
      json_list(curve.ends, end_json), json_list(curve.labels, label_json), json_list(curve.job.lines));
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
