#include "files/trajectory_rows.hpp"

#include <fmt/format.h>

#include <optional>
#include <sstream>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

/// The line that names the columns.
struct Heading {
  std::vector<std::string> states;
  std::size_t before_states;  ///< columns; the last one is t
  bool has_index_vectors() const { return before_states == 5; }
};

/// "#segment i j k t x1 ..." of `tchat simulate`, or "#seg tau t x1 ..." of `tchat orbit`; nothing for other lines.
std::optional<Heading> heading_in(const std::string& line) {
  const auto names = split_words(line);
  if (names.empty()) return std::nullopt;
  const std::size_t before = names.front() == "#segment" ? 5 : names.front() == "#seg" ? 3 : 0;
  if (before == 0 || names.back() == "what") return std::nullopt;
  Heading heading{{}, before};
  for (std::size_t k = before; k < names.size(); ++k) heading.states.emplace_back(names[k]);
  return heading;
}

/// The values of "# LinearOscillator with alpha = 3, omega = 2", or of "# alpha = 3", by their names.
std::vector<std::pair<std::string, double>> parameters_of(const std::string& heading) {
  constexpr std::string_view with = " with ", equals = " = ";
  const std::size_t begin = heading.find(with);
  std::string_view rest = std::string_view(heading).substr(begin == std::string::npos ? 1 : begin + with.size());
  std::vector<std::pair<std::string, double>> values;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view item = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t at = item.find(equals);
    const auto value = at == std::string_view::npos ? std::nullopt : parse_real(item.substr(at + equals.size()));
    if (value) values.emplace_back(std::string(item.substr(0, at)), *value);
  }
  return values;
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw UserError(
      fmt::format("{}:{}: {}; give a NAME.trajectory that tchat simulate has written, or what tchat orbit prints", path,
                  line, what));
}

/// Rows while a segment is read.
struct Rows {
  IndexVector index{no_function, no_function, no_function};
  std::vector<double> times;
  std::vector<std::vector<double>> states;
};

RecordedRows recorded(const Rows& rows, Eigen::Index n) {
  RecordedRows segment{rows.index, rows.times, Eigen::MatrixXd(n, static_cast<Eigen::Index>(rows.times.size()))};
  for (std::size_t k = 0; k < rows.times.size(); ++k)
    segment.states.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(rows.states[k].data(), n);
  return segment;
}

}  // namespace

std::optional<int> unnamed_parameter(const std::string& name) {
  if (!name.starts_with("PAR(") || !name.ends_with(')')) return std::nullopt;
  return parse_integer(name.substr(4, name.size() - 5));
}

bool looks_like_trajectory(const std::string& path) {
  TextLines file(path, "something to draw");
  for (std::string line; file.next(line) && line.starts_with('#');)
    if (heading_in(line)) return true;
  return false;
}

TrajectoryRows read_trajectory_rows(const std::string& path) {
  std::istringstream in(read_text_file(path, "a trajectory", "tchat simulate writes it"));
  TrajectoryRows file;
  std::string line;
  std::optional<Heading> heading;
  int number = 1;
  for (; !heading && std::getline(in, line) && line.starts_with('#'); ++number) {
    for (auto& parameter : parameters_of(line)) file.parameters.push_back(std::move(parameter));
    heading = heading_in(line);
  }
  if (!heading) refuse(path, number, "no heading #segment or #seg");
  if (heading->states.empty()) refuse(path, number - 1, "no states in the heading");
  file.states = heading->states;

  const std::size_t n = file.states.size();
  const std::size_t columns = heading->before_states + n;
  Rows rows;
  const auto end_segment = [&] {
    if (!rows.times.empty()) file.segments.push_back(recorded(rows, static_cast<Eigen::Index>(n)));
    rows = {};
  };
  std::string segment;
  for (; std::getline(in, line); ++number) {
    const auto words = split_words(line);
    if (words.empty() || words.front() != segment) end_segment();
    if (words.empty()) continue;
    segment = words.front();
    if (words.size() != columns)
      refuse(path, number, fmt::format("found {} numbers, expected {}", words.size(), columns));
    if (heading->has_index_vectors()) {
      const auto at = [&](std::size_t k) { return parse_integer(words[k]).value_or(no_function); };
      rows.index = {at(1), at(2), at(3)};
    }
    std::vector<double> values;
    for (std::size_t k = heading->before_states - 1; k < words.size(); ++k) {
      const auto value = parse_real(words[k]);
      if (!value) refuse(path, number, fmt::format("found '{}', expected a number", words[k]));
      values.push_back(*value);
    }
    rows.times.push_back(values.front());
    rows.states.emplace_back(values.begin() + 1, values.end());
  }
  end_segment();
  if (file.segments.empty())
    throw UserError(fmt::format("{}: there are no rows in it; simulate with --rows 200", path));
  return file;
}

}  // namespace tchat
