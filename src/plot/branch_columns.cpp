#include "plot/branch_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
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

}  // namespace tchat
