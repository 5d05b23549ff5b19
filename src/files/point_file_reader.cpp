#include "files/point_file_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t prefix_words = 4;  // BR PT TY LAB
constexpr std::size_t most_values = 1000;

/// NaN, Infinity and fields of stars (a number too large for its width): there is a number that cannot be shown.
bool is_gap(std::string_view word) {
  std::string lower;
  for (const char c : word)
    if (c != '+' && c != '-') lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower == "nan" || lower == "inf" || lower == "infinity" ||
         (!word.empty() && word.find_first_not_of('*') == std::string_view::npos);
}

/// Takes blanks off the beginning.
void skip_blanks(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
}

/// Takes `prefix` off the beginning; false when it is not there.
bool skip(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Digits at the beginning, with a minus before them.
std::optional<int> leading_integer(std::string_view text) {
  std::size_t size = text.starts_with('-') ? 1 : 0;
  while (size < text.size() && text[size] >= '0' && text[size] <= '9') ++size;
  return parse_integer(text.substr(0, size));
}

/// What follows `KEY =`, blanks before it taken off; the key is a word of its own.
std::optional<std::string_view> value_of_key(std::string_view line, std::string_view key) {
  for (auto at = line.find(key); at != std::string_view::npos; at = line.find(key, at + 1)) {
    std::string_view rest = line.substr(at + key.size());
    skip_blanks(rest);
    const bool word = at == 0 || line[at - 1] == ' ' || line[at - 1] == ',';
    if (!word || !skip(rest, "=")) continue;
    skip_blanks(rest);
    return rest;
  }
  return std::nullopt;
}

/// What follows `title` and blanks.
std::optional<std::string_view> text_after(std::string_view line, std::string_view title) {
  const auto at = line.find(title);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view rest = line.substr(at + title.size());
  skip_blanks(rest);
  return rest;
}

/// {1: 'x1', 2: "x2"}; an empty name is none.
std::map<int, std::string> dictionary(std::string_view text) {
  std::map<int, std::string> names;
  constexpr std::string_view quotes = "'\"";
  text = text.substr(0, text.find('}'));
  while (!text.empty()) {
    const auto open = text.find_first_of(quotes);
    if (open == std::string_view::npos) break;
    const auto close = text.find_first_of(quotes, open + 1);
    if (close == std::string_view::npos) break;
    std::string_view before = text.substr(0, open);
    before.remove_prefix(std::min(before.find_first_of("0123456789"), before.size()));
    if (const auto index = leading_integer(before); index && close > open + 1)
      names[*index] = std::string(text.substr(open + 1, close - open - 1));
    text.remove_prefix(close + 1);
  }
  return names;
}

/// "[[1, 1, 1], [2, 2, 2]]"; empty for what is no such list.
Signature signature_of(std::string_view text) {
  std::string numbers(text);
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
  const auto words = split_words(numbers);
  Signature signature;
  if (words.empty() || words.size() % 3 != 0) return {};
  for (std::size_t k = 0; k < words.size(); k += 3) {
    const auto field = parse_integer(words[k]), event = parse_integer(words[k + 1]), jump = parse_integer(words[k + 2]);
    if (!field || !event || !jump) return {};
    signature.push_back({*field, *event, *jump});
  }
  return signature;
}

/// The first line of a header: 0 RL0 RL1 A0 A1.
std::vector<double> bounds_of(std::string_view line) {
  constexpr std::size_t count = 5;
  const auto words = split_words(line);
  std::vector<double> bounds;
  for (std::size_t k = 1; k < words.size() && words.size() == count; ++k)
    if (const auto value = parse_fortran_real(words[k])) bounds.push_back(*value);
  return bounds.size() + 1 == count ? bounds : std::vector<double>();
}

/// What the lines of a header say; kept for sections that have none of their own.
class Header {
 public:
  void read(std::string_view line) {
    integer(line, "IPS", section_.problem_type);
    integer(line, "ISW", section_.branch_mode);
    integer(line, "ISP", section_.detect_bifurcations);
    integer(line, "NDIM", section_.dimension);
    integer(line, "NSEG", section_.segments);
    int parameters = section_.layout.parameters();
    integer(line, "PARAMETERS", parameters);
    section_.layout = ParameterLayout(std::clamp(parameters, 0, most_parameters));
    names(line, "unames", section_.states);
    names(line, "parnames", section_.parameters);
    names(line, "columns", long_names_);
    names(line, "eventnames", section_.events);
    names(line, "jumpnames", section_.jumps);
    if (const auto text = value_of_key(line, "SIGNATURE")) section_.signature = signature_of(*text);
    if (is_first_) section_.bounds = bounds_of(line);
    is_first_ = false;
    if (auto rest = text_after(line, "Branch"); rest && skip(*rest, "type:")) {
      skip_blanks(*rest);
      section_.curve_type = leading_integer(*rest).value_or(0);
    }
    if (auto rest = text_after(line, "Active continuation parameter")) {
      skip(*rest, "s") || skip(*rest, "(s)");
      if (skip(*rest, ":")) read_active(std::string(*rest));
    }
    headings_ = line;
  }
  const PointSection& section() const { return section_; }
  /// The last header line: headings of the columns, or nothing of use.
  const std::string& headings() const { return headings_; }
  /// Names of columns, from 1, that are longer than their headings.
  const std::map<int, std::string>& long_names() const { return long_names_; }

 private:
  static void integer(std::string_view line, std::string_view key, int& value) {
    if (const auto text = value_of_key(line, key)) value = leading_integer(*text).value_or(value);
  }

  static void names(std::string_view line, std::string_view key, std::map<int, std::string>& result) {
    auto text = value_of_key(line, key);
    if (text && skip(*text, "{") && text->find('}') != std::string_view::npos) result = dictionary(*text);
  }

  void read_active(std::string list) {
    section_.active_parameters.clear();
    std::replace(list.begin(), list.end(), '\'', ' ');
    for (const std::string_view word : split_words(list)) {
      if (const auto index = parse_integer(word)) section_.active_parameters.push_back(*index);
      for (const auto& [index, name] : section_.parameters)
        if (name == word) section_.active_parameters.push_back(index);
    }
  }

  PointSection section_;
  std::map<int, std::string> long_names_;
  std::string headings_;
  bool is_first_ = true;  // of the header's lines
};

/// The name of each number's column in `line`: the heading above it, where the header does not give it in full.
/// Headings begin one column to the right of the numbers' fields.
std::vector<std::string> column_names(std::string_view line, const std::vector<std::string_view>& words,
                                      const Header& header) {
  std::vector<std::string> names;
  const std::string& headings = header.headings();
  const bool there = headings.find(" PT ") != std::string::npos;
  const auto end_of = [line](std::string_view word) {
    return static_cast<std::size_t>(word.data() - line.data()) + word.size();
  };
  for (std::size_t k = prefix_words; k < words.size(); ++k) {
    const std::size_t begin = end_of(words[k - 1]) + 1;
    const std::size_t end = k + 1 == words.size() ? std::string::npos : end_of(words[k]) + 1;
    const std::string name(trimmed(there && begin < headings.size() ? headings.substr(begin, end - begin) : ""));
    names.push_back(name.empty() ? fmt::format("COLUMN({})", k - prefix_words + 1) : name);
  }
  for (const auto& [k, name] : header.long_names())
    if (k >= 1 && static_cast<std::size_t>(k) <= names.size()) names[static_cast<std::size_t>(k) - 1] = name;
  return names;
}

class PointFileReader {
 public:
  PointFileReader(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  PointFile read() {
    while (position_ < text_.size()) {
      const std::string_view line = next_line();
      const auto words = split_words(line);
      if (words.empty()) continue;
      if (words[0] == "0")
        read_header_line(line);
      else
        read_point(line, words);
    }
    if (gaps_ > 0)
      file_.warnings.push_back(fmt::format("{}: {} number{} not finite {} left out", path_, gaps_,
                                           gaps_ == 1 ? "" : "s", gaps_ == 1 ? "is" : "are"));
    if (file_.sections.empty())
      throw UserError(fmt::format("{}: no point in it; a run writes points to p.NAME (fort.7)", path_));
    return std::move(file_);
  }

 private:
  std::string_view next_line() {
    const auto end = text_.find('\n', position_);
    ended_ = end != std::string_view::npos;
    const auto line = text_.substr(position_, ended_ ? end - position_ : std::string_view::npos);
    position_ = ended_ ? end + 1 : text_.size();
    ++line_;
    return without_carriage_return(line);
  }

  void read_header_line(std::string_view line) {
    if (!std::exchange(in_header_, true)) {
      in_new_header_ = true;
      first_of_header_ = line;
    }
    const bool has_constants = line.find('=') != std::string_view::npos;
    if (has_constants && std::exchange(in_new_header_, false)) {
      header_ = Header();
      header_.read(first_of_header_);
      if (line.data() == first_of_header_.data()) return;
    }
    header_.read(line);
  }

  void read_point(std::string_view line, const std::vector<std::string_view>& words) {
    const bool first = in_header_ || file_.sections.empty();
    if (!ended_ && !is_whole(words, first)) {
      file_.warnings.push_back(
          fmt::format("{}:{}: the last line is not complete and is left out (the run that wrote it was interrupted?)",
                      path_, line_));
      return;
    }
    PointRow row = read_row(words);
    if (first) {
      file_.sections.push_back(header_.section());
      file_.sections.back().columns = column_names(line, words, header_);
      in_header_ = false;
      in_new_header_ = false;
    }
    PointSection& section = file_.sections.back();
    if (row.values.size() != section.columns.size())
      refuse(fmt::format("{} values after BR, PT, TY and LAB, but the points before have {}; the file is damaged",
                         row.values.size(), section.columns.size()));
    section.rows.push_back(std::move(row));
  }

  /// The last line, without its newline: does it have all the values that the line before has, in full?
  bool is_whole(const std::vector<std::string_view>& words, bool first) const {
    if (first) return false;
    const auto& section = file_.sections.back();
    if (words.size() != section.columns.size() + prefix_words) return false;
    const std::string_view last = words.back();
    return is_gap(last) ||
           (last.size() > 3 && parse_fortran_real(last) && last.find_first_of("EeDd") < last.size() - 2);
  }

  PointRow read_row(const std::vector<std::string_view>& words) {
    if (words.size() <= prefix_words || words.size() > prefix_words + most_values)
      refuse(fmt::format("a point has BR, PT, TY, LAB and at least one value, found {} word{}; this is no p-file",
                         words.size(), words.size() == 1 ? "" : "s"));
    PointRow row;
    int* const integers[] = {&row.branch, &row.point, &row.type, &row.label};
    static constexpr const char* names[] = {"BR", "PT", "TY", "LAB"};
    for (std::size_t k = 0; k < prefix_words; ++k) {
      const auto value = parse_integer(words[k]);
      if (!value)
        refuse(fmt::format("{} is no integer ({} is needed here); this is no p-file", in_quotes(words[k]), names[k]));
      *integers[k] = *value;
    }
    for (std::size_t k = prefix_words; k < words.size(); ++k) row.values.push_back(value_of(words[k]));
    return row;
  }

  double value_of(std::string_view word) {
    if (const auto value = parse_fortran_real(word)) return *value;
    if (!is_gap(word))
      refuse(fmt::format("{} is not a number; {}", in_quotes(word),
                         file_.sections.empty() ? "this is no p-file" : "the file is damaged"));
    ++gaps_;
    return std::numeric_limits<double>::quiet_NaN();
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw UserError(fmt::format("{}:{}: {}", path_, line_, message));
  }

  std::string_view text_;
  std::string path_;
  std::size_t position_ = 0;
  int line_ = 0;
  bool ended_ = true;
  bool in_header_ = false;
  bool in_new_header_ = false;  // of whose constants nothing has come
  std::string_view first_of_header_;
  Header header_;
  int gaps_ = 0;
  PointFile file_;
};

std::string name_in(const std::map<int, std::string>& names, int k, const char* symbol) {
  const auto found = names.find(k);
  return found != names.end() ? found->second : fmt::format("{}({})", symbol, k);
}

}  // namespace

std::string PointSection::parameter_name(int k) const { return name_in(parameters, k, "PAR"); }
std::string PointSection::shown_parameter(int k) const {
  const bool is_of_duration = segments > 0 && is_own_problem_type(problem_type) && layout.is_duration(k, segments);
  return is_of_duration && parameters.count(k) == 0 ? layout.duration_name(k) : parameter_name(k);
}
std::string PointSection::state_name(int k) const { return name_in(states, k, "U"); }

std::optional<std::size_t> PointSection::column(const std::string& name) const {
  const auto at = std::find(columns.begin(), columns.end(), name);
  if (at == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns.begin());
}

std::string PointSection::at_rest(const std::string& column) const {
  if (family_of(problem_type).facts().headings.has_period) return column;
  for (int k = 1; k <= dimension; ++k)
    for (const char* const kind : {"max", "min", "mean"})
      for (const std::string& name : {state_name(k), fmt::format("U({})", k)})
        if (column == fmt::format("{}({})", kind, name)) return state_name(k);
  return column;
}

std::vector<int> PointSection::free_problem_parameters() const {
  const bool ours = is_own_problem_type(problem_type);
  constexpr int auto_period_parameter = 11;
  std::vector<int> result;
  for (const int k : active_parameters) {
    const bool not_own =
        ours ? layout.is_duration(k, segments > 0 ? segments : max_segments) : k == auto_period_parameter;
    if (!not_own) result.push_back(k);
  }
  return result;
}

std::optional<int> PointSection::parameter_of_column(std::size_t column) const {
  for (const auto& [k, name] : parameters)
    if (name == columns[column]) return k;
  std::string_view heading = columns[column];
  return skip(heading, "PAR(") && heading.ends_with(')') ? parse_integer(heading.substr(0, heading.size() - 1))
                                                         : std::nullopt;
}

bool PointSection::is_two_parameter_curve() const {
  return tchat::is_two_parameter_curve(problem_type, branch_mode) || curve_type != 0;
}

bool PointSection::has_stability() const { return detect_bifurcations != 0 && has_multipliers(problem_type); }

PointFile parse_point_file(std::string_view text, const std::string& path) {
  return PointFileReader(text, path).read();
}

PointFile read_point_file(const std::string& path) {
  return parse_point_file(read_text_file(path, "points of branches", "a run writes them to p.NAME"), path);
}

bool looks_like_point_file(std::string_view text) {
  const auto words = split_words(text.substr(0, std::min(text.find('\n'), text.size())));
  if (words.empty()) return false;
  if (words[0] == "0") return true;
  if (words.size() <= prefix_words) return false;
  const bool integers = std::all_of(words.begin(), words.begin() + prefix_words,
                                    [](std::string_view word) { return parse_integer(word).has_value(); });
  return integers && std::any_of(words.begin() + prefix_words, words.end(),
                                 [](std::string_view word) { return word.find('.') != std::string_view::npos; });
}

}  // namespace tchat
