#include "plot/page_branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "files/recorded_labels.hpp"
#include "files/run_file_names.hpp"
#include "files/solution_file_reader.hpp"
#include "plot/label_text.hpp"
#include "plot/page_json.hpp"
#include "plot/page_orbits.hpp"
#include "plot/restart_command.hpp"
#include "settings/family.hpp"
#include "settings/normal_form_note.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

std::string integer(long long value) { return fmt::format("{}", value); }

/// One character for each point: s stable, u unstable, - if stability is unknown.
std::string stability(const PointSection& section) {
  const bool is_known = section.has_stability() && section.curve_type == 0 &&
                        !has_critical_multiplier(section.problem_type, section.branch_mode);
  std::string letters;
  for (const PointRow& row : section.rows) letters += !is_known ? '-' : row.point < 0 ? 's' : 'u';
  return letters;
}

/// What numbers the d-file has of a point: a boundary value problem has none.
const char* spectrum_of(const PointSection& section) {
  const FamilyFacts& facts = family_of(section.problem_type).facts();
  return facts.has_return_map ? "multipliers" : facts.headings.has_period ? "" : "eigenvalues";
}

std::string multipliers_of(const DiagnosticPoint* point) {
  if (point == nullptr || point->multipliers.empty()) return "0";
  std::vector<std::string> parts;
  for (const auto& mu : point->multipliers) {
    parts.push_back(page_number(mu.real()));
    parts.push_back(page_number(mu.imag()));
  }
  return page_list(parts);
}

class PageBranchWriter {
 public:
  PageBranchWriter(const BranchFile& file, const PageBranchOptions& options)
      : file_(file),
        orbits_(page_orbits(file, options.dimension)),
        restart_(restart_command(file, options.plugin)),
        names_(counted_names(file.solutions)) {}

  std::string json() const {
    std::vector<std::string> sections;
    for (std::size_t s = 0; s < file_.sections.size(); ++s) sections.push_back(section(s));
    return page_object({{"name", page_text(file_.name)},
                        {"path", page_text(file_.path)},
                        {"sections", page_list(sections)},
                        {"orbits", orbits_.json},
                        {"noOrbits", page_text(orbits_.missing)},
                        {"noMultipliers", page_text(why_no_multipliers())},
                        {"restart", page_list({page_text(restart_.to_output), page_text(restart_.to_label)})}});
  }

 private:
  std::string section(std::size_t s) const {
    const PointSection& section = file_.sections[s];
    std::vector<std::string> columns, states, multipliers;
    for (std::size_t c = 0; c < section.columns.size(); ++c) columns.push_back(column(section, c));
    for (int k = 1; k <= section.dimension; ++k) states.push_back(page_text(section.state_name(k)));
    for (std::size_t k = 0; k < section.rows.size(); ++k)
      multipliers.push_back(multipliers_of(file_.diagnostic_of(s, k)));
    return page_object(
        {{"columns", page_list(section.columns, [](const std::string& name) { return page_text(name); })},
         {"values", page_list(columns)},
         {"branch", page_list(section.rows, [](const PointRow& row) { return integer(std::abs(row.branch)); })},
         {"point", page_list(section.rows, [](const PointRow& row) { return integer(std::abs(row.point)); })},
         {"stability", page_text(stability(section))},
         {"inadmissible", inadmissible(s)},
         {"fixed", fixed_parameters(s)},
         {"states", page_list(states)},
         {"multipliers", page_list(multipliers)},
         {"spectrum", page_text(spectrum_of(section))},
         {"restartRemark", page_text(why_no_restart(section))},
         {"labels", labels(s)}});
  }

  static std::string column(const PointSection& section, std::size_t c) {
    return page_list(section.rows, [c](const PointRow& row) {
      return c < row.values.size() ? page_number(row.values[c]) : std::string("null");
    });
  }

  /// {"row": why, ...}
  std::string inadmissible(std::size_t s) const {
    std::vector<std::string> rows;
    for (std::size_t k = 0; k < file_.admissible[s].size(); ++k) {
      if (file_.admissible[s][k]) continue;
      const DiagnosticPoint* point = file_.diagnostic_of(s, k);
      const std::string why = point == nullptr ? "" : violation_in(point->notes);
      rows.push_back(fmt::format("\"{}\":{}", k, page_text(why)));
    }
    return fmt::format("{{{}}}", fmt::join(rows, ","));
  }

  /// Parameters with a name that have no column and do not change along the section.
  std::string fixed_parameters(std::size_t s) const {
    const PointSection& section = file_.sections[s];
    const auto& active = section.active_parameters;
    std::vector<std::string> pairs;
    for (const auto& [k, name] : section.parameters) {
      const auto value = file_.parameters[s].find(k);
      const bool is_free = std::find(active.begin(), active.end(), k) != active.end();
      if (is_free || value == file_.parameters[s].end()) continue;
      pairs.push_back(page_list({page_text(name), page_number(value->second)}));
    }
    return page_list(pairs);
  }

  /// {"row": {...}, ...} of the points with a label.
  std::string labels(std::size_t s) const {
    std::vector<std::string> rows;
    for (std::size_t k = 0; k < file_.sections[s].rows.size(); ++k)
      if (file_.sections[s].rows[k].label > 0) rows.push_back(fmt::format("\"{}\":{}", k, label(s, k)));
    return fmt::format("{{{}}}", fmt::join(rows, ","));
  }

  std::string label(std::size_t s, std::size_t k) const {
    const int number = file_.sections[s].rows[k].label;
    const LabelledSolution* solution = file_.solution_of(s, k);
    const auto orbit = orbits_.place.find(number);
    const PointTypeFacts* type =
        find_point_type(file_.sections[s].rows[k].type, solution ? solution->kind : UserPointKind{});
    const bool restarts = solution != nullptr && restart_.exists() && has_constants_of_last(file_.sections[s]);
    return page_object(
        {{"label", integer(number)},
         {"type", page_text(file_.types[s][k])},
         {"name", name(s, k)},
         {"meaning", page_text(type == nullptr ? "" : type->meaning)},
         {"border", type != nullptr && type->is_bifurcation ? "1" : "0"},
         {"kind", page_text(solution == nullptr ? "" : kind(s, *solution))},
         {"form", page_text(normal_form(s, k))},
         {"birth", page_text(birth(s, k))},
         {"orbit", orbit == orbits_.place.end() ? "null" : integer(static_cast<long long>(orbit->second))},
         {"restarts", restarts ? "1" : "0"}});
  }

  /// Coefficient and verdict; "" where the d-file has none.
  std::string normal_form(std::size_t s, std::size_t k) const {
    const DiagnosticPoint* const point = file_.diagnostic_of(s, k);
    return point == nullptr || !point->normal_form ? "" : format_normal_form(*point->normal_form, "");
  }

  /// "PD1", or null.
  std::string name(std::size_t s, std::size_t k) const {
    if (file_.solution_of(s, k) == nullptr) return "null";
    const std::vector<std::string>& names = names_[static_cast<std::size_t>(file_.solution[s][k])];
    return names.empty() ? "null" : page_text(names.front());
  }

  /// The r-file has the constants of the last run, which --append may have added to sections of other runs.
  bool has_constants_of_last(const PointSection& section) const {
    const PointSection& last = file_.sections.back();
    return section.problem_type == last.problem_type && section.curve_type == last.curve_type &&
           section.signature == last.signature && section.active_parameters == last.active_parameters;
  }

  /// Why labels of the section have no command; "" where they have one.
  std::string why_no_restart(const PointSection& section) const {
    if (!restart_.exists() || has_constants_of_last(section)) return restart_.remark;
    return fmt::format("{} has the constants of another run, which was appended: give those of this one with -c",
                       sibling_path(file_.path, 'r'));
  }

  /// Words of a run on the branch or curve that is born at the label, or "".
  std::string birth(std::size_t s, std::size_t k) const {
    const PointSection& section = file_.sections[s];
    const std::optional<int> principal = section.parameter_of_column(0);
    if (!principal) return "";
    return birth_words(label_type(section.rows[k].type), section.problem_type, section.is_two_parameter_curve(),
                       section.parameter_name(*principal));
  }

  std::string kind(std::size_t s, const LabelledSolution& solution) const {
    return description(solution, [&](int k) { return file_.sections[s].shown_parameter(k); });
  }

  bool has_multipliers_somewhere() const {
    for (std::size_t s = 0; s < file_.sections.size(); ++s)
      for (std::size_t k = 0; k < file_.sections[s].rows.size(); ++k)
        if (const DiagnosticPoint* point = file_.diagnostic_of(s, k); point != nullptr && !point->multipliers.empty())
          return true;
    return false;
  }

  /// "" where some point has multipliers, and for solutions that have none.
  std::string why_no_multipliers() const {
    const auto has_none = [](const PointSection& section) { return *spectrum_of(section) == '\0'; };
    const auto& sections = file_.sections;
    if (std::all_of(sections.begin(), sections.end(), has_none) || has_multipliers_somewhere()) return "";
    const std::string path = sibling_path(file_.path, 'd');
    std::error_code error;
    if (path.empty()) return fmt::format("no d-file belongs to the name {}", file_.path);
    if (!std::filesystem::is_regular_file(path, error)) return fmt::format("{} is missing", path);
    for (const std::string& warning : file_.warnings)
      if (warning.starts_with(path)) return warning;
    return fmt::format("{} has none; a run with ISP = 1 or 2 computes them", path);
  }

  const BranchFile& file_;
  PageOrbits orbits_;
  RestartCommand restart_;
  std::vector<std::vector<std::string>> names_;
};

}  // namespace

std::string branch_json(const BranchFile& file, const PageBranchOptions& options) {
  return PageBranchWriter(file, options).json();
}

}  // namespace tchat
