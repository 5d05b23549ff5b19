#include "plot/trajectory_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "constants/constant_value.hpp"
#include "text/number.hpp"
#include "text/text_file.hpp"
#include "text/user_error.hpp"
#include "text/words.hpp"

namespace tchat {

namespace {

constexpr std::size_t columns_before_states = 5;  // segment, i, j, k, t

/// "# LinearOscillator with alpha = 3, omega = 2": the values, PAR(1) first.
std::vector<double> parameters_of(const std::string& heading) {
  std::vector<double> values;
  constexpr std::string_view equals = " = ";
  for (std::size_t at = heading.find(equals); at != std::string::npos; at = heading.find(equals, at + 1)) {
    const std::size_t begin = at + equals.size();
    const auto value = parse_real(heading.substr(begin, heading.find(',', begin) - begin));
    values.push_back(value.value_or(0.0));
  }
  return values;
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw UserError(fmt::format("{}:{}: {}; give a NAME.trajectory that tchat simulate has written", path, line, what));
}

struct Rows {
  std::vector<double> times;
  std::vector<std::vector<double>> states;
};

TraceSegment segment_of(const Rows& rows, Eigen::Index n) {
  TraceSegment segment;
  segment.times = rows.times;
  segment.states.resize(n, static_cast<Eigen::Index>(rows.times.size()));
  for (std::size_t k = 0; k < rows.times.size(); ++k)
    segment.states.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(rows.states[k].data(), n);
  return segment;
}

}  // namespace

bool looks_like_trajectory(const std::string& path) {
  TextLines file(path, "something to draw");
  std::string heading, columns;
  return file.next(heading) && file.next(columns) && columns.starts_with("#segment") && !columns.ends_with(" what");
}

TrajectoryFile read_trajectory_file(const std::string& path) {
  std::istringstream in(read_text_file(path, "a trajectory", "tchat simulate writes it"));
  TrajectoryFile file;
  file.trace.name = std::filesystem::path(path).stem().string();
  file.trace.is_closed = false;
  std::string line;
  std::getline(in, line);
  file.trace.parameters = parameters_of(line);
  if (!std::getline(in, line) || !line.starts_with("#segment")) refuse(path, 2, "no heading #segment");
  const std::string headings = line;
  const auto names = split_words(headings);
  if (names.size() <= columns_before_states) refuse(path, 2, "no states in the heading");
  file.states.assign(names.begin() + columns_before_states, names.end());

  const std::size_t n = file.states.size();
  Rows rows;
  const auto end_segment = [&] {
    if (!rows.times.empty()) file.trace.segments.push_back(segment_of(rows, static_cast<Eigen::Index>(n)));
    rows = {};
  };
  for (int number = 3; std::getline(in, line); ++number) {
    const auto words = split_words(line);
    if (words.empty()) {
      end_segment();
      continue;
    }
    if (words.size() != columns_before_states + n)
      refuse(path, number, fmt::format("found {} numbers, expected {}", words.size(), columns_before_states + n));
    std::vector<double> values;
    for (std::size_t k = columns_before_states - 1; k < words.size(); ++k) {
      const auto value = parse_real(words[k]);
      if (!value) refuse(path, number, fmt::format("found '{}', expected a number", words[k]));
      values.push_back(*value);
    }
    rows.times.push_back(values.front());
    rows.states.emplace_back(values.begin() + 1, values.end());
  }
  end_segment();
  if (file.trace.segments.empty())
    throw UserError(fmt::format("{}: there are no rows in it; simulate with --rows 200", path));
  return file;
}

}  // namespace tchat
