#include "files/solution_file_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/solution_file.hpp"
#include "model/parameter_vector.hpp"
#include "settings/constant_value.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

/// One line of the file and whether it ends in a newline.
struct Line {
  std::string_view text;
  bool ended = true;
};

/// The first of the words that split_words finds, cut off from `rest`; empty when there is none. A file has many.
std::string_view take_word(std::string_view& rest) {
  constexpr std::string_view blanks = " \t\v\f\r";
  const auto is_blank = [&](char c) { return c <= ' ' && blanks.find(c) != std::string_view::npos; };
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// The blank-separated numbers of the lines of one entry, converted one by one.
class NumberStream {
 public:
  NumberStream(const std::vector<Line>& lines, int first_line, const std::string& path)
      : lines_(lines), next_line_(first_line), path_(path) {}

  double real() {
    const std::string_view word = next();
    const auto value = parse_fortran_real(word);
    if (!value)
      refuse(
          fmt::format("{} is not a finite number; the solution cannot be used: restore the file, or delete the entry",
                      in_quotes(word)));
    return *value;
  }

  int integer(int lowest, std::int64_t highest, const std::string& what) {
    const std::string_view word = next();
    const auto value = parse_integer(word);
    if (!value || *value < lowest || *value > highest)
      refuse(fmt::format("{} is not {}: an integer from {} to {} is needed; the file is damaged", in_quotes(word), what,
                         lowest, highest));
    return *value;
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw UserError(fmt::format("{}:{}: {}", path_, next_line_, message));
  }

 private:
  /// Callers never ask for more words than there are: the entry was counted before.
  std::string_view next() {
    std::string_view word = take_word(rest_);
    while (word.empty() && used_ < lines_.size()) {
      rest_ = lines_[used_].text;
      next_line_ += used_ > 0 ? 1 : 0;
      ++used_;
      word = take_word(rest_);
    }
    return word;
  }

  const std::vector<Line>& lines_;
  std::size_t used_ = 0;
  int next_line_;
  std::string_view rest_;  // of the line
  const std::string& path_;
};

/// What a file is by its name, where that is no q-file.
std::string other_kind(const std::string& path) {
  const std::filesystem::path file = std::filesystem::path(path).filename();
  const std::string name = file.string();
  if (file.extension() == ".dat") return "this is starting data, no q-file";
  if (name.starts_with("p.") || name.starts_with("b.")) return "this is a p-file (the branch's points), no q-file";
  if (name.starts_with("d.")) return "this is a d-file (what the run noted), no q-file";
  if (name.starts_with(constants_prefix) || name.starts_with("r.")) return "this is a constants file, no q-file";
  return "";
}

/// The q-file of the same run where there is one.
std::string solution_file_cure(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string name = file.filename().string();
  const bool data = file.extension() == ".dat";
  const std::string run = data ? file.stem().string() : name.substr(name.find('.') + 1);
  const std::filesystem::path solutions = file.parent_path() / ("q." + run);
  std::error_code ignored;
  if (std::filesystem::exists(solutions, ignored)) return fmt::format("give {}", solutions.string());
  const std::string made = data ? fmt::format("; `tchat dat {}` makes q.{} from the data", run, run) : "";
  return fmt::format("labelled solutions are in a run's q-file, q.NAME{}", made);
}

bool has_name(const std::vector<std::string>& names, const std::string& type) {
  return std::find(names.begin(), names.end(), type) != names.end();
}

/// The last words of a text that has so many, in their order.
std::vector<std::string_view> last_words(std::string_view text, std::int64_t count) {
  constexpr std::string_view blanks = " \t\v\f\r\n";
  std::vector<std::string_view> words;
  while (static_cast<std::int64_t>(words.size()) < count) {
    const auto end = text.find_last_not_of(blanks);
    if (end == std::string_view::npos) return {};
    const auto before = text.find_last_of(blanks, end);
    const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
    words.push_back(text.substr(begin, end + 1 - begin));
    text = text.substr(0, begin);
  }
  std::reverse(words.begin(), words.end());
  return words;
}

/// May a solution be what `label` names? Its numbers end with what kinds of point it is; where these are damaged, yes.
bool may_be(const SolutionIdentifier& id, std::string_view numbers, const StartLabel& label) {
  if (label.type.empty()) return id.label() == label.number;
  if (!id.has_kind()) return has_name(type_names(id.type(), {}, {}), label.type);
  std::vector<UserPointKind> kinds;
  const std::vector<std::string_view> words = last_words(numbers, id.internal_parameters());
  for (std::size_t k = 0; k + kind_values <= words.size(); k += kind_values) {
    const auto kind = parse_fortran_real(words[k]), segment = parse_fortran_real(words[k + 1]),
               index = parse_fortran_real(words[k + 2]);
    if (!kind || !segment || !index || std::abs(*kind) > 1e6 || std::abs(*index) > 1e6) return true;
    if (*kind == own_mesh_mark) break;
    kinds.push_back({static_cast<int>(*kind), 0, static_cast<int>(*index), 0.0});
  }
  if (kinds.empty()) return true;
  return has_name(type_names(id.type(), kinds.front(), {kinds.begin() + 1, kinds.end()}), label.type);
}

class SolutionReader {
 public:
  /// With a label: other solutions are passed over by their number of lines.
  SolutionReader(std::string_view text, const std::string& path, const StartLabel* wanted = nullptr)
      : text_(text), path_(path), wanted_(wanted) {}

  SolutionFile read() {
    while (position_ < text_.size()) {
      const Line line = next_line();
      if (split_words(line.text).empty()) {
        if (line.ended) file_.complete_bytes = position_;
        continue;
      }
      if (!read_entry(line)) break;
      file_.complete_bytes = position_;
    }
    return std::move(file_);
  }

 private:
  std::string place(int line) const { return fmt::format("{}:{}", path_, line); }

  Line next_line() {
    const auto end = text_.find('\n', position_);
    Line line;
    line.ended = end != std::string_view::npos;
    line.text = without_carriage_return(text_.substr(position_, line.ended ? end - position_ : std::string_view::npos));
    position_ = line.ended ? end + 1 : text_.size();
    ++line_;
    return line;
  }

  /// Warns; false for "no entry was read".
  bool truncated(int entry_line) {
    file_.warnings.push_back(
        fmt::format("{}:{}: the last solution is not complete and is left out (the run that wrote it was interrupted?)",
                    path_, entry_line));
    return false;
  }

  /// False when the entry is the cut-off last one.
  bool read_entry(const Line& first) {
    const int entry_line = line_;
    const auto identifier = read_identifier(first);
    if (!identifier) return truncated(entry_line);
    if (first.ended) check_numbering(*identifier, place(entry_line));
    if (identifier->is_empty_entry()) return count_in(*identifier);
    if (!first.ended) return truncated(entry_line);
    check_counts(*identifier, place(entry_line));
    if (wanted_ != nullptr && pass_over(*identifier)) return count_in(*identifier);
    const auto lines = entry_lines(*identifier);
    if (!lines) {
      check_line_count(*identifier, place(entry_line));
      return truncated(entry_line);
    }
    const std::int64_t found = count_words(*lines);
    if (cut_inside_last_line(*identifier, *lines, found)) return truncated(entry_line);
    const bool direction = has_direction(*identifier, found, entry_line);
    NumberStream numbers(*lines, entry_line + 1, path_);
    file_.solutions.push_back(read_solution(*identifier, direction, numbers, entry_line));
    return count_in(*identifier);
  }

  bool count_in(const SolutionIdentifier& id) {
    file_.last_branch = std::max(file_.last_branch, id.branch());
    file_.last_label = std::max(file_.last_label, id.label());
    return true;
  }

  /// Nothing when the line is the last one of the file and cut off.
  std::optional<SolutionIdentifier> read_identifier(const Line& line) const {
    const auto words = split_words(line.text);
    SolutionIdentifier identifier;
    for (const std::string_view word : words) {
      const auto value = parse_integer(word);
      const bool cut = !line.ended && &word == &words.back() && word == "-";
      if (!value && !cut) refuse_identifier(fmt::format("found {}, not an integer", in_quotes(word)));
      if (identifier.count == identifier.values.size()) refuse_identifier("found more than 16 integers");
      identifier.values[identifier.count++] = value.value_or(0);
    }
    if (identifier.count == 12 || identifier.count == 16) return identifier;
    if (!line.ended) return std::nullopt;
    refuse_identifier(fmt::format("found {} integer{}", identifier.count, identifier.count == 1 ? "" : "s"));
  }

  [[noreturn]] void refuse_identifier(const std::string& found) const {
    if (file_.solutions.empty())
      if (const std::string other = other_kind(path_); !other.empty())
        throw UserError(fmt::format("{}: {}; {}", place(line_), other, solution_file_cure(path_)));
    throw UserError(
        fmt::format("{}: a labelled solution begins with a line of 16 integers (12 in older files), {}; either this is "
                    "no q-file, or "
                    "the number of lines of the solution before (integer 9 of its first line) is wrong",
                    place(line_), found));
  }

  /// The lines of the entry; nothing when the file ends before.
  std::optional<std::vector<Line>> entry_lines(const SolutionIdentifier& id) {
    const auto left = static_cast<std::int64_t>(text_.size() - position_);  // a line has one byte at least
    if (id.lines() > left) return std::nullopt;
    std::vector<Line> lines;
    while (static_cast<std::int64_t>(lines.size()) < id.lines()) {
      if (position_ >= text_.size()) return std::nullopt;
      lines.push_back(next_line());
    }
    return lines;
  }

  /// False, with nothing passed over, for a solution that may be wanted, or that ends with the file.
  bool pass_over(const SolutionIdentifier& id) {
    std::size_t end = position_;
    for (std::int64_t k = 0; k < id.lines(); ++k) {
      const auto newline = text_.find('\n', end);
      if (newline == std::string_view::npos) return false;
      end = newline + 1;
    }
    if (may_be(id, text_.substr(position_, end - position_), *wanted_)) return false;
    position_ = end;
    line_ += static_cast<int>(id.lines());
    return true;
  }

  static std::int64_t count_words(const std::vector<Line>& lines) {
    std::size_t count = 0;
    for (const Line& line : lines) {
      std::string_view rest = line.text;
      while (!take_word(rest).empty()) ++count;
    }
    return static_cast<std::int64_t>(count);
  }

  /// A last line without newline is whole when it has the fixed width of 4 + 19 k or 4 + 26 k columns for its k numbers
  /// and no number is missing.
  static bool cut_inside_last_line(const SolutionIdentifier& id, const std::vector<Line>& lines, std::int64_t found) {
    if (lines.back().ended) return false;
    const bool all_numbers = found == id.numbers(false) || found == id.numbers(true);
    const std::string_view text = lines.back().text;
    const std::size_t count = split_words(text).size();
    const bool whole = text.size() == 4 + 26 * count || (text.size() == 4 + 19 * count && !has_more_digits(text));
    return !all_numbers || !whole;
  }

  /// Than the ten decimals of a number of 19 columns: part of one of 26.
  static bool has_more_digits(std::string_view text) {
    const std::string_view last = split_words(text).back();
    const auto point = last.find('.');
    return last.find_first_of("EeDd") == std::string_view::npos || last.find_first_of("EeDd") - point != 11;
  }

  bool has_direction(const SolutionIdentifier& id, std::int64_t found, int entry_line) const {
    if (found == id.numbers(true)) return true;
    if (found == id.numbers(false)) return false;
    throw UserError(fmt::format(
        "{}: the solution with label {} has {} numbers, its first line makes it {} or (with direction) {}; the file is "
        "damaged: its number of lines is integer 9 of its first line",
        place(entry_line), id.label(), found, id.numbers(false), id.numbers(true)));
  }

  LabelledSolution read_solution(const SolutionIdentifier& id, bool direction, NumberStream& numbers,
                                 int entry_line) const {
    LabelledSolution solution;
    solution.branch = id.branch();
    solution.point = id.point();
    solution.type = id.type();
    solution.label = id.label();
    solution.branch_mode = id.branch_mode();
    solution.problem_type = id.problem_type();
    solution.dimension = id.dimension();
    solution.layout = id.layout();
    solution.mesh_intervals = static_cast<int>(id.mesh_intervals());
    solution.collocation_points = static_cast<int>(id.collocation_points());
    read_states(id, numbers, solution);
    check_mesh(solution, entry_line);
    if (direction) read_direction(id, numbers, solution);
    const std::int64_t ordinary = id.parameters() - id.internal_parameters();
    for (std::int64_t k = 0; k < ordinary; ++k) solution.parameters.push_back(numbers.real());
    if (id.has_kind()) {
      solution.kind = read_kind(numbers);
      for (std::int64_t left = id.internal_parameters() - kind_values; left > 0; left -= kind_values) {
        const UserPointKind kind = read_kind(numbers, true);
        if (kind.kind == own_mesh_mark) {
          read_own_mesh(kind.segment, kind.index, left - kind_values, numbers, solution);
          break;
        }
        solution.further.push_back(kind);
      }
    } else {
      for (std::int64_t k = 0; k < id.internal_parameters(); ++k) numbers.real();
    }
    return solution;
  }

  static void read_states(const SolutionIdentifier& id, NumberStream& numbers, LabelledSolution& solution) {
    solution.states.resize(id.numbers_per_point() - 1, id.time_points());
    for (Eigen::Index point = 0; point < solution.states.cols(); ++point) {
      solution.tau.push_back(numbers.real());
      for (Eigen::Index row = 0; row < solution.states.rows(); ++row) solution.states(row, point) = numbers.real();
    }
  }

  static void read_direction(const SolutionIdentifier& id, NumberStream& numbers, LabelledSolution& solution) {
    for (std::int64_t i = 0; i < id.free_parameters(); ++i)
      solution.free_parameters.push_back(numbers.integer(1, id.parameters(), "the number of a parameter"));
    for (std::int64_t i = 0; i < id.free_parameters(); ++i) solution.parameter_direction.push_back(numbers.real());
    solution.state_direction.resize(solution.states.rows(), solution.states.cols());
    for (Eigen::Index point = 0; point < solution.states.cols(); ++point)
      for (Eigen::Index row = 0; row < solution.states.rows(); ++row)
        solution.state_direction(row, point) = numbers.real();
  }

  /// t runs from 0 to 1 and mesh points differ; ten decimals may make neighbouring points inside an interval equal.
  void check_mesh(const LabelledSolution& solution, int entry_line) const {
    if (solution.tau.size() < 2) return;
    const auto refuse_here = [&](const std::string& what) {
      throw UserError(fmt::format("{}: solution with label {}: {}; t must rise from 0 to 1", place(entry_line),
                                  solution.label, what));
    };
    constexpr double rounding = level::differences;
    if (std::abs(solution.tau.front()) > rounding || std::abs(solution.tau.back() - 1.0) > rounding)
      refuse_here(fmt::format("t runs from {} to {}", solution.tau.front(), solution.tau.back()));
    const auto step = static_cast<std::size_t>(solution.collocation_points);
    for (std::size_t k = 1; k < solution.tau.size(); ++k) {
      const bool falls = solution.tau[k] < solution.tau[k - 1];
      const bool empty_interval = k % step == 0 && !(solution.tau[k] > solution.tau[k - step]);
      if (falls || empty_interval)
        refuse_here(fmt::format("t = {} at time point {} after t = {}", solution.tau[k], k + 1, solution.tau[k - 1]));
    }
  }

  /// `left`: the internal values that are left.
  static void read_own_mesh(int segments, int points, std::int64_t left, NumberStream& numbers,
                            LabelledSolution& solution) {
    const auto need = [&numbers](bool condition) {
      if (!condition)
        numbers.refuse(
            "the internal values at the end of the parameters are no meshes of the segments, each of which rises from "
            "0 to 1; the file is damaged");
    };
    need(own_mesh_values(points) == left && segments * solution.dimension == solution.states.rows());
    int ends = 0;
    for (int k = 0; k < points; ++k) {
      const double tau = numbers.real();
      const bool begins = k == 0 || solution.own_mesh.back() == 1.0;
      need(begins ? tau == 0.0 : tau > solution.own_mesh.back() && tau <= 1.0);
      if (tau == 1.0) ++ends;
      solution.own_mesh.push_back(tau);
    }
    need(ends == segments && solution.own_mesh.back() == 1.0 && (points - segments) % segments == 0);
    for (std::int64_t k = points; k < left; ++k) numbers.real();
  }

  static UserPointKind read_kind(NumberStream& numbers, bool may_be_mark = false) {
    const auto whole = [&](double lowest, double highest, const std::string& what) {
      const double value = numbers.real();
      if (!(value >= lowest && value <= highest) || value != static_cast<double>(static_cast<int>(value)) ||
          (what == "kind" && value == own_mesh_mark && !may_be_mark))
        numbers.refuse(fmt::format(
            "{} as {} of a UZ point (one of the internal values at the end of the parameters); the file is damaged",
            value, what));
      return static_cast<int>(value);
    };
    UserPointKind kind;
    kind.kind = whole(0.0, UserPointKind::chatter, "kind");
    kind.segment = whole(0.0, max_segments, "segment");
    kind.index =
        whole(kind.kind == UserPointKind::other_type ? -99.0 : -1.0, 1e9, "index");  // type numbers: two digits
    kind.tau = numbers.real();
    return kind;
  }

  std::string_view text_;
  std::string path_;
  const StartLabel* wanted_;
  std::size_t position_ = 0;
  int line_ = 0;
  SolutionFile file_;
};

/// Null when there is none.
const LabelledSolution* search(const std::vector<LabelledSolution>& solutions, const StartLabel& label) {
  int left = std::max(label.number, 1);
  for (const LabelledSolution& solution : solutions) {
    const bool matches =
        label.type.empty() ? solution.label == label.number : has_name(type_names(solution), label.type);
    if (matches && (label.type.empty() || --left == 0)) return &solution;
  }
  return nullptr;
}

std::string read_solution_text(const std::string& path) {
  return read_text_file(path, "labelled solutions",
                        "a run writes them to q.NAME, `tchat dat NAME` makes them from NAME.dat");
}

std::string label_list(const std::vector<LabelledSolution>& solutions) {
  std::string list;
  for (const LabelledSolution& solution : solutions) {
    const std::string type = fmt::format("{}", fmt::join(type_names(solution), " "));
    list += fmt::format("{}{}{}", list.empty() ? "" : ", ", solution.label, type.empty() ? "" : " (" + type + ")");
  }
  return list;
}

/// Where the labels went that a run has replaced.
std::string before_replacement(const std::string& path) {
  const std::string earlier = path + "~";
  return std::filesystem::exists(earlier) ? fmt::format("; the file that it replaced is {}", earlier) : "";
}

}  // namespace

SolutionFile parse_solution_file(std::string_view text, const std::string& path) {
  return SolutionReader(text, path).read();
}

SolutionFile read_solution_file(const std::string& path) { return parse_solution_file(read_solution_text(path), path); }

SolutionFile parse_solution_file(std::string_view text, const std::string& path, const StartLabel& label) {
  SolutionFile file = SolutionReader(text, path, &label).read();
  return search(file.solutions, label) != nullptr ? std::move(file) : parse_solution_file(text, path);
}

SolutionFile read_solution_file(const std::string& path, const StartLabel& label) {
  return parse_solution_file(read_solution_text(path), path, label);
}

std::string resolve_solution_path(const std::string& path) { return resolve_run_file(path, 'q'); }

const LabelledSolution& find_solution(const std::vector<LabelledSolution>& solutions, const StartLabel& label,
                                      const std::string& path) {
  if (const LabelledSolution* found = search(solutions, label)) return *found;
  const std::string wanted = label.type.empty() ? fmt::format("label {}", label.number)
                                                : fmt::format("point {}{}", label.type, std::max(label.number, 1));
  throw UserError(solutions.empty() ? fmt::format("{}: no {}; the file holds no solution", path, wanted)
                                    : fmt::format("{}: no {}; there are the labels {}{}", path, wanted,
                                                  label_list(solutions), before_replacement(path)));
}

std::vector<std::vector<std::string>> counted_names(const std::vector<LabelledSolution>& solutions) {
  std::map<std::string, int> counts;
  std::vector<std::vector<std::string>> names;
  for (const LabelledSolution& solution : solutions) {
    names.emplace_back();
    for (const std::string& type : type_names(solution))
      if (!type.empty()) names.back().push_back(fmt::format("{}{}", type, ++counts[type]));
  }
  return names;
}

StartLabel read_label(const std::string& word) {
  if (const auto number = parse_integer(word); number && *number >= 0) return {"", *number};
  if (const auto typed = parse_typed_label(word)) return *typed;
  throw UserError(fmt::format("{} is no label; a number or a type with its count is needed, such as 5, GR1 or PD1",
                              in_quotes(word)));
}

int segment_count(const LabelledSolution& solution) {
  const auto rows = static_cast<int>(solution.states.rows());
  if (solution.dimension > 0) return rows % solution.dimension == 0 ? rows / solution.dimension : 0;
  const auto durations =
      static_cast<int>(std::count_if(solution.free_parameters.begin(), solution.free_parameters.end(),
                                     [&](int k) { return solution.layout.is_duration(k, max_segments); }));
  return durations > 0 && rows % durations == 0 ? durations : 0;
}

LabelledSolution in_layout(LabelledSolution solution, const ParameterLayout& layout) {
  const ParameterLayout before = std::exchange(solution.layout, layout);
  const bool has_durations = is_own_problem_type(solution.problem_type) || !records_problem_type(solution.problem_type);
  const bool same_places = before.first_duration() == layout.first_duration() && before.rotation() == layout.rotation();
  if (same_places || !has_durations) return solution;
  const int segments = segment_count(solution);
  const bool has_rotation = family_of(solution.problem_type).facts().has_rotation;
  const auto new_place = [&](int k) {
    if (has_rotation && k == before.rotation()) return layout.rotation();
    return before.is_duration(k, segments) ? layout.duration(before.duration_segment(k)) : k;
  };
  const std::vector<double> old = std::exchange(solution.parameters, {});
  solution.parameters.assign(static_cast<std::size_t>(layout.stored(segments, has_rotation)), 0.0);
  for (int k = 1; k <= static_cast<int>(old.size()); ++k) {
    const int place = new_place(k);
    const bool is_kept = place != k || before.is_duration(k, segments) || layout.is_parameter(k, segments);
    if (is_kept && place <= static_cast<int>(solution.parameters.size()))
      solution.parameters[static_cast<std::size_t>(place - 1)] = old[static_cast<std::size_t>(k - 1)];
  }
  for (int& k : solution.free_parameters) k = new_place(k);
  if (solution.kind.kind == UserPointKind::user_value) solution.kind.index = new_place(solution.kind.index);
  for (UserPointKind& kind : solution.further)
    if (kind.kind == UserPointKind::user_value) kind.index = new_place(kind.index);
  return solution;
}

double stored_parameter(const LabelledSolution& solution, int k) {
  const auto index = static_cast<std::size_t>(k - 1);
  return index < solution.parameters.size() ? solution.parameters[index] : 0.0;
}

double duration(const LabelledSolution& solution, int s) {
  const bool old_file = !records_problem_type(solution.problem_type);
  const double own = stored_parameter(solution, solution.layout.duration(s));
  const bool of_auto = is_shared_problem_type(solution.problem_type) && own == 0.0;
  if ((is_own_problem_type(solution.problem_type) && !of_auto) || (old_file && own != 0.0)) return own;
  const std::optional<int> k = auto_period(solution.problem_type);
  const double period = k ? stored_parameter(solution, *k) : 0.0;
  return period > 0.0 ? period : 1.0;
}

double period(const LabelledSolution& solution) {
  if (solution.tau.size() < 2) return 0.0;
  double sum = 0.0;
  for (int s = 0; s < segment_count(solution); ++s) sum += duration(solution, s);
  return sum;
}

}  // namespace tchat
