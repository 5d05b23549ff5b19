#include "plot/branch_quantity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/table_writer.hpp"
#include "plot/column_expression.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

/// One blank between words.
std::string normal(std::string_view text) { return fmt::format("{}", fmt::join(split_words(text), " ")); }

std::optional<std::size_t> column_of_heading(const PointSection& section, const std::string& wanted) {
  for (std::size_t k = 0; k < section.columns.size(); ++k)
    if (normal(section.columns[k]) == wanted) return k;
  for (std::size_t k = 0; k < section.columns.size(); ++k)
    if (same_letters(normal(section.columns[k]), wanted)) return k;
  return std::nullopt;
}

/// "MAX U(1)" taken apart: before "MAX ", symbol "u", index 1.
struct IndexedName {
  std::string before;
  std::string symbol;  ///< "par" or "u"
  int index = 0;
};

std::optional<IndexedName> indexed_name(const std::string& text) {
  constexpr std::size_t most_digits = 6;
  const auto open = text.rfind('(');
  if (open == std::string::npos || text.back() != ')') return std::nullopt;
  const std::string digits = text.substr(open + 1, text.size() - open - 2);
  if (digits.size() > most_digits || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  const auto index = parse_integer(digits);
  for (const std::string symbol : {"par", "u"}) {
    if (!index || open < symbol.size() || !same_letters(text.substr(open - symbol.size(), symbol.size()), symbol))
      continue;
    const std::string before = text.substr(0, open - symbol.size());
    const bool word =
        before.empty() || (std::isalnum(static_cast<unsigned char>(before.back())) == 0 && before.back() != '_');
    if (word) return IndexedName{before, symbol, *index};
  }
  return std::nullopt;
}

/// "PAR(2)" -> "omega", "MAX U(1)" -> "MAX x1", "T1" -> "PAR(61)", which is its heading.
std::string with_names(const PointSection& section, const std::string& wanted) {
  const auto is_wanted = [&](const auto& parameter) { return parameter.second == wanted; };
  const bool is_own = std::any_of(section.parameters.begin(), section.parameters.end(), is_wanted);
  if (const auto duration = section.layout.duration_of_name(wanted); duration && !is_own)
    return fmt::format("PAR({})", *duration);
  const auto found = indexed_name(wanted);
  if (!found) return wanted;
  return found->before +
         (found->symbol == "u" ? section.state_name(found->index) : section.parameter_name(found->index));
}

std::optional<std::size_t> column_of_last_word(const PointSection& section, const std::string& wanted) {
  const std::string end = " " + wanted;
  for (std::size_t k = 0; k < section.columns.size(); ++k) {
    const std::string heading = normal(section.columns[k]);
    if (heading.size() >= end.size() && same_letters(heading.substr(heading.size() - end.size()), end)) return k;
  }
  return std::nullopt;
}

/// The heading, with the names of durations.
std::string shown_name(const PointSection& section, std::size_t column) {
  const std::optional<int> k = section.parameter_of_column(column);
  return k ? section.shown_parameter(*k) : section.columns[column];
}

std::optional<int> parameter_index(const PointSection& section, const std::string& wanted) {
  for (const auto& [k, name] : section.parameters)
    if (name == wanted) return k;
  if (const auto duration = section.layout.duration_of_name(wanted)) return duration;
  const auto found = indexed_name(wanted);
  if (found && found->symbol == "par" && found->before.empty()) return found->index;
  return std::nullopt;
}

std::optional<std::size_t> column_index(const PointSection& section, const std::string& wanted) {
  if (const auto number = parse_integer(wanted); number && *number >= 1)
    return static_cast<std::size_t>(*number) <= section.columns.size()
               ? std::optional(static_cast<std::size_t>(*number) - 1)
               : std::nullopt;
  if (const auto column = column_of_heading(section, wanted)) return column;
  if (const auto column = column_of_heading(section, with_names(section, wanted))) return column;
  return column_of_last_word(section, wanted);
}

std::vector<std::string> free_names(const PointSection& section) {
  std::vector<std::string> names;
  for (const int k : section.free_problem_parameters()) names.push_back(section.parameter_name(k));
  return names;
}

/// The names of free problem parameters that all sections of all files have, in the first section's order.
std::vector<std::string> shared_free_parameters(const std::vector<BranchFile>& files) {
  std::vector<std::string> shared = free_names(files.front().sections.front());
  for (const BranchFile& file : files) {
    for (const PointSection& section : file.sections) {
      const std::vector<std::string> names = free_names(section);
      std::erase_if(shared, [&names](const std::string& name) {
        return std::find(names.begin(), names.end(), name) == names.end();
      });
    }
  }
  return shared;
}

}  // namespace

std::optional<ColumnSource> column_source(const BranchFile& file, std::size_t section, const std::string& wanted) {
  const PointSection& s = file.sections[section];
  const std::string name = s.at_rest(normal(wanted));
  ColumnSource source;
  if (const auto column = column_index(s, name)) {
    source.column = *column;
    source.name = shown_name(s, *column);
    return source;
  }
  if (const auto k = parameter_index(s, name)) {
    const auto& values = file.parameters[section];
    if (const auto found = values.find(*k); found != values.end()) {
      source.constant = found->second;
      source.name = s.shown_parameter(*k);
      return source;
    }
  }
  return std::nullopt;
}

ColumnSource find_column(const BranchFile& file, std::size_t section, const std::string& wanted, const char* option) {
  if (const auto source = column_source(file, section, wanted)) return *source;
  const PointSection& s = file.sections[section];
  throw UserError(fmt::format("{}: no column {} for {}; its columns are {} (or numbers 1..{})", file.path,
                              in_quotes(wanted), option, fmt::join(s.columns, ", "), s.columns.size()));
}

AxisColumns default_columns(const std::vector<BranchFile>& files) {
  bool curves_only = true;
  for (const BranchFile& file : files)
    for (const PointSection& section : file.sections) curves_only = curves_only && section.is_two_parameter_curve();
  const auto shared = shared_free_parameters(files);
  if (curves_only && shared.size() >= 2) return {shared[0], shared[1]};
  const PointSection& first = files.front().sections.front();
  return {first.columns[0], first.columns.size() > 1 ? first.columns[1] : first.columns[0]};
}

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view behind = "after:";

bool is_in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::size_t length_of_digits(std::string_view text) {
  return std::min(text.find_first_not_of("0123456789"), text.size());
}

/// The segments that WHERE means, from 0.
std::vector<int> segments_at(const PointSection& section, const std::string& where) {
  std::vector<int> found;
  const auto named = [&where](const std::map<int, std::string>& names, int k, const char* otherwise) {
    const auto name = names.find(k);
    return same_letters(name != names.end() ? name->second : fmt::format("{} {}", otherwise, k), where);
  };
  for (std::size_t s = 0; s < section.signature.size(); ++s)
    if (named(section.events, section.signature[s].event, "event") ||
        named(section.jumps, section.signature[s].jump, "jump"))
      found.push_back(static_cast<int>(s));
  if (const auto number = parse_integer(where); number && *number >= 1 && *number <= section.segments)
    found.assign(1, *number - 1);
  return found;
}

/// All names that WHERE may be in this section, the numbers of segments left out.
std::vector<std::string> places(const PointSection& section) {
  std::vector<std::string> names;
  const auto add = [&names](const std::map<int, std::string>& known, int k, const char* otherwise) {
    const auto found = known.find(k);
    const std::string name = found != known.end() ? found->second : fmt::format("{} {}", otherwise, k);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const auto& [field, event, jump] : section.signature) {
    add(section.events, event, "event");
    add(section.jumps, jump, "jump");
  }
  return names;
}

/// A number of a normal form by its name; nullptr: none of them.
const double NormalFormNote::*of_normal_form(std::string_view name) {
  if (name == "coefficient") return &NormalFormNote::value;
  return name == "uncertainty" ? &NormalFormNote::uncertainty : nullptr;
}

/// STATE@WHERE, taken apart.
struct StateAt {
  int state = 0;  // from 0
  std::string where;
  bool after = false;
};

class SectionNames {
 public:
  explicit SectionNames(const PointSection& section) : section_(section) {
    for (const std::string& column : section.columns) names_.push_back(column);
    for (const auto& [k, name] : section.parameters) names_.push_back(name);
    names_.insert(names_.end(), {"coefficient", "uncertainty"});
    for (const int k : section.active_parameters) names_.push_back(fmt::format("PAR({})", k));
    for (const auto& [k, name] : section.parameters) names_.push_back(fmt::format("PAR({})", k));
    for (int k = 1; k <= section.dimension; ++k) {
      for (const std::string& name : {section.state_name(k), fmt::format("U({})", k)}) {
        names_.push_back(name);
        for (const char* const kind : {"max", "min", "mean"})
          if (const std::string whole = fmt::format("{}({})", kind, name); section.at_rest(whole) != whole)
            names_.push_back(whole);
        names_.push_back("MAX " + name);
      }
    }
  }

  /// Of the longest name at the beginning of the text; 0: none.
  std::size_t length(std::string_view text) const {
    return std::max(length_of_name(text, names_), length_of_state_at(text));
  }

  std::optional<StateAt> state_at(std::string_view text) const {
    const std::size_t at = text.find('@');
    const auto state = at == std::string_view::npos ? std::nullopt : state_named(text.substr(0, at));
    if (!state) return std::nullopt;
    std::string_view where = text.substr(at + 1);
    const bool after = where.starts_with(behind);
    if (after) where.remove_prefix(behind.size());
    return StateAt{*state, std::string(where), after};
  }

 private:
  std::optional<int> state_named(std::string_view text) const {
    for (int k = 1; k <= section_.dimension; ++k)
      if (same_letters(text, section_.state_name(k)) || same_letters(text, fmt::format("U({})", k))) return k - 1;
    return std::nullopt;
  }

  std::size_t length_of_state_at(std::string_view text) const {
    const std::size_t at = text.find('@');
    if (at == std::string_view::npos || !state_named(text.substr(0, at))) return 0;
    std::size_t begin = at + 1;
    if (text.substr(begin).starts_with(behind)) begin += behind.size();
    const std::string_view rest = text.substr(begin);
    std::size_t longest = std::max(length_of_digits(rest), length_of_name(rest, places(section_)));
    if (longest == 0)  // a word that is no place, for the message
      while (longest < rest.size() && (is_in_name(rest[longest]))) ++longest;
    return longest == 0 ? 0 : begin + longest;
  }

  const PointSection& section_;
  std::vector<std::string> names_;
};

class QuantityReader {
 public:
  QuantityReader(const BranchFile& file, std::size_t section, const std::string& wanted, const char* option)
      : file_(file),
        index_(section),
        section_(file.sections[section]),
        names_(section_),
        wanted_(wanted),
        option_(option) {}

  BranchQuantity read() const {
    if (column_source(file_, index_, wanted_) || of_normal_form(wanted_)) return named(wanted_);
    if (!looks_like_expression(wanted_)) find_column(file_, index_, wanted_, option_);  // refuses it
    const KnownNames known{[this](std::string_view text) { return names_.length(text); },
                           fmt::format("{}", fmt::join(section_.columns, ", "))};
    const ColumnExpression expression = parse_expression(wanted_, known, where());
    std::vector<BranchQuantity> parts;
    for (const std::string& name : expression.names) parts.push_back(named(name));
    if (expression.is_one_name()) return parts.front();
    BranchQuantity result = combined(expression, parts);
    result.label = expression_label(wanted_, known, [this](const std::string& name) { return named(name).label; });
    return result;
  }

 private:
  std::string where() const { return fmt::format("{}: {} {}", file_.path, option_, in_quotes(wanted_)); }

  BranchQuantity named(const std::string& name) const {
    if (const auto source = column_source(file_, index_, name)) {
      BranchQuantity quantity{mathematical_name(source->name), {{}}, std::vector<bool>(section_.rows.size(), true), ""};
      for (const PointRow& row : section_.rows) quantity.arms[0].push_back(source->value(row));
      return quantity;
    }
    if (const auto state = names_.state_at(name)) return at_segments(name, *state);
    if (const auto number = of_normal_form(name)) return of_forms(name, number);
    find_column(file_, index_, name, option_);  // refuses it
    return {};
  }

  BranchQuantity of_forms(const std::string& name, const double NormalFormNote::*number) const {
    BranchQuantity quantity{plain_text(name), {{}}, {}, ""};
    for (std::size_t row = 0; row < section_.rows.size(); ++row) {
      const DiagnosticPoint* const point = file_.diagnostic_of(index_, row);
      const NormalFormNote* const form = point != nullptr && point->normal_form ? &*point->normal_form : nullptr;
      quantity.known.push_back(form != nullptr);
      quantity.arms[0].push_back(form != nullptr ? form->*number : nothing);
    }
    return quantity;
  }

  BranchQuantity at_segments(const std::string& name, const StateAt& at) const {
    const std::vector<int> segments = segments_at(section_, at.where);
    if (segments.empty())
      throw UserError(fmt::format(
          "{}: no segment ends at {}; segments are named by the event or jump at their end ({}) "
          "or by their number (1..{}), as in {}@1",
          where(), in_quotes(at.where), fmt::join(places(section_), ", "), section_.segments, section_.state_name(1)));
    BranchQuantity quantity{label_of(at), {}, {}, name};
    quantity.arms.resize(segments.size());
    for (std::size_t row = 0; row < section_.rows.size(); ++row) {
      const SegmentEnds* ends = file_.ends_of(index_, row);
      const bool known = ends != nullptr && ends->first.cols() == section_.segments && at.state < ends->first.rows();
      quantity.known.push_back(known);
      for (std::size_t k = 0; k < segments.size(); ++k) {
        const int s = segments[k];
        quantity.arms[k].push_back(!known     ? nothing
                                   : at.after ? ends->first(at.state, (s + 1) % section_.segments)
                                              : ends->last(at.state, s));
      }
    }
    if (std::find(quantity.known.begin(), quantity.known.end(), true) == quantity.known.end())
      throw UserError(
          fmt::format("{}: the states at the ends of segments are those of labelled orbits, and the q-file "
                      "beside it has none of them; a run with NPR=1 writes the orbit of every point",
                      where()));
    return quantity;
  }

  LabelText label_of(const StateAt& at) const {
    const LabelText state = mathematical_name(section_.state_name(at.state + 1));
    const bool number = parse_integer(at.where).has_value();
    const std::string words = number ? fmt::format("{} segment {}", at.after ? " after" : " at the end of", at.where)
                                     : fmt::format(" {} {}", at.after ? "after" : "at", at.where);
    return joined(state, plain_text(words));
  }

  /// Row by row and arm by arm; what has one arm goes with all arms of the others.
  BranchQuantity combined(const ColumnExpression& expression, const std::vector<BranchQuantity>& parts) const {
    BranchQuantity result;
    std::size_t arms = 1;
    result.known.assign(section_.rows.size(), true);
    for (const BranchQuantity& part : parts) {
      if (part.arms.size() > 1 && arms > 1 && part.arms.size() != arms)
        throw UserError(
            fmt::format("{}: {} has {} values in a period and {} has {}; one expression takes states at one "
                        "event",
                        where(), result.orbits_of, arms, part.orbits_of, part.arms.size()));
      arms = std::max(arms, part.arms.size());
      if (!part.orbits_of.empty()) result.orbits_of = part.orbits_of;
      for (std::size_t k = 0; k < part.known.size(); ++k) result.known[k] = result.known[k] && part.known[k];
    }
    std::vector<std::vector<double>> rows;
    for (std::size_t arm = 0; arm < arms; ++arm)
      for (std::size_t row = 0; row < section_.rows.size(); ++row) {
        rows.emplace_back();
        for (const BranchQuantity& part : parts) rows.back().push_back(part.arms[arm % part.arms.size()][row]);
      }
    const std::vector<double> values = evaluate(expression, rows, where());
    for (std::size_t arm = 0; arm < arms; ++arm) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(arm * section_.rows.size());
      result.arms.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(section_.rows.size()));
    }
    return result;
  }

  const BranchFile& file_;
  std::size_t index_;
  const PointSection& section_;
  SectionNames names_;
  const std::string& wanted_;
  const char* option_;
};

}  // namespace

BranchQuantity read_quantity(const BranchFile& file, std::size_t section, const std::string& wanted,
                             const char* option) {
  return QuantityReader(file, section, wanted, option).read();
}

namespace {

/// One quantity in all sections.
struct Quantity {
  std::string name;
  std::size_t arms = 0;  // the most that a section has
  std::vector<BranchQuantity> sections;

  TableCell cell(std::size_t section, std::size_t row, std::size_t arm) const {
    const BranchQuantity& values = sections[section];
    if (arm >= values.arms.size()) return {};
    const double value = values.arms[arm][row];
    return std::isfinite(value) ? TableCell(value) : TableCell();
  }
};

Quantity read(const BranchFile& file, const std::string& name, const char* option) {
  Quantity quantity{name, 0, {}};
  for (std::size_t s = 0; s < file.sections.size(); ++s) {
    quantity.sections.push_back(read_quantity(file, s, name, option));
    quantity.arms = std::max(quantity.arms, quantity.sections.back().arms.size());
  }
  return quantity;
}

}  // namespace

void write_quantity_table(TableWriter& out, const BranchFile& file, const std::vector<std::string>& wanted,
                          const char* option) {
  std::vector<Quantity> quantities;
  std::vector<std::string> headings{"section", "point"};
  for (const std::string& name : wanted) {
    quantities.push_back(read(file, name, option));
    headings.insert(headings.end(), quantities.back().arms, name);
  }
  std::vector<TableColumn> columns;
  for (const std::string& heading : distinct_headings(headings)) columns.push_back({heading});
  out.begin(columns);
  for (std::size_t s = 0; s < file.sections.size(); ++s)
    for (std::size_t row = 0; row < file.sections[s].rows.size(); ++row) {
      std::vector<TableValue> values{TableCell(static_cast<int>(s) + 1),
                                     TableCell(std::abs(file.sections[s].rows[row].point))};
      for (const Quantity& quantity : quantities)
        for (std::size_t arm = 0; arm < quantity.arms; ++arm) values.emplace_back(quantity.cell(s, row, arm));
      out.row(values);
    }
  out.end();
}

}  // namespace tchat
