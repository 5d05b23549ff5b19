#include "simulate/sweep_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "plugin/problem_setup.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

constexpr const char* first_line = "# tchat sweep of ";
constexpr const char* part_line = "# tchat sweep journal";
constexpr long most_values_of_file = 10'000'000;  // parse_overs allows no more

/// Reads the lines of one file; knows where it is for messages.
class SweepReader {
 public:
  explicit SweepReader(const std::string& path)
      : path_(path), text_(read_text_file(path, "sweep", "`tchat sweep` writes O.sweep")) {}

  SweepTable read() {
    std::string_view line;
    if (!next(line)) fault("it is empty");
    if (line.starts_with(part_line))
      throw UserError(
          fmt::format("{}: this is a part of a sweep, or one that has not ended; the same command with "
                      "--gather instead of --part joins parts to O.sweep",
                      path_));
    if (!line.starts_with(first_line)) fault("it does not begin with '# tchat sweep of'");
    table_.problem = line.substr(std::string_view(first_line).size());
    while (next(line) && line.starts_with("#")) read_heading(line.substr(1));
    if (line.empty() || line.starts_with("#")) fault("the line of column names is missing");
    read_names(line);
    while (next(line)) read_row(line);
    return std::move(table_);
  }

 private:
  [[noreturn]] void fault(const std::string& what) const {
    throw UserError(
        fmt::format("{}:{}: {}; give the O.sweep of `tchat sweep`, or make it again", path_, std::max(line_, 1), what));
  }

  bool next(std::string_view& line) {
    if (at_ >= text_.size()) {
      line = {};
      return false;
    }
    const std::size_t end = text_.find('\n', at_);
    ++line_;
    if (end == std::string::npos) fault("the file ends within a line");
    line = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1;
    return true;
  }

  double number(std::string_view word) const {
    double value = 0.0;
    const char* const end = word.data() + word.size();
    if (word.empty() || std::from_chars(word.data(), end, value).ptr != end)
      fault(fmt::format("{} is no number", in_quotes(word)));
    return value;
  }

  /// A whole number that something is counted or found by.
  long whole(std::string_view word, const char* what, long least, long most) const {
    const double value = number(word);
    if (value >= static_cast<double>(least) && value <= static_cast<double>(most) && value == std::floor(value))
      return static_cast<long>(value);
    fault(fmt::format("{} is {}, a whole number from {} to {} is needed", what, in_quotes(word), least, most));
  }

  /// Of the sweep, by its heading.
  long values() const {
    long all = 1;
    for (const SweptQuantity& quantity : table_.over) all *= quantity.count;
    return all;
  }

  /// What follows `key` in a heading line up to the next ", " (or its end); nothing when the key is not there.
  static std::optional<std::string_view> after(std::string_view line, std::string_view key, std::string_view end) {
    const std::size_t at = line.find(key);
    if (at == std::string_view::npos) return std::nullopt;
    const std::string_view rest = line.substr(at + key.size());
    return rest.substr(0, rest.find(end));
  }

  std::string_view needed(std::string_view line, std::string_view key, std::string_view end) const {
    if (const auto found = after(line, key, end)) return *found;
    fault(fmt::format("the heading lacks '{}'", key));
  }

  void read_heading(std::string_view line) {
    if (line.starts_with(" over ")) {
      SweptQuantity quantity;
      quantity.name = needed(line, " over ", " from ");
      quantity.from = number(needed(line, " from ", " to "));
      quantity.to = number(needed(line, " to ", ", "));
      quantity.count = whole(needed(line, ", ", " values"), "the number of values", 1, most_values_of_file / values());
      quantity.is_state = line.ends_with(", initial state");
      table_.over.push_back(quantity);
    } else if (line.starts_with(" PAR ")) {
      table_.parameters.emplace_back(needed(line, " PAR ", " = "), number(needed(line, " = ", "\n")));
    } else if (line.starts_with(" start ")) {
      table_.starts.emplace_back(needed(line, ": ", "\n"));
    } else if (line.starts_with(" attractor ")) {
      read_attractor(line);
    }
  }

  void read_attractor(std::string_view line) {
    SweepAttractor attractor;
    attractor.number = static_cast<int>(
        whole(needed(line, " attractor ", ": "), "the number of an attractor", 1, std::numeric_limits<int>::max()));
    const std::optional<AttractorKind> kind = attractor_kind(std::string(needed(line, ": ", ", ")));
    if (!kind) fault("the kind of an attractor is unknown");
    attractor.kind = *kind;
    if (const auto signature = after(line, "signature ", ", index ")) {
      const std::size_t end = std::min(signature->find(", impacts "), signature->find(", period "));
      attractor.signature = signature->substr(0, end);
    }
    if (const auto impacts = after(line, ", impacts ", ", "))
      attractor.impacts =
          static_cast<int>(whole(*impacts, "the number of impacts", 0, std::numeric_limits<int>::max()));
    const auto period = after(line, ", period ", ", ");
    attractor.period = period ? number(*period) : std::numeric_limits<double>::quiet_NaN();
    attractor.index =
        static_cast<std::size_t>(whole(needed(line, ", index ", ", "), "the index of an attractor", 0, values() - 1));
    if (const auto mode = after(line, ", mode ", ", ")) attractor.mode = *mode;
    if (const auto state = after(line, ", state ", "\n")) {
      std::vector<double> values;
      for (std::string_view rest = *state; !rest.empty();) {
        const std::size_t end = rest.find(',');
        values.push_back(number(rest.substr(0, end)));
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
      }
      attractor.state = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    }
    table_.attractors.push_back(std::move(attractor));
  }

  void read_names(std::string_view line) {
    for (const std::string_view word : split_words(line)) {
      if (word == "kind")
        kind_ = words_;
      else
        table_.names.emplace_back(word);
      ++words_;
    }
    if (!kind_ || table_.names.empty() || table_.names.front() != "index")
      fault("these are not the columns of a sweep");
    table_.columns.resize(table_.names.size());
  }

  void read_row(std::string_view line) {
    const std::vector<std::string_view> words = split_words(line);
    if (words.size() != words_) fault(fmt::format("there are {} words, the columns are {}", words.size(), words_));
    std::size_t column = 0;
    for (std::size_t i = 0; i < words_; ++i) {
      if (i != *kind_) {
        if (column == 0) whole(words[i], "the index", 0, values() - 1);
        table_.columns[column++].push_back(number(words[i]));
        continue;
      }
      const std::optional<AttractorKind> kind = attractor_kind(std::string(words[i]));
      if (!kind) fault(fmt::format("{} is no kind of an attractor", in_quotes(words[i])));
      table_.kinds.push_back(*kind);
    }
  }

  std::string path_, text_;
  std::size_t at_ = 0;
  int line_ = 0;
  SweepTable table_;
  std::size_t words_ = 0;
  std::optional<std::size_t> kind_;
};

std::string attractor_line(const SweepAttractor& attractor) {
  std::string line = fmt::format("# attractor {}: {}", attractor.number, to_string(attractor.kind));
  if (!attractor.signature.empty()) line += ", signature " + attractor.signature;
  if (attractor.impacts >= 0) line += fmt::format(", impacts {}", attractor.impacts);
  if (std::isfinite(attractor.period)) line += fmt::format(", period {}", attractor.period);
  line += fmt::format(", index {}", attractor.index);
  if (!attractor.mode.empty()) line += ", mode " + attractor.mode;
  if (attractor.state.size() > 0)
    line += fmt::format(", state {}", fmt::join(attractor.state.begin(), attractor.state.end(), ","));
  return line + "\n";
}

}  // namespace

std::string sweep_column(std::string name) {
  for (char& c : name)
    if (c == ' ' || c == '\t' || c == '#') c = '_';
  return name;
}

std::string largest_value_column(const std::string& state) { return "max(" + state + ")"; }

bool is_largest_value_column(const std::string& column) { return column.starts_with("max(") && column.ends_with(')'); }

double SweptQuantity::value(long i) const {
  if (i <= 0 || count <= 1) return from;
  if (i >= count - 1) return to;
  return from + (to - from) * (static_cast<double>(i) / static_cast<double>(count - 1));
}

const std::vector<double>* SweepTable::column(const std::string& name) const {
  const std::string wanted = sweep_column(name);
  for (std::size_t k = 0; k < names.size() && k < columns.size(); ++k)
    if (names[k] == wanted) return &columns[k];
  return nullptr;
}

const std::vector<double>* SweepTable::state(int k, const std::vector<std::string>& state_names) const {
  const auto index = static_cast<std::size_t>(k) - 1;
  const std::size_t before = columns.size() - std::min(columns.size(), state_names.size());
  const auto is_state = [](const std::string& heading, const std::string& name) {
    return heading == sweep_column(name);
  };
  if (std::equal(names.begin() + static_cast<std::ptrdiff_t>(before), names.end(), state_names.begin(),
                 state_names.end(), is_state))
    return &columns[before + index];
  const std::string wanted = sweep_column(state_names[index]);
  return std::count(names.begin(), names.end(), wanted) == 1 ? column(state_names[index]) : nullptr;
}

std::string sweep_heading(const SweepTable& table) {
  std::string text = fmt::format("{}{}\n", first_line, table.problem);
  for (const SweptQuantity& q : table.over)
    text += fmt::format("# over {} from {} to {}, {} values{}\n", q.name, q.from, q.to, q.count,
                        q.is_state ? ", initial state" : "");
  for (const auto& [name, value] : table.parameters) text += fmt::format("# PAR {} = {}\n", name, value);
  for (std::size_t s = 0; s < table.starts.size(); ++s) text += fmt::format("# start {}: {}\n", s + 1, table.starts[s]);
  for (const SweepAttractor& attractor : table.attractors) text += attractor_line(attractor);
  return text;
}

SweepTable read_sweep_file(const std::string& path) { return SweepReader(path).read(); }

namespace {

constexpr double most_values = 1e7;

[[noreturn]] void refuse_over(const std::string& text, const std::string& what) {
  throw UserError(fmt::format("--over {}: {}; an example is --over mu=-0.82:-0.79:301", text, what));
}

double read_end(const std::string& word, const char* which, const std::string& text) {
  if (const std::optional<double> value = parse_real(word)) return *value;
  refuse_over(text, fmt::format("{} '{}' is no finite number", which, word));
}

/// Index of the state of this name; nothing when there is none.
std::optional<int> find_state(const HybridSystem& system, const std::string& name) {
  for (int k = 1; k <= system.dimension(); ++k)
    if (name == system.state_name(k) || name == fmt::format("U({})", k)) return k;
  return std::nullopt;
}

}  // namespace

std::string bare_name(const std::string& name) {
  const bool is_par = (name.starts_with("PAR(") || name.starts_with("par(")) && name.ends_with(")");
  return is_par ? name.substr(4, name.size() - 5) : name;
}

SweepTarget parse_over(const HybridSystem& system, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::string range = equals == std::string::npos ? "" : text.substr(equals + 1);
  const std::size_t first = range.find(':');
  const std::size_t second = first == std::string::npos ? first : range.find(':', first + 1);
  if (equals == std::string::npos || equals == 0 || second == std::string::npos)
    refuse_over(text, "it is not of the form NAME=FROM:TO:COUNT");
  const std::string given = text.substr(0, equals);
  const std::string name = bare_name(given);

  SweepTarget target;
  SweptQuantity& quantity = target.quantity;
  const bool is_parameter = name != given || system.parameter_index(name) > 0;
  const std::optional<int> state = is_parameter ? std::nullopt : find_state(system, name);
  if (state) {
    target.position = *state;
    quantity.name = system.state_name(*state);
    quantity.is_state = true;
  } else {
    std::string states;
    for (int k = 1; k <= system.dimension(); ++k) states += (k > 1 ? ", " : "") + system.state_name(k);
    target.position = parameter_index(system, name, fmt::format("--over {} (states: {})", text, states));
    if (target.position > system.parameters() && target.position >= system.layout().first_duration())
      refuse_over(text, "a duration is no parameter of a simulation");
    quantity.name = system.parameter_name(target.position);
  }
  quantity.from = read_end(range.substr(0, first), "FROM", text);
  quantity.to = read_end(range.substr(first + 1, second - first - 1), "TO", text);
  const std::optional<int> count = parse_integer(range.substr(second + 1));
  if (!count || *count < 1 || *count > most_values)
    refuse_over(text,
                fmt::format("COUNT '{}' is no whole number from 1 to {:g}", range.substr(second + 1), most_values));
  quantity.count = *count;
  if (quantity.count == 1 && quantity.from != quantity.to)
    refuse_over(text, "one value has two ends; give COUNT at least 2, or FROM the same as TO");
  if (quantity.count > 1 && quantity.from == quantity.to)
    refuse_over(text, "FROM and TO are the same; give COUNT 1, or two ends");
  return target;
}

std::vector<SweepTarget> parse_overs(const HybridSystem& system, const std::vector<std::string>& texts) {
  if (texts.empty())
    throw UserError("nothing to sweep over; give --over NAME=FROM:TO:COUNT, as in --over mu=-0.82:-0.79:301");
  if (texts.size() > 2)
    throw UserError(fmt::format("--over is given {} times; a sweep is over one or two quantities", texts.size()));
  std::vector<SweepTarget> targets;
  double values = 1.0;
  for (const std::string& text : texts) {
    targets.push_back(parse_over(system, text));
    values *= static_cast<double>(targets.back().quantity.count);
  }
  if (targets.size() == 2 && targets[0].position == targets[1].position &&
      targets[0].quantity.is_state == targets[1].quantity.is_state)
    throw UserError(
        fmt::format("--over {} and --over {}: the same quantity twice; give two different ones", texts[0], texts[1]));
  if (values > most_values)
    throw UserError(
        fmt::format("a sweep of {:g} values; at most {:g} go into one, cut it into several", values, most_values));
  return targets;
}

void set_swept_values(const std::vector<SweepTarget>& over, const Eigen::VectorXd& values, Eigen::VectorXd& state,
                      Eigen::VectorXd& par) {
  for (std::size_t q = 0; q < over.size(); ++q)
    (over[q].quantity.is_state ? state : par)(over[q].position - 1) = values(static_cast<Eigen::Index>(q));
}

std::size_t SweepGrid::size() const {
  std::size_t size = 1;
  for (const SweptQuantity& quantity : over_) size *= static_cast<std::size_t>(quantity.count);
  return size;
}

Eigen::VectorXd SweepGrid::values(std::size_t index) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(over_.size()));
  for (std::size_t q = 0; q < over_.size(); ++q) {
    const auto count = static_cast<std::size_t>(over_[q].count);
    values(static_cast<Eigen::Index>(q)) = over_[q].value(static_cast<long>(index % count));
    index /= count;
  }
  return values;
}

}  // namespace tchat
