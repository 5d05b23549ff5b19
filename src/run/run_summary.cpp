#include "run/run_summary.hpp"
#include "settings/family.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/folded.hpp"

namespace tchat {

namespace {

/// A larger relative error is one of the mesh.
constexpr double inaccurate = 1e-3;

/// `told`: the line of the label MX says it all.
std::string reason_text(const BranchSummary& summary, bool told) {
  switch (summary.reason) {
    case EndReason::max_points:
      return fmt::format("{} points computed", summary.detail);
    case EndReason::beyond_bound:
    case EndReason::on_bound:
    case EndReason::equilibrium:
    case EndReason::curve_end:
    case EndReason::closed:
    case EndReason::unresolved:
    case EndReason::no_orbit:
      return summary.detail;
    case EndReason::special_point:
      if (!summary.stopped_at_grazing) return "at the last special point above";
      return fmt::format("at the {} above; with GRSTOP=0 the branch continues beyond it",
                         summary.family->summary.contact);
    case EndReason::interrupted:
      return "interrupted; all files are complete up to the last point";
    case EndReason::no_convergence:
      return told ? "no convergence (MX), see above" : fmt::format("no convergence (MX): {}", summary.detail);
    default:
      return told ? "the first step failed (MX), see above"
                  : fmt::format("the first step failed (MX): {}", summary.detail);
  }
}

/// What was tried at an abnormal end, and what a user might change.
std::string advice(const BranchSummary& summary) {
  if (summary.reason != EndReason::no_convergence && summary.reason != EndReason::first_step_failed) return "";
  if (summary.undefined_function)
    return "  tried: halving the step down to DSMIN; beyond the last point that function has no value.\n"
           "  you might: end the branch before it (RL0, RL1); let the plugin give a value there (a root or logarithm "
           "of\n"
           "  what becomes negative, a division by what becomes 0); look at the last orbit (tchat orbit) for a border\n"
           "  of the model, which an event function should guard.\n";
  return summary.family->summary.advice;
}

std::string inadmissible(const BranchSummary& summary) {
  if (summary.inadmissible_points == 0) return "";
  return fmt::format("  {} of {} points violate the model (inadmissible): see the d-file for what is violated\n",
                     summary.inadmissible_points, summary.points);
}

/// The largest estimated errors of the branch: between mesh points, where there is a mesh, and of the multiplier whose
/// exact value is known.
std::string accuracy(const BranchSummary& summary) {
  if (!summary.family->headings.has_mesh) return "";
  std::string text =
      fmt::format("  accuracy: relative error between mesh points <= {:.1e}", summary.worst_estimated_error);
  if (summary.multipliers_computed)
    text +=
        fmt::format("; {}: {:.1e}",
                    summary.has_trivial ? "error of the multiplier that should be 1" : "multiplier that should be 0",
                    summary.worst_structural);
  if (summary.worst_unfolding) text += fmt::format("; lambda, which should be 0: {:.1e}", *summary.worst_unfolding);
  text += "\n";
  const SummaryWords& words = summary.family->summary;
  const std::string structural = summary.worst_structural > inaccurate ? words.structural_advice : "";
  const std::string mesh = summary.worst_estimated_error > inaccurate ? mesh_advice : "";
  return text + structural + (mesh == structural ? "" : mesh);
}

/// Special points that may be missing, and what a user might change.
std::string lost_points(const BranchSummary& summary, const std::string& parameter) {
  if (summary.lost.empty()) return "";
  std::string text =
      fmt::format("  {} special point{} may be missing:\n", summary.lost.size(), summary.lost.size() == 1 ? "" : "s");
  for (const LostPoint& lost : summary.lost)
    text += folded(fmt::format("    between {} = {:.8g} and {:.8g} (point {}): {}", parameter, lost.from, lost.to,
                               lost.number, lost.text));
  return text + summary.family->summary.lost_advice;
}

/// Functions that vanish identically, those of one reason in one sentence.
std::string vanishing_functions(const std::vector<VanishingFunction>& functions) {
  std::string text;
  for (auto one = functions.begin(); one != functions.end(); ++one) {
    const auto has_reason = [one](const VanishingFunction& other) { return other.reason == one->reason; };
    if (std::any_of(functions.begin(), one, has_reason)) continue;
    std::vector<std::string> names;
    for (const VanishingFunction& other : functions)
      if (has_reason(other)) names.push_back(other.name);
    text += folded(fmt::format("  zero at every point within {} uncertainty, so without special points: {}{}{}",
                               names.size() > 1 ? "their" : "its", fmt::join(names, ", "),
                               one->reason.empty() ? "" : "; ", one->reason));
  }
  return text;
}

bool is_special(const BranchWriter::Labelled& label) {
  return label.type != "EP" && label.type != "RG" && !label.type.empty();
}

/// Which labels there are, and how many of them the screen did not show.
std::string labels_text(const std::vector<BranchWriter::Labelled>& labels, const std::string& output) {
  if (labels.empty()) return "";
  if (labels.size() == 1) return fmt::format("; label {} in q.{}", labels.front().label, output);
  std::string text = fmt::format("; labels {} to {} in q.{}", labels.front().label, labels.back().label, output);
  const auto regular = std::count_if(labels.begin(), labels.end(), [](const BranchWriter::Labelled& label) {
    return label.number == static_cast<int>(PointType::regular);
  });
  if (regular > 0) text += fmt::format(", {} of them by NPR and not shown", regular);
  return text;
}

/// A line for each special point, and the next command below the first one of each type.
std::string special_points(const std::vector<BranchWriter::Labelled>& labels, const NextCommand& next) {
  std::string text;
  std::set<std::string> seen;
  for (const BranchWriter::Labelled& label : labels) {
    if (!is_special(label)) continue;
    text += folded(fmt::format("  {} label {} at {}{}{}", label.type, label.label, label.place,
                               label.description.empty() ? "" : ": ", label.description));
    if (!seen.insert(label.type).second) continue;
    if (const std::string command = next(label); !command.empty()) text += "    next: " + command + '\n';
  }
  return text;
}

}  // namespace

std::string summary_text(const BranchSummary& summary, const std::vector<BranchWriter::Labelled>& labels,
                         const std::string& parameter, const std::string& output, const NextCommand& next) {
  std::string text = fmt::format("\n{} points", summary.points);
  if (summary.multipliers_computed && !summary.critical_curve)
    text += fmt::format(", {} stable and {} unstable{}", summary.points - summary.unstable_points,
                        summary.unstable_points, summary.without_contact ? " but for the contact" : "");
  text += labels_text(labels, output) + ".\n" + special_points(labels, next);
  const bool told = std::any_of(labels.begin(), labels.end(), [&summary](const BranchWriter::Labelled& label) {
    return label.type == "MX" && label.description == summary.detail;
  });
  text += folded(fmt::format("  stopped: {}", reason_text(summary, told)));
  if (!summary.remark.empty()) text += folded("  " + summary.remark);
  return text + vanishing_functions(summary.vanishing) + advice(summary) + lost_points(summary, parameter) +
         accuracy(summary) + inadmissible(summary);
}

}  // namespace tchat
