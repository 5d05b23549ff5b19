#include "run/branch_output.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/point_file.hpp"
#include "files/solution_file.hpp"
#include "run/orbit_start.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/grazing_tests.hpp"

namespace tchat {

std::vector<std::unique_ptr<BranchOutput>> branch_outputs(const BranchSection& section, RunFiles& files,
                                                          std::ostream* screen, std::ostream* terminal) {
  std::vector<std::unique_ptr<BranchOutput>> outputs;
  outputs.push_back(solution_file_output(section, files));
  outputs.push_back(point_file_output(section, files));
  outputs.push_back(diagnostics_file_output(section, files));
  if (screen != nullptr) outputs.push_back(screen_output(section, *screen, terminal));
  return outputs;
}

namespace {

/// Uncertainties of multipliers up to this are not told.
constexpr double shown_uncertainty = level::tolerance;

/// The header of a section is written with its first point, for AUTO's reader refuses a header without points.
class PointFileOutput final : public BranchOutput {
 public:
  PointFileOutput(const BranchSection& section, RunFiles& files) : section_(section), files_(files) {}

  void begin_section() override {
    header_ = format_point_header({section_.settings, section_.active_parameters, section_.names, section_.curve_type},
                                  section_.columns);
  }
  void point(const RecordedPoint& point) override {
    text_.swap(header_);
    header_.clear();
    append_point(text_, point.line);
    files_.add_points(text_);
    text_.clear();
  }

 private:
  const BranchSection& section_;
  RunFiles& files_;
  std::string header_;  // until it is written
  std::string text_;    // of a point; empty between two
};

class SolutionFileOutput final : public BranchOutput {
 public:
  SolutionFileOutput(const BranchSection& section, RunFiles& files) : section_(section), files_(files) {}

  /// With the direction in which the run goes: a restart with DS > 0 continues it whatever the sign of DS is here.
  void point(const RecordedPoint& point) override {
    if (!point.of_branch.labelled()) return;
    const Orbit& x = point.of_branch.path.orbit;
    std::vector<int> active = section_.active_parameters;
    for (int s = segment_count(section_.settings); s < x.shape.segments; ++s)  // the further orbits of a torus
      active.push_back(x.par.layout().duration(s));
    std::vector<int> free_parameters;
    for (const int k : active)
      if (!x.par.layout().is_duration(k, x.shape.segments)) free_parameters.push_back(k);
    OrbitVector direction = point.of_branch.path.tangent;
    if (section_.settings.step < 0.0) direction.scale(-1.0);  // the branch goes against its tangents
    LabelledSolution solution = labelled_solution(x, direction, free_parameters, active);
    solution.branch = point.line.branch;
    solution.point = point.line.point;
    solution.type = point.line.type;
    solution.label = point.line.label;
    solution.branch_mode = section_.settings.branch_mode;
    solution.problem_type = section_.settings.problem_type;
    solution.kind = point.line.kind;
    solution.further = point.of_branch.special.further;
    files_.add_solution(format_solution(solution));
  }

 private:
  const BranchSection& section_;
  RunFiles& files_;
};

/// How much the d-file says of a point depends on IID and on whether the point is labelled or the first of its branch:
///
///     IID         ordinary point                 label, first point
///      0          nothing                        its line, multipliers, what it is (labels alone)
///      1          its line and multipliers       the same
///      2          test values too                Newton's iterations and test functions by name too
///      3          as a label                     the same
class DiagnosticsFileOutput final : public BranchOutput {
 public:
  DiagnosticsFileOutput(const BranchSection& section, RunFiles& files)
      : section_(section), files_(files), short_heading_(format_short_heading(section.columns)) {}

  void begin_section() override {
    if (has_points_) files_.add_diagnostics(format_bar());  // the last point of a section has no next step and no bar
    has_points_ = false;
  }
  void point(const RecordedPoint& point) override {
    const bool is_first = !std::exchange(has_points_, true);
    last_point_ = point.of_branch.number;
    const bool is_full = point.of_branch.labelled() || (is_first && level() > 0) || level() > 2;
    if (is_full)
      files_.add_diagnostics(newton_history(point) + format_diagnostics_point(point.line, section_.columns) +
                             notes(point) + multipliers(point) + details(point));
    else if (level() > 0)
      add_short(point);
  }
  void next_step(int point_number, double ds) override {
    if (level() <= 0) return;
    text_.clear();
    append_next_step(text_, section_.branch, point_number, ds);
    files_.add_diagnostics(text_);
  }
  void lost(const LostPoint& point) override {
    files_.add_diagnostics(format_lost_point(section_.branch, point.number, point.from, point.to, point.text));
  }

  void note(int point_number, const std::string& text) override {
    files_.add_diagnostics(format_note(section_.branch, point_number, text));
  }
  void branch_end(std::string_view reason, const std::string& text) override {
    files_.add_diagnostics(format_branch_end(section_.branch, last_point_, reason, text));
  }

 private:
  int level() const { return section_.settings.diagnostics_level; }
  const std::vector<NewtonIteration>& iterations(const BranchPoint& point) const {
    return point.number > 1 ? point.newton : section_.start_correction;
  }

  void add_short(const RecordedPoint& recorded) {
    const BranchPoint& point = recorded.of_branch;
    text_.clear();
    append_short_point(text_, recorded.line, short_heading_);
    text_ += notes(recorded);
    if (point.multipliers.valid)
      append_short_multipliers(text_, point.multipliers.values, point.multipliers.are_eigenvalues);
    if (!recorded.unknown_multipliers.empty())
      text_ += format_note(recorded.line.branch, recorded.line.point, recorded.unknown_multipliers);
    test_values_.clear();
    for (const NamedTestValue& test : point.tests) test_values_.push_back(test.value.value_or(NAN));
    if (level() > 1) append_short_tests(text_, test_values_);
    append_iterations(text_, recorded.line.branch, recorded.line.point, iterations_of(point));
    files_.add_diagnostics(text_);
  }

  int iterations_of(const BranchPoint& point) const {
    return point.number > 1 ? point.newton_iterations : static_cast<int>(iterations(point).size());
  }

  std::string newton_history(const RecordedPoint& point) const {
    if (level() < 2 || iterations(point.of_branch).empty()) return "";
    std::vector<NewtonLine> lines;
    for (const NewtonIteration& it : iterations(point.of_branch))
      lines.push_back({it.number, it.parameter, it.residual, it.parameter_change, it.state_change});
    return format_newton_history(point.line.branch, point.line.point, lines);
  }

  std::string notes(const RecordedPoint& recorded) const {
    const BranchPoint& point = recorded.of_branch;
    std::vector<std::string> texts;
    if (!point.special.description.empty()) texts.push_back(point.special.description);
    if (!point.remark.empty()) texts.push_back(point.remark);
    texts.insert(texts.end(), point.details.begin(), point.details.end());
    for (const Violation& violation : point.violations)
      texts.push_back("Inadmissible: " + describe(violation, section_.system));
    std::string text;
    for (const std::string& note : texts) text += format_note(recorded.line.branch, recorded.line.point, note);
    return text;
  }

  static std::string multipliers(const RecordedPoint& point) {
    const FloquetMultipliers& known = point.of_branch.multipliers;
    std::string text;
    if (known.valid)
      text = known.are_eigenvalues ? format_eigenvalues(known.values, known.stable_count())
                                   : format_multipliers(known.values);
    if (known.valid && known.uncertainty > shown_uncertainty)
      text += format_note(point.line.branch, point.line.point,
                          fmt::format("multipliers are known to {:.1e} only", known.uncertainty));
    if (!point.unknown_multipliers.empty())
      text += format_note(point.line.branch, point.line.point, point.unknown_multipliers);
    return text;
  }

  std::string details(const RecordedPoint& recorded) const {
    const BranchPoint& point = recorded.of_branch;
    std::string text;
    if (level() >= 2) {
      std::vector<TestFunctionLine> tests;
      for (const NamedTestValue& test : point.tests)
        tests.push_back({test.name, test.value.value_or(0.0), test.value.has_value()});
      text = format_test_functions(tests);
      if (family_of(section_.settings).facts().headings.has_mesh)
        text += fmt::format("{:4}{:6}  Structural multiplier {:.3e}   estimated error between mesh points {:.3e}\n",
                            recorded.line.branch, wrapped_point(recorded.line.point), point.multipliers.structural,
                            point.estimated_error);
    }
    append_iterations(text, recorded.line.branch, recorded.line.point, iterations_of(point));
    return text;
  }

  const BranchSection& section_;
  RunFiles& files_;
  std::string short_heading_;
  bool has_points_ = false;  // the section
  int last_point_ = 0;
  std::string text_;  // of an ordinary point
  std::vector<double> test_values_;
};

}  // namespace

std::unique_ptr<BranchOutput> point_file_output(const BranchSection& section, RunFiles& files) {
  return std::make_unique<PointFileOutput>(section, files);
}

std::unique_ptr<BranchOutput> solution_file_output(const BranchSection& section, RunFiles& files) {
  return std::make_unique<SolutionFileOutput>(section, files);
}

std::unique_ptr<BranchOutput> diagnostics_file_output(const BranchSection& section, RunFiles& files) {
  return std::make_unique<DiagnosticsFileOutput>(section, files);
}

namespace {

constexpr const char* indent = "       ";

/// The first point, labels but for those that NPR asks for, and where orbits become inadmissible (with what is
/// violated) or admissible again.
class ScreenOutput final : public BranchOutput {
 public:
  ScreenOutput(const BranchSection& section, std::ostream& screen, std::ostream* terminal)
      : section_(section), screen_(screen), progress_(terminal) {}

  void begin_section() override { screen_ << format_table_heading(section_.columns) << std::flush; }

  void point(const RecordedPoint& recorded) override {
    const BranchPoint& point = recorded.of_branch;
    const PointLine& line = recorded.line;
    const bool change = point.number > 1 && line.admissible != last_admissible_;
    const bool is_shown = point.labelled() && point.special.type != PointType::regular;
    if (is_shown || point.number == 1 || change) {
      progress_.clear();
      screen_ << format_table_line(recorded.shown, section_.columns);
    } else if (progress_.is_due()) {
      progress_.show(fmt::format("point {}, {} = {:.8g}, step {:.2g} ", point.number,
                                 shown_name(section_.columns.front()), line.values.front(), point.step));
    }
    if (!line.admissible && (change || point.number == 1))
      for (const Violation& violation : point.violations)
        screen_ << indent << describe(violation, section_.system) << '\n';
    if (is_shown && !point.remark.empty()) screen_ << indent << point.remark << '\n';
    if (is_shown && !point.details.empty()) show_contact(point);
    last_admissible_ = line.admissible;
    screen_ << std::flush;
  }

  void message(const std::string& text) override {
    progress_.clear();
    screen_ << indent << text << '\n' << std::flush;
  }
  void end_section() override { progress_.clear(); }

 private:
  /// At labels of grazing curves, except those that NPR asks for: a* and xi_n. What the d-file has beside them (x*,
  /// beta and A) is mentioned once: a matrix under every label would hide the table.
  void show_contact(const BranchPoint& point) {
    constexpr std::size_t width = 120;
    std::string line;
    for (const NamedTestValue& test : point.tests) {
      if (!reports_contact(test.name) || !test.value) continue;
      const std::string text = fmt::format("{}{} = {:.8g}", line.empty() ? indent : ", ", test.name, *test.value);
      if (line.size() + text.size() > width) {
        screen_ << line << ",\n";
        line = indent + text.substr(2);
      } else {
        line += text;
      }
    }
    screen_ << line << '\n';
    if (!contact_shown_) screen_ << indent << "(contact x*, beta and return map A at each label: see the d-file)\n";
    contact_shown_ = true;
  }

  const BranchSection& section_;
  std::ostream& screen_;
  ProgressLine progress_;
  bool last_admissible_ = true;
  bool contact_shown_ = false;
};

}  // namespace

std::unique_ptr<BranchOutput> screen_output(const BranchSection& section, std::ostream& screen,
                                            std::ostream* terminal) {
  return std::make_unique<ScreenOutput>(section, screen, terminal);
}

}  // namespace tchat
