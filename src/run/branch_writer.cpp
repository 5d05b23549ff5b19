#include "run/branch_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "constants/settings_type.hpp"
#include "continuation/solution_measure.hpp"
#include "files/diagnostics_file.hpp"
#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "files/point_table.hpp"
#include "files/solution_file.hpp"
#include "hybrid/parameter_vector.hpp"
#include "problem_type/family.hpp"
#include "problem_type/point_type.hpp"
#include "setup/problem_setup.hpp"
#include "special_points/grazing_curve_tests.hpp"
#include "start/orbit_start.hpp"

namespace tchat {

namespace {

ProblemNames names_of_run(const HybridSystem& system, const RunSettings& settings) {
  ProblemNames names = ProblemNames::of(system, settings.monitors);
  const FamilyFacts& family = family_of(settings).facts();
  if (family.own_parameter) names.set_parameter(*family.own_parameter, family.own_parameter_name);
  return names;
}

/// "" when all multipliers are known.
std::string undetermined_text(const FloquetMultipliers& multipliers) {
  if (multipliers.undetermined == 0) return "";
  return fmt::format("{} not determined (0/0 where h_x f = 0), left out",
                     multipliers.undetermined == 1 ? "one multiplier is"
                                                   : fmt::format("{} multipliers are", multipliers.undetermined));
}

/// What a label is, and what of it is not known.
std::string told(const BranchPoint& point) {
  const std::string missing = undetermined_text(point.multipliers);
  if (point.special.description.empty() || missing.empty()) return point.special.description + missing;
  return point.special.description + "; " + missing;
}

}  // namespace

BranchWriter::BranchWriter(const HybridSystem& system, const CollocationRule& rule, Setup setup, RunFiles& files,
                           std::ostream* screen, std::ostream* terminal)
    : system_(system),
      rule_(rule),
      setup_(std::move(setup)),
      files_(files),
      screen_(screen),
      progress_(terminal),
      names_(names_of_run(system, setup_.settings)),
      columns_(point_columns(setup_.settings, names_)),
      weights_(state_weights(setup_.settings)) {}

void BranchWriter::begin_section(Section section) {
  setup_.branch = section.branch;
  setup_.settings.step = section.step;
  start_correction_ = std::move(section.correction);
  if (has_points_) files_.add_diagnostics(format_bar());  // the last point of a branch has no next step and no bar
  has_points_ = false;
  header_ = format_point_header({setup_.settings, setup_.active_parameters, names_, setup_.curve_type}, columns_);
  if (screen_ != nullptr) *screen_ << format_table_heading(columns_) << std::flush;
}

/// PAR with the entries that the problem sets for output.
ParameterVector BranchWriter::output_parameters(const Orbit& x) const {
  ParameterVector par = x.par;
  const tchat_problem& table = system_.table();
  for (int s = 0; table.output_parameters != nullptr && s < x.shape.segments; ++s)
    table.output_parameters(table.self, s + 1, x.end(s), par.data());
  for (const int k : setup_.active_parameters) par(k - 1) = x.par(k - 1);  // these belong to the computation
  return par;
}

std::vector<double> BranchWriter::column_values(const BranchPoint& point) const {
  const Orbit& x = point.path.orbit;
  const int n = x.shape.dimension;
  std::vector<double> user(static_cast<std::size_t>(system_.table().user_values));
  if (!user.empty()) system_.table().user_value(system_.table().self, x.start(0), x.par.data(), user.data());
  const ParameterVector par = output_parameters(x);
  std::vector<double> values;
  for (const PointColumn& column : columns_) {
    using Kind = PointColumn::Kind;
    switch (column.kind) {
      case Kind::parameter:
        values.push_back(par(column.index - 1));
        break;
      case Kind::l2_norm:
        values.push_back(l2_norm(x, rule_, weights_));
        break;
      case Kind::maximum:
        values.push_back(maximum_of(x, column.index));
        break;
      case Kind::minimum:
        values.push_back(minimum_of(x, column.index));
        break;
      case Kind::integral:
        values.push_back(solution_measure(x, rule_, weights_, n + column.index));
        break;
      case Kind::component_l2_norm:
        values.push_back(solution_measure(x, rule_, weights_, 2 * n + column.index));
        break;
      case Kind::user_function:
        values.push_back(user[static_cast<std::size_t>(column.index - 1)]);
        break;
      case Kind::period:
        values.push_back(x.period());
        break;
    }
  }
  return values;
}

void BranchWriter::point(const BranchPoint& point) {
  PointLine line;
  line.branch = setup_.branch;
  line.point = point.number;
  line.stable = shown_stable(point);
  line.type = file_type(point.special.type, setup_.curve_type);
  line.kind = point.special.kind;
  line.admissible = point.violations.empty();
  line.values = column_values(point);
  if (point.labelled()) line.label = ++setup_.last_label;

  if (point.labelled()) write_solution(point, line);
  files_.add_points(std::exchange(header_, "") + format_point(line));
  has_points_ = true;
  write_diagnostics(point, line);
  files_.write_if_due();
  if (screen_ != nullptr) show(point, line);
  report_unknown_user_values(line);
  if (point.labelled())
    labels_.push_back({line.label,
                       fmt::format("{}", fmt::join(type_names(line.type, line.kind, point.special.further), " ")),
                       place(line), told(point)});
}

/// User functions are for output only: one that is not finite stops nothing, so it is told, once.
void BranchWriter::report_unknown_user_values(const PointLine& line) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const bool unknown = columns_[k].kind == PointColumn::Kind::user_function && !std::isfinite(line.values[k]);
    if (!unknown || !told_user_functions_.insert(columns_[k].index).second) continue;
    const std::string text = fmt::format("User function {} has no finite value here, the files show {:g}",
                                         columns_[k].name, finite(line.values[k]));
    note(line.point, text);
    if (screen_ == nullptr) continue;
    progress_.clear();
    *screen_ << "       " << text << '\n' << std::flush;
  }
}

/// Of the parameters. What is too small for the full precision of a double is rounding.
std::string BranchWriter::place(const PointLine& line) const {
  std::string text;
  for (std::size_t k = 0; k < columns_.size(); ++k)
    if (const PointColumn& column = columns_[k];
        column.kind == PointColumn::Kind::parameter && (k == 0 || column.index < first_duration))
      text += fmt::format("{}{} = {:.10g}", text.empty() ? "" : ", ", column.name,
                          std::abs(line.values[k]) < std::numeric_limits<double>::min() ? 0.0 : line.values[k]);
  return text;
}

/// At a bifurcation a multiplier is on the unit circle; as in AUTO's files the sign is that of the point before, so
/// that stability changes on the line after it. So it is where a multiplier is not determined. On two-parameter curves
/// stability says nothing.
bool BranchWriter::shown_stable(const BranchPoint& point) {
  if (setup_.curve_type != 0) return false;
  const bool unknown = is_bifurcation(point.special.type) || point.multipliers.undetermined > 0;
  if (!unknown || point.number == 1) last_stable_ = point.multipliers.stable();
  return last_stable_;
}

/// At labels of grazing curves, but for those that NPR asks for: a* and xi_n. What the d-file has beside them (x*, beta
/// and A) is told once: a matrix under every label would hide the table.
void BranchWriter::show_contact(const BranchPoint& point) {
  constexpr std::size_t width = 120;
  const std::string indent(7, ' ');
  std::string line;
  for (const NamedTestValue& test : point.tests) {
    if (!reports_contact(test.name) || !test.value) continue;
    const std::string text = fmt::format("{}{} = {:.8g}", line.empty() ? indent : ", ", test.name, *test.value);
    if (line.size() + text.size() > width) {
      *screen_ << line << ",\n";
      line = indent + text.substr(2);
    } else {
      line += text;
    }
  }
  *screen_ << line << '\n';
  if (!contact_shown_) *screen_ << indent << "(contact x*, beta and return map A at each label: see the d-file)\n";
  contact_shown_ = true;
}

/// Labelled points, the first one, and where orbits become inadmissible (with what is violated) or admissible again.
void BranchWriter::show(const BranchPoint& point, const PointLine& line) {
  const bool change = point.number > 1 && line.admissible != last_admissible_;
  if (point.labelled() || point.number == 1 || change) {
    progress_.clear();
    *screen_ << format_table_line(line, columns_);
  } else if (progress_.is_due()) {
    progress_.show(fmt::format("point {}, {} = {:.8g}, step {:.2g} ", point.number, columns_.front().name,
                               line.values.front(), point.step));
  }
  if (!line.admissible && (change || point.number == 1))
    for (const Violation& violation : point.violations) *screen_ << "       " << describe(violation, system_) << '\n';
  if (point.labelled() && !point.remark.empty()) *screen_ << "       " << point.remark << '\n';
  if (point.labelled() && point.special.type != PointType::regular && !point.details.empty()) show_contact(point);
  last_admissible_ = line.admissible;
  *screen_ << std::flush;
}

/// With the direction in which the run goes: a restart with DS > 0 goes on whatever the sign of DS is here.
void BranchWriter::write_solution(const BranchPoint& point, const PointLine& line) {
  const Orbit& x = point.path.orbit;
  std::vector<int> active = setup_.active_parameters;
  for (int s = segment_count(setup_.settings); s < x.shape.segments; ++s)  // the further orbits of a torus
    active.push_back(first_duration + s);
  std::vector<int> free_parameters;
  for (const int k : active)
    if (!is_duration(k, x.shape.segments)) free_parameters.push_back(k);
  OrbitVector direction = point.path.tangent;
  if (setup_.settings.step < 0.0) direction.scale(-1.0);  // the branch goes against its tangents
  LabelledSolution solution = labelled_solution(x, direction, free_parameters, active);
  solution.branch = line.branch;
  solution.point = line.point;
  solution.type = line.type;
  solution.label = line.label;
  solution.branch_mode = setup_.settings.branch_mode;
  solution.problem_type = setup_.settings.problem_type;
  solution.kind = line.kind;
  solution.further = point.special.further;
  files_.add_solution(format_solution(solution));
}

void BranchWriter::write_diagnostics(const BranchPoint& point, const PointLine& line) {
  const int level = setup_.settings.diagnostics_level;
  if (level <= 0 && !point.labelled()) return;
  const std::vector<NewtonIteration>& newton = point.number > 1 ? point.newton : start_correction_;
  const int iterations = point.number > 1 ? point.newton_iterations : static_cast<int>(newton.size());
  std::string text;
  if (level >= 2 && !newton.empty()) {
    std::vector<NewtonLine> lines;
    for (const NewtonIteration& it : newton)
      lines.push_back({it.number, it.parameter, it.residual, it.parameter_change, it.state_change});
    text += format_newton_history(line.branch, line.point, lines);
  }
  text += format_diagnostics_point(line, columns_);
  if (!point.special.description.empty()) text += format_note(line.branch, line.point, point.special.description);
  if (!point.remark.empty()) text += format_note(line.branch, line.point, point.remark);
  for (const std::string& details : point.details) text += format_note(line.branch, line.point, details);
  for (const Violation& violation : point.violations)
    text += format_note(line.branch, line.point, "Inadmissible: " + describe(violation, system_));
  const FloquetMultipliers& multipliers = point.multipliers;
  if (multipliers.valid)
    text += multipliers.are_eigenvalues ? format_eigenvalues(multipliers.values, multipliers.stable_count())
                                        : format_multipliers(multipliers.values);
  if (const std::string missing = undetermined_text(point.multipliers); !missing.empty())
    text += format_note(line.branch, line.point, missing);
  if (level >= 2) {
    std::vector<TestFunctionLine> tests;
    for (const NamedTestValue& test : point.tests)
      tests.push_back({test.name, test.value.value_or(0.0), test.value.has_value()});
    text += format_test_functions(tests);
    if (family_of(setup_.settings).facts().headings.has_mesh)
      text += fmt::format("{:4}{:6}  Structural multiplier {:.3e}   estimated error between mesh points {:.3e}\n",
                          line.branch, wrapped_point(line.point), point.multipliers.structural, point.estimated_error);
  }
  text += fmt::format("{:4}{:6}  Iterations   : {}\n", line.branch, wrapped_point(line.point), iterations);
  files_.add_diagnostics(text);
}

void BranchWriter::next_step(int point_number, double ds) {
  if (setup_.settings.diagnostics_level <= 0) return;
  files_.add_diagnostics(
      fmt::format("{:4}{:6}  Next Step    : {:.5e}\n", setup_.branch, wrapped_point(point_number), ds) + format_bar());
  files_.write_if_due();
}

void BranchWriter::note(int point_number, const std::string& text) {
  files_.add_diagnostics(format_note(setup_.branch, point_number, text));
}

void BranchWriter::starts_at_zero(const std::string& name) {
  BranchSink::starts_at_zero(name);
  if (screen_ == nullptr) return;
  progress_.clear();
  *screen_ << fmt::format("       the start is itself a zero of {}, and gets no label for it\n", name) << std::flush;
}

void BranchWriter::passed(const LostPoint& point) {
  note(point.number, point.text);
  if (screen_ == nullptr) return;
  progress_.clear();
  *screen_ << fmt::format("       {} = {:.8g} to {:.8g}: {}\n", columns_.front().name, point.from, point.to, point.text)
           << std::flush;
}

void BranchWriter::mesh_changed(int point_number, double parameter, const std::string& text) {
  note(point_number, text);
  if (screen_ == nullptr) return;
  progress_.clear();
  *screen_ << fmt::format("       {} = {:.8g}: {}\n", columns_.front().name, parameter, text) << std::flush;
}

void BranchWriter::lost(const LostPoint& point) {
  note(point.number, point.text);
  if (screen_ == nullptr) return;
  progress_.clear();
  *screen_ << fmt::format("       warning: point {}, {} = {:.8g} to {:.8g}: {}\n", point.number, columns_.front().name,
                          point.from, point.to, point.text)
           << std::flush;
}

}  // namespace tchat
