#include "files/simulation_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/table_writer.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr int column = 24;  // 16 significant digits
constexpr std::size_t segments_in_any_case = 32;

/// Headings without blanks inside, so that they stay one word for each column.
std::vector<std::string> names(const HybridSystem& system, const char* ending) {
  std::vector<std::string> list;
  for (int k = 1; k <= system.dimension(); ++k) {
    list.push_back(system.state_name(k) + ending);
    std::replace(list.back().begin(), list.back().end(), ' ', '_');
  }
  return list;
}

std::string in_columns(const std::vector<std::string>& headings) {
  std::string text;
  for (const std::string& one : headings) text += fmt::format(" {:>{}}", one, column);
  return text;
}

std::string numbers(const Eigen::VectorXd& x) {
  std::string text;
  for (const double value : x) text += fmt::format(" {:{}.15e}", value, column);
  return text;
}

std::string indices(long segment, const IndexVector& index) {
  return fmt::format("{:7} {:3} {:3} {:3}", segment, index.field, index.event, index.jump);
}

/// Of an unfinished segment only the field is known.
IndexVector index_of(const SimulatedSegment& segment) {
  if (segment.index.field != 0) return segment.index;
  return {segment.mode.index_vectors.empty() ? 0 : segment.mode.field(), 0, 0};
}

const char* word(SegmentMark::Kind kind) {
  switch (kind) {
    case SegmentMark::Kind::contact:
      return "contact";
    case SegmentMark::Kind::section:
      return "section";
    case SegmentMark::Kind::violation:
      return "violation";
    default:
      return "beyond";
  }
}

/// What killed simulations of this name have left is removed.
std::unique_ptr<FileLock> lock_simulation(const std::string& name) {
  const std::string trajectory = SimulationFiles::trajectory_path(name);
  auto lock = lock_output(trajectory);
  remove_abandoned({trajectory, SimulationFiles::events_path(name)});
  return lock;
}

}  // namespace

SimulationFiles::SimulationFiles(const HybridSystem& system, const std::string& name, const std::string& heading,
                                 const Eigen::VectorXd& par, std::size_t trajectory_bytes)
    : system_(system),
      par_(par),
      lock_(lock_simulation(name)),
      trajectory_(trajectory_path(name)),
      events_(events_path(name)),
      most_bytes_(trajectory_bytes) {
  const std::vector<std::string> before = names(system, "");
  std::vector<std::string> all = before;
  for (const std::string& after : names(system, "_after")) all.push_back(after);
  const auto head = [&](const std::vector<std::string>& given) {
    std::string text = fmt::format("# {}\n#segment", heading);
    for (const char* const index : {"i", "j", "k"}) text += fmt::format(" {:>3}", own_heading(index, given));
    return text;
  };
  trajectory_.write(head(before) + in_columns({own_heading("t", before)}) + in_columns(before) + "\n");
  events_.write(head(all) + in_columns({own_heading("t", all), own_heading("h", all), own_heading("h_x_f", all)}) +
                in_columns(all) + " what\n");
}

void SimulationFiles::write(const SimulatedSegment& segment) {
  std::string rows;
  const std::string head = indices(segment.number, index_of(segment));
  for (const Sample& sample : segment.samples)
    rows += fmt::format("{} {:{}.15e}{}\n", head, sample.time, column, numbers(sample.state));
  write_rows(std::move(rows));

  std::string lines;
  const auto line = [&](const IndexVector& index, double t, double h, double rate, const Eigen::VectorXd& before,
                        const Eigen::VectorXd& after, const std::string& what) {
    lines += fmt::format("{} {:{}.15e} {:{}.15e} {:{}.15e}{}{} {}\n", indices(segment.number, index), t, column, h,
                         column, rate, column, numbers(before), numbers(after), what);
  };
  for (const SegmentMark& mark : segment.marks)
    line({segment.mode.field(), mark.event, 0}, mark.time, mark.h, mark.rate, mark.state, mark.state, word(mark.kind));
  if (segment.ended_by == SegmentEnd::event) {
    std::string what = "event";
    for (const IndexVector& other : segment.simultaneous) what += fmt::format("+{}", other.event);
    line(segment.index, segment.end_time(), system_.event(segment.index.event, segment.end.data(), par_.data()),
         segment.event_velocity, segment.end, segment.after, what);
  }
  events_.write(lines);
}

void SimulationFiles::put_rows(const std::string& rows) {
  if (!is_first_) trajectory_.write("\n");
  trajectory_.write(rows);
  is_first_ = false;
}

void SimulationFiles::write_rows(std::string rows) {
  ++segments_;
  if (most_bytes_ == everything) return put_rows(rows);
  bytes_ += rows.size() + 1;
  last_rows_.push_back(std::move(rows));
  while (bytes_ > most_bytes_ && last_rows_.size() > segments_in_any_case) {
    bytes_ -= last_rows_.front().size() + 1;
    last_rows_.pop_front();
    ++dropped_;
  }
}

void SimulationFiles::finish() {
  for (const std::string& rows : last_rows_) put_rows(rows);
  trajectory_.finish();
  events_.finish();
}

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
