#include "simulate/sweep_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"

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

}  // namespace tchat
