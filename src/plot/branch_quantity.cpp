#include "plot/branch_quantity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "plot/branch_columns.hpp"
#include "plot/column_expression.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

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
    if (named(section.events, section.signature[s][1], "event") ||
        named(section.jumps, section.signature[s][2], "jump"))
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

}  // namespace tchat
