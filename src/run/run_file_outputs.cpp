#include "run/run_file_outputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/labelled_solution.hpp"
#include "files/number_format.hpp"
#include "files/solution_file.hpp"
#include "run/orbit_start.hpp"
#include "settings/family.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

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
  void note(int point_number, const std::string& text) override {
    files_.add_diagnostics(format_note(section_.branch, point_number, text));
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
  std::string text_;         // of an ordinary point
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

}  // namespace tchat
