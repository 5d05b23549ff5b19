#include "run/branch_writer.hpp"
#include "run/solver_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <utility>

#include "continuation/solution_measure.hpp"
#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "model/parameter_vector.hpp"
#include "settings/family.hpp"
#include "settings/point_type.hpp"
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
  return fmt::format("{} not determined (0/0 where h_x f = 0), left out",
                     multipliers.undetermined == 1 ? "one multiplier is"
                                                   : fmt::format("{} multipliers are", multipliers.undetermined));
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
      last_label_(setup.last_label) {}

void BranchWriter::begin_section(int branch, double step, std::vector<NewtonIteration> correction) {
  section_.branch = branch;
  section_.settings.step = step;
  section_.start_correction = std::move(correction);
  for (const auto& output : outputs_) output->begin_section();
}

void BranchWriter::end_section() {
  for (const auto& output : outputs_) output->end_section();
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
  line_.branch = section_.branch;
  line_.point = point.number;
  line_.stable = shown_stable(point);
  line_.type = file_type(point.special.type, section_.curve_type);
  line_.kind = point.special.kind;
  line_.admissible = point.violations.empty();
  line_.label = point.labelled() ? ++last_label_ : 0;
  find_column_values(point);
  const RecordedPoint recorded{point, line_, undetermined_text(point.multipliers)};
  for (const auto& output : outputs_) output->point(recorded);
  report_unknown_user_values(line_);
  files_.write_if_due();
  if (point.labelled())
    labels_.push_back({line_.label,
                       fmt::format("{}", fmt::join(type_names(line_.type, line_.kind, point.special.further), " ")),
                       place(line_), description_of(recorded), label_type(line_.type), line_.kind});
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

/// Of the parameters. What is too small for the full precision of a double is rounding.
std::string BranchWriter::place(const PointLine& line) const {
  std::string text;
  for (std::size_t k = 0; k < section_.columns.size(); ++k)
    if (const PointColumn& column = section_.columns[k];
        column.kind == PointColumn::Kind::parameter && (k == 0 || is_parameter(section_.settings, column.index)))
      text += fmt::format("{}{} = {:.10g}", text.empty() ? "" : ", ", shown_name(column),
                          std::abs(line.values[k]) < std::numeric_limits<double>::min() ? 0.0 : line.values[k]);
  return text;
}

/// At a bifurcation a multiplier is on the unit circle; as in AUTO's files the sign is that of the point before, so
/// that stability changes on the line after it. So it is where a multiplier is not determined. On two-parameter curves
/// stability says nothing.
bool BranchWriter::shown_stable(const BranchPoint& point) {
  if (section_.curve_type != 0) return false;
  const bool unknown = is_bifurcation(point.special.type) || point.multipliers.undetermined > 0;
  if (!unknown || point.number == 1) last_stable_ = point.multipliers.stable();
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
  note(point.number, point.text);
  show_message(fmt::format("warning: point {}, {} = {:.8g} to {:.8g}: {}", point.number, principal_name(), point.from,
                           point.to, point.text));
}

}  // namespace tchat
