#include "run/branch_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "continuation/solution_measure.hpp"
#include "files/auto_format.hpp"
#include "files/solution_file.hpp"
#include "model/parameter_vector.hpp"
#include "run/own_units.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

ProblemNames names_of_run(const HybridSystem& system, const RunSettings& settings) {
  ProblemNames names = ProblemNames::of(system, settings);
  const FamilyFacts& family = family_of(settings).facts();
  if (family.has_rotation) names.set_parameter(settings.layout.rotation(), rotation_name);
  return names;
}

BranchSection first_section(const HybridSystem& system, const BranchWriter::Setup& setup) {
  const ProblemNames names = names_of_run(system, setup.settings);
  const std::vector<PointColumn> columns = point_columns(setup.settings, names);
  return {system, setup.settings, setup.active_parameters, setup.curve_type, 1, names, columns};
}

/// "" when all multipliers are known.
std::string undetermined_text(const FloquetMultipliers& multipliers) {
  if (multipliers.undetermined == 0) return "";
  return fmt::format(
      "{} not determined ({}), left out",
      multipliers.undetermined == 1 ? "one multiplier is" : fmt::format("{} multipliers are", multipliers.undetermined),
      multipliers.is_flow_lost     ? "errors grow too much along the orbit"
      : multipliers.is_mesh_coarse ? "the mesh is too coarse"
      : multipliers.is_at_border   ? "impacts cease to accumulate here, and their limit has no derivative"
                                   : "0/0 where h_x f = 0");
}

/// What a label is, and what of it is not known.
std::string description_of(const RecordedPoint& point) {
  const std::string& description = point.of_branch.special.description;
  const bool has_both = !description.empty() && !point.unknown_multipliers.empty();
  return description + (has_both ? "; " : "") + point.unknown_multipliers;
}

}  // namespace

BranchWriter::BranchWriter(const HybridSystem& system, const CollocationRule& rule, const Setup& setup, RunFiles& files,
                           std::ostream* screen, std::ostream* terminal)
    : rule_(rule),
      files_(files),
      section_(first_section(system, setup)),
      outputs_(branch_outputs(section_, files, screen, terminal)),
      weights_(state_weights(section_.settings)),
      last_label_(setup.last_label),
      units_(setup.units),
      parameter_sizes_(setup.parameter_sizes) {}

void BranchWriter::begin_section(int branch, double step, std::vector<NewtonIteration> correction) {
  section_.branch = branch;
  section_.settings.step = step;
  section_.start_correction = std::move(correction);
  for (const auto& output : outputs_) output->begin_section();
}

/// PAR with the entries that the problem, which has some, sets for output.
ParameterVector BranchWriter::output_parameters(const Orbit& x) const {
  ParameterVector par = x.par;
  const tchat_problem& table = section_.system.table();
  for (int s = 0; s < x.shape.segments; ++s) table.output_parameters(table.self, s + 1, x.end(s), par.data());
  for (const int k : section_.active_parameters) par(k - 1) = x.par(k - 1);  // these belong to the computation
  return par;
}

/// Those of `line_`.
void BranchWriter::find_column_values(const BranchPoint& point) {
  const Orbit& x = point.path.orbit;
  const tchat_problem& table = section_.system.table();
  user_values_.resize(static_cast<std::size_t>(table.user_values));
  if (!user_values_.empty()) table.user_value(table.self, x.start(0), x.par.data(), user_values_.data());
  line_.values.clear();
  for (const PointColumn& column : section_.columns) line_.values.push_back(column_value(column, point));
  if (table.output_parameters == nullptr) return;
  const ParameterVector par = output_parameters(x);
  for (std::size_t k = 0; k < section_.columns.size(); ++k)
    if (section_.columns[k].kind == PointColumn::Kind::parameter) line_.values[k] = par(section_.columns[k].index - 1);
}

double BranchWriter::column_value(const PointColumn& column, const BranchPoint& point) const {
  const Orbit& x = point.path.orbit;
  const int n = x.shape.dimension;
  using Kind = PointColumn::Kind;
  switch (column.kind) {
    case Kind::parameter:
      return x.par(column.index - 1);
    case Kind::l2_norm:
      return l2_norm(x, rule_, weights_);
    case Kind::maximum:
      return maximum_of(x, column.index);
    case Kind::minimum:
      return minimum_of(x, column.index);
    case Kind::integral:
      return solution_measure(x, rule_, weights_, n + column.index);
    case Kind::component_l2_norm:
      return solution_measure(x, rule_, weights_, 2 * n + column.index);
    case Kind::user_function:
      return user_values_[static_cast<std::size_t>(column.index - 1)];
    case Kind::period:
      return x.period();
  }
  return NAN;
}

void BranchWriter::point(const BranchPoint& point) {
  if (units_.size() == 0) return write(point);
  const PathPoint path = in_users_units(point.path, units_);
  write({point.number, point.special, path, point.multipliers, point.violations, point.estimated_error,
         point.newton_iterations, point.newton, point.step, point.tests, point.details, point.remark});
}

void BranchWriter::write(const BranchPoint& point) {
  line_.branch = section_.branch;
  line_.point = point.number;
  line_.stable = shown_stable(point);
  line_.type = file_type(point.special.type, section_.curve_type);
  line_.kind = point.special.kind;
  line_.admissible = point.violations.empty();
  line_.label = point.labelled() ? ++last_label_ : 0;
  find_column_values(point);
  largest_values_.resize(line_.values.size(), 0.0);
  for (std::size_t k = 0; k < largest_values_.size(); ++k)
    largest_values_[k] = std::max(largest_values_[k], std::abs(line_.values[k]));
  shown_ = line_;
  for (std::size_t k = 0; k < shown_.values.size(); ++k) shown_.values[k] = shown_value(line_, k);
  const RecordedPoint recorded{point, line_, shown_, undetermined_text(point.multipliers)};
  for (const auto& output : outputs_) output->point(recorded);
  report_unknown_user_values(line_);
  files_.write_if_due();
  if (point.labelled())
    labels_.push_back({line_.label,
                       fmt::format("{}", fmt::join(type_names(line_.type, line_.kind, point.special.further), " ")),
                       place(shown_), description_of(recorded), label_type(line_.type), line_.kind});
}

/// User functions are for output only: one that is not finite stops nothing, so it is reported, once.
void BranchWriter::report_unknown_user_values(const PointLine& line) {
  for (std::size_t k = 0; k < section_.columns.size(); ++k) {
    const PointColumn& column = section_.columns[k];
    const bool unknown = column.kind == PointColumn::Kind::user_function && !std::isfinite(line.values[k]);
    if (!unknown || !reported_user_functions_.insert(column.index).second) continue;
    const std::string text = fmt::format("User function {} has no finite value here, the files show {:g}", column.name,
                                         finite(line.values[k]));
    note(line.point, text);
    show_message(text);
  }
}

/// A parameter that is rounding of zero is shown as zero: what is too small for the full precision of a double, and
/// what is far below the size of the parameter or of a value that has been larger on the branch.
double BranchWriter::shown_value(const PointLine& line, std::size_t column) const {
  const PointColumn& of = section_.columns[column];
  if (of.kind != PointColumn::Kind::parameter) return line.values[column];
  const double size = of.index <= parameter_sizes_.size() ? parameter_sizes_(of.index - 1) : 0.0;
  const double least =
      std::max(std::numeric_limits<double>::min(), level::negligible * std::max(largest_values_[column], size));
  return std::abs(line.values[column]) < least ? 0.0 : line.values[column];
}

std::string BranchWriter::place(const PointLine& line) const {
  std::string text;
  for (std::size_t k = 0; k < section_.columns.size(); ++k) {
    const PointColumn& column = section_.columns[k];
    if (column.kind != PointColumn::Kind::parameter || (k > 0 && !is_parameter(section_.settings, column.index)))
      continue;
    text += fmt::format("{}{} = {:.10g}", text.empty() ? "" : ", ", shown_name(column), line.values[k]);
  }
  return text;
}

/// At a bifurcation a multiplier is on the unit circle; as in AUTO's files the sign is that of the point before, so
/// that stability changes on the line after it. So it is where a multiplier is not determined. On two-parameter curves
/// stability says nothing.
bool BranchWriter::shown_stable(const BranchPoint& point) {
  if (section_.curve_type != 0) return false;
  const bool unknown = is_bifurcation(point.special.type) || point.multipliers.stability() == Stability::unknown;
  if (!unknown || point.number == 1) last_stable_ = point.multipliers.stable() && !point.multipliers.is_flow_lost;
  return last_stable_;
}

void BranchWriter::next_step(int point_number, double ds) {
  for (const auto& output : outputs_) output->next_step(point_number, ds);
  files_.write_if_due();
}

void BranchWriter::note(int point_number, const std::string& text) {
  for (const auto& output : outputs_) output->note(point_number, text);
}

void BranchWriter::show_message(const std::string& text) {
  for (const auto& output : outputs_) output->message(text);
}

void BranchWriter::starts_at_zero(const std::string& name) {
  BranchSink::starts_at_zero(name);
  show_message(fmt::format("the start is itself a zero of {}, and gets no label for it", name));
}

void BranchWriter::passed(const LostPoint& point) {
  note(point.number, point.text);
  show_message(fmt::format("{} = {:.8g} to {:.8g}: {}", principal_name(), point.from, point.to, point.text));
}

void BranchWriter::mesh_changed(int point_number, double parameter, const std::string& text) {
  note(point_number, text);
  show_message(fmt::format("{} = {:.8g}: {}", principal_name(), parameter, text));
}

void BranchWriter::lost(const LostPoint& point) {
  for (const auto& output : outputs_) output->lost(point);
  show_message(fmt::format("warning: point {}, {} = {:.8g} to {:.8g}: {}", point.number, principal_name(), point.from,
                           point.to, point.text));
}

namespace {

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
      if (summary.stopped_at_border)
        return "where chatter becomes incomplete, above; beyond it its impacts have no limit";
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

}  // namespace

std::string_view end_word(EndReason reason) {
  switch (reason) {
    case EndReason::outgrown:
    case EndReason::unresolved:
      return "unresolved";
    case EndReason::no_orbit:
      return "no_orbit";
    case EndReason::max_points:
      return "points";
    case EndReason::beyond_bound:
    case EndReason::on_bound:
      return "bound";
    case EndReason::special_point:
      return "special_point";
    case EndReason::curve_end:
      return "curve_end";
    case EndReason::equilibrium:
      return "equilibrium";
    case EndReason::closed:
      return "closed";
    case EndReason::interrupted:
      return "interrupted";
    case EndReason::no_convergence:
      return "no_convergence";
    case EndReason::first_step_failed:
      return "first_step";
  }
  return "";
}

void BranchWriter::end_section(const BranchSummary& summary) {
  const std::string remark = summary.remark.empty() ? "" : "; " + summary.remark;
  for (const auto& output : outputs_) {
    output->branch_end(end_word(summary.reason), reason_text(summary, false) + remark);
    output->end_section();
  }
}

namespace {

/// What was tried at an abnormal end, and what a user might change.
std::string advice(const BranchSummary& summary) {
  if (summary.reason != EndReason::no_convergence && summary.reason != EndReason::first_step_failed) return "";
  if (!summary.remark.empty()) return "";  // it says why
  if (summary.undefined_function)
    return "  tried: halving the step down to DSMIN; beyond the last point that function has no value.\n"
           "  you might: end the branch before it (RL0, RL1); let the model give a value there (a root or logarithm "
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
  if (summary.multipliers_computed && summary.has_structural)
    text +=
        fmt::format("; {}: {:.1e}",
                    summary.has_trivial ? "error of the multiplier that should be 1" : "multiplier that should be 0",
                    summary.worst_structural);
  if (summary.worst_unfolding) text += fmt::format("; lambda, which should be 0: {:.1e}", *summary.worst_unfolding);
  text += "\n";
  if (!summary.remark.empty()) return text;  // no mesh resolves a period without bound
  const SummaryWords& words = summary.family->summary;
  const std::string structural = summary.worst_structural > coarse_mesh ? words.structural_advice : "";
  const std::string mesh = summary.worst_estimated_error > coarse_mesh ? mesh_advice : "";
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

std::string stability_counts(const BranchSummary& summary) {
  const int stable = summary.points - summary.unstable_points - summary.undetermined_points - summary.neutral_points;
  const char* qualified = summary.without_contact ? " but for the contact" : "";
  std::vector<std::string> parts{fmt::format("{} stable", stable),
                                 fmt::format("{} unstable{}", summary.unstable_points, qualified)};
  if (summary.neutral_points > 0)
    parts.push_back(fmt::format("{} neutral (a multiplier of modulus 1)", summary.neutral_points));
  if (summary.undetermined_points > 0)
    parts.push_back(fmt::format("{} of unknown stability", summary.undetermined_points));
  const std::string last = parts.back();
  parts.pop_back();
  return fmt::format(", {} and {}", fmt::join(parts, ", "), last);
}

}  // namespace

std::string summary_text(const BranchSummary& summary, const std::vector<BranchWriter::Labelled>& labels,
                         const std::string& parameter, const std::string& output, const NextCommand& next) {
  std::string text = fmt::format("\n{} point{}", summary.points, summary.points == 1 ? "" : "s");
  if (summary.multipliers_computed && !summary.critical_curve) text += stability_counts(summary);
  text += labels_text(labels, output) + ".\n" + special_points(labels, next);
  const bool told = std::any_of(labels.begin(), labels.end(), [&summary](const BranchWriter::Labelled& label) {
    return label.type == "MX" && label.description == summary.detail;
  });
  text += folded(fmt::format("  stopped: {}", reason_text(summary, told)));
  for (const std::string& more : {summary.remark, summary.no_progress})
    if (!more.empty()) text += folded("  " + more);
  return text + vanishing_functions(summary.vanishing) + advice(summary) + lost_points(summary, parameter) +
         accuracy(summary) + inadmissible(summary);
}

}  // namespace tchat
