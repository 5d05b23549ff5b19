#include "run/screen_output.hpp"

#include <fmt/format.h>

#include "base/progress_line.hpp"
#include "files/point_table.hpp"
#include "stability/grazing_curve_tests.hpp"

namespace tchat {

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
      screen_ << format_table_line(line, section_.columns);
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
