#include "files/dat_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constant_value.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// Reads the file line by line; `rows` holds the numbers of all data rows, one after the other.
class DatReader {
 public:
  static constexpr int one_state = 0;  ///< in the place of a number of segments: an equilibrium

  DatReader(const std::string& path, int dimension, int segments)
      : path_(path),
        dimension_(dimension),
        segments_(segments),
        columns_(1 + std::size_t(dimension) * std::size_t(std::max(segments, 1))) {}

  void read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark of some editors
    while (!text.empty()) {
      const auto end = text.find('\n');
      read_line(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
  }

  void read_line(std::string_view line) {
    ++line_;
    const auto hash = line.find('#');
    if (hash != std::string_view::npos) read_comment(line.substr(hash + 1));
    std::string data(line.substr(0, hash));
    std::replace(data.begin(), data.end(), ',', ' ');
    const auto words = split_words(data);
    if (words.empty()) return;
    if (!header_possible_ || parse_fortran_real(words[0])) read_row(words);
    header_possible_ = false;
  }

  /// The one row of an equilibrium, t left out.
  DatFile point() const {
    if (rows_.empty())
      throw UserError(fmt::format("{}: no row of data; of an equilibrium one line with its {} state{} is needed", path_,
                                  dimension_, dimension_ == 1 ? "" : "s"));
    DatFile file;
    file.parameters = parameters_;
    file.parameter_lines = parameter_lines_;
    file.named_parameters = named_parameters_;
    file.tau = {0.0};
    file.states = Eigen::Map<const Eigen::VectorXd>(rows_.data() + rows_.size() - std::size_t(dimension_), dimension_);
    return file;
  }

  DatFile result() const {
    const std::size_t count = rows_.size() / columns_;
    if (count < 2)
      throw UserError(
          fmt::format("{}: {} of data; at least 2 are needed, from the start of the period to its end, each "
                      "with t and {} states",
                      path_, count == 0 ? "no row" : "only one row", columns_ - 1));
    DatFile file;
    file.parameters = parameters_;
    file.parameter_lines = parameter_lines_;
    file.named_parameters = named_parameters_;
    file.span = rows_[(count - 1) * columns_] - rows_[0];
    if (!std::isfinite(file.span))
      throw UserError(
          fmt::format("{}: t runs from {} to {}, which is too far", path_, rows_[0], rows_[(count - 1) * columns_]));
    if (is_cut()) return data_of_segments();
    file.states.resize(static_cast<Eigen::Index>(columns_ - 1), static_cast<Eigen::Index>(count));
    for (std::size_t row = 0; row < count; ++row) {
      const double* numbers = rows_.data() + row * columns_;
      file.tau.push_back((numbers[0] - rows_[0]) / file.span);
      file.states.col(static_cast<Eigen::Index>(row)) =
          Eigen::Map<const Eigen::VectorXd>(numbers + 1, static_cast<Eigen::Index>(columns_ - 1));
    }
    file.tau.back() = 1.0;
    return file;
  }

 private:
  /// Do the segments follow one another in the rows, as in the table of another program?
  bool is_cut() const { return columns_ == row_of_one_segment() && (segments_ > 1 || !cuts_.empty()); }
  std::size_t row_of_one_segment() const { return 1 + std::size_t(dimension_); }

  /// Are the states of the row that begins there others than those of the row before?
  bool jumps(std::size_t begin) const {
    return !std::equal(rows_.begin() + static_cast<std::ptrdiff_t>(begin) + 1, rows_.end(),
                       rows_.begin() + static_cast<std::ptrdiff_t>(begin - columns_) + 1);
  }

  /// The rows between repeated times, segment after segment. Where the period starts within a segment, its two parts
  /// are joined.
  DatFile data_of_segments() const {
    std::vector<OrbitPart> parts = rows_between_cuts();
    const bool starts_within = parts.size() == std::size_t(segments_) + 1 && closes(parts);
    if (starts_within) {
      parts.front() = joined(parts.back(), parts.front());
      parts.pop_back();
    }
    if (parts.size() != std::size_t(segments_)) refuse_cuts(parts.size());
    DatFile file = data_of_parts(parts);
    file.parameters = parameters_;
    file.parameter_lines = parameter_lines_;
    file.named_parameters = named_parameters_;
    return file;
  }

  /// Is the last state nearer to the first one than a tenth of the range of states?
  bool closes(const std::vector<OrbitPart>& parts) const {
    constexpr double near = 0.1;
    Eigen::VectorXd low = parts.front().states.col(0), high = low;
    for (const OrbitPart& part : parts) {
      low = low.cwiseMin(part.states.rowwise().minCoeff());
      high = high.cwiseMax(part.states.rowwise().maxCoeff());
    }
    const Eigen::VectorXd miss = parts.back().states.rightCols(1) - parts.front().states.col(0);
    return (miss.cwiseAbs() - near * (high - low)).maxCoeff() <= 0.0;
  }

  [[noreturn]] void refuse_cuts(std::size_t parts) const {
    if (cuts_.empty()) refuse_columns(columns_);
    const Cut& first = cuts_.front();
    const double t = rows_[first.row * columns_];
    throw UserError(fmt::format(
        "{}:{}: t = {} repeats t = {} of line {}; t is repeated {} time{}, which makes {} segments of an orbit that "
        "{}; remove one of the two rows, or repeat t at each event of one period and nowhere else",
        path_, first.line, t, t, first.line_before, cuts_.size(), cuts_.size() == 1 ? "" : "s", parts,
        parts == std::size_t(segments_) + 1 ? "does not close" : fmt::format("has {} in the constants", segments_)));
  }

  std::vector<OrbitPart> rows_between_cuts() const {
    std::vector<std::size_t> ends;
    for (const Cut& cut : cuts_) ends.push_back(cut.row);
    ends.push_back(rows_.size() / columns_);
    std::vector<OrbitPart> parts;
    std::size_t row = 0;
    for (const std::size_t end : ends) {
      OrbitPart part{{}, Eigen::MatrixXd(dimension_, static_cast<Eigen::Index>(end - row))};
      for (; row < end; ++row) {
        const double* numbers = rows_.data() + row * columns_;
        part.states.col(static_cast<Eigen::Index>(part.times.size())) =
            Eigen::Map<const Eigen::VectorXd>(numbers + 1, dimension_);
        part.times.push_back(numbers[0]);
      }
      parts.push_back(std::move(part));
    }
    return parts;
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw UserError(fmt::format("{}:{}: {}", path_, line_, message));
  }

  void read_row(const std::vector<std::string_view>& words) {
    if (segments_ == one_state) return read_state(words);
    const std::size_t begin = rows_.size();
    for (const std::string_view word : words) rows_.push_back(number(word));
    if (begin == 0 && words.size() == row_of_one_segment()) columns_ = words.size();
    if (words.size() != columns_) refuse_columns(words.size());
    const bool repeats = begin > 0 && rows_[begin] == rows_[begin - columns_];
    if (repeats && columns_ == row_of_one_segment() && (segments_ > 1 || jumps(begin)))
      cuts_.push_back({begin / columns_, line_, last_row_line_});
    else if (begin > 0 && !(rows_[begin] > rows_[begin - columns_]))
      refuse_time(rows_[begin], rows_[begin - columns_]);
    last_row_line_ = line_;
  }

  void read_state(const std::vector<std::string_view>& words) {
    if (!rows_.empty())
      refuse(
          fmt::format("a second row, after that of line {}: an equilibrium is one line with its states; these are the "
                      "data of an orbit, or the constants should have another IPS",
                      last_row_line_));
    for (const std::string_view word : words) rows_.push_back(number(word));
    const std::size_t n = std::size_t(dimension_);
    if (words.size() != n && words.size() != n + 1)
      refuse(fmt::format("found {} number{}, expected the {} state{} of an equilibrium, with or without t before them",
                         words.size(), words.size() == 1 ? "" : "s", n, n == 1 ? "" : "s"));
    last_row_line_ = line_;
  }

  double number(std::string_view word) const {
    const auto value = parse_fortran_real(word);
    if (!value)
      refuse(
          fmt::format("{} is not a finite number; a row is t and {} states, such as 0.25 1.0 -3.5E-2; only one header "
                      "line is skipped, other text needs a # before it",
                      in_quotes(word), columns_ - 1));
    return *value;
  }

  void refuse_columns(std::size_t found) const {
    const std::size_t n = static_cast<std::size_t>(dimension_);
    const std::string guess =
        found > 1 && (found - 1) % n == 0
            ? fmt::format("; the file seems to hold {} segment{}: the constants must say so, or the file be cut anew",
                          (found - 1) / n, (found - 1) / n == 1 ? "" : "s")
            : "; the dimension, the number of segments or the file is wrong";
    refuse(fmt::format("found {} number{}, expected 1 + n m = {}: t and {} state{} of {} segment{} (n = {}, m = {}){}",
                       found, found == 1 ? "" : "s", 1 + n * std::size_t(segments_), dimension_,
                       dimension_ == 1 ? "" : "s", segments_, segments_ == 1 ? "" : "s", dimension_, segments_, guess));
  }

  void refuse_time(double t, double before) const {
    refuse(fmt::format("t = {} {} t = {} of line {}; t must rise from row to row: {}", t,
                       t == before ? "repeats" : "falls below", before, last_row_line_,
                       t == before ? "remove one of the two rows" : "sort the rows; all segments share one t"));
  }

  /// `PAR(k) = v` and nothing but further ones; comments that say anything else are left alone.
  void read_comment(std::string_view comment) {
    comment = trimmed(comment);
    while (comment.starts_with("PAR(") || comment.starts_with("par(")) {
      const auto close = comment.find(')');
      if (close == std::string_view::npos) return;
      const std::string_view name = trimmed(comment.substr(4, close - 4));
      std::string_view rest = trimmed(comment.substr(close + 1));
      if (rest.empty() || rest[0] != '=') return;
      rest = trimmed(rest.substr(1));
      const auto end = std::min(rest.find_first_of(", \t"), rest.size());
      const auto value = parse_fortran_real(rest.substr(0, end));
      if (!value)
        refuse(fmt::format("PAR({}) = {}: not a finite number; a value is given as `# PAR(2) = 0.8`", name,
                           in_quotes(rest.substr(0, end))));
      store(name, *value);
      const auto next = rest.find_first_not_of(", \t", end);
      comment = next == std::string_view::npos ? std::string_view() : rest.substr(next);
    }
  }

  void store(std::string_view name, double value) {
    const bool is_index = !name.empty() && name.find_first_not_of("+-0123456789") == std::string_view::npos;
    if (!is_index && !name.empty()) {
      named_parameters_.emplace_back(std::string(name), value);
      return;
    }
    const auto index = parse_integer(name);
    if (!index || *index < 1 || *index > most_parameters + max_segments)
      refuse(fmt::format("PAR({}): an index from 1 on or a parameter's name is needed, as in `# PAR(2) = 0.8`", name));
    parameters_.emplace_back(*index, value);
    parameter_lines_.push_back(line_);
  }

  /// A row at which t repeats.
  struct Cut {
    std::size_t row = 0;
    int line = 0, line_before = 0;
  };

  std::string path_;
  int dimension_;
  int segments_;
  std::size_t columns_;
  int line_ = 0;
  int last_row_line_ = 0;
  bool header_possible_ = true;
  std::vector<double> rows_;
  std::vector<Cut> cuts_;
  std::vector<std::pair<int, double>> parameters_;
  std::vector<long> parameter_lines_;
  std::vector<std::pair<std::string, double>> named_parameters_;
};

}  // namespace

DatFile parse_dat_file(std::string_view text, const std::string& path, int dimension, int segments) {
  DatReader reader(path, dimension, segments);
  reader.read(text);
  return reader.result();
}

DatFile parse_point_dat_file(std::string_view text, const std::string& path, int dimension) {
  DatReader reader(path, dimension, DatReader::one_state);
  reader.read(text);
  return reader.point();
}

DatFile read_point_dat_file(const std::string& path, int dimension) {
  const std::string cure = "of an equilibrium: one line with its states, with or without t before them";
  return parse_point_dat_file(read_text_file(path, "starting data", cure), path, dimension);
}

DatFile read_dat_file(const std::string& path, int dimension, int segments) {
  const std::string cure =
      "a row of it is t and the states of all segments; `tchat new` and `tchat simulate` write one";
  return parse_dat_file(read_text_file(path, "starting data", cure), path, dimension, segments);
}

namespace {

/// Times nearer to each other than this share of a segment are one.
constexpr double same_time = level::negligible;

double relative_time(const OrbitPart& part, std::size_t row) {
  return (part.times[row] - part.times.front()) / part.duration();
}

std::vector<double> relative_times(const std::vector<OrbitPart>& parts) {
  std::vector<double> all{0.0, 1.0};
  for (const OrbitPart& part : parts)
    for (std::size_t k = 0; part.duration() > 0.0 && k < part.times.size(); ++k) all.push_back(relative_time(part, k));
  std::sort(all.begin(), all.end());
  const auto is_same = [](double a, double b) { return b - a <= same_time; };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  all.back() = 1.0;
  return all;
}

Eigen::VectorXd state_at(const OrbitPart& part, double tau) {
  const double t = part.times.front() + tau * part.duration();
  const auto after = std::upper_bound(part.times.begin(), part.times.end(), t);
  if (after == part.times.begin()) return part.states.col(0);
  if (after == part.times.end()) return part.states.rightCols(1);
  const auto k = static_cast<Eigen::Index>(after - part.times.begin());
  const double left = part.times[static_cast<std::size_t>(k) - 1];
  const double share = (t - left) / (*after - left);
  return (1.0 - share) * part.states.col(k - 1) + share * part.states.col(k);
}

}  // namespace

OrbitPart joined(const OrbitPart& first, const OrbitPart& second) {
  OrbitPart result = first;
  const double shift = first.times.back() - second.times.front();
  for (std::size_t k = 1; k < second.times.size(); ++k) result.times.push_back(second.times[k] + shift);
  const Eigen::Index n = first.states.rows();
  result.states.conservativeResize(n, static_cast<Eigen::Index>(result.times.size()));
  result.states.rightCols(second.states.cols() - 1) = second.states.rightCols(second.states.cols() - 1);
  return result;
}

DatFile data_of_parts(const std::vector<OrbitPart>& parts) {
  const Eigen::Index n = parts.front().states.rows();
  DatFile data;
  data.tau = relative_times(parts);
  data.states.resize(n * static_cast<Eigen::Index>(parts.size()), static_cast<Eigen::Index>(data.tau.size()));
  data.span = 0.0;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    data.span += parts[s].duration();
    data.durations.push_back(parts[s].duration());
    for (std::size_t k = 0; k < data.tau.size(); ++k)
      data.states.col(static_cast<Eigen::Index>(k)).segment(n * static_cast<Eigen::Index>(s), n) =
          state_at(parts[s], data.tau[k]);
  }
  return data;
}

ParameterVector initial_parameters(const HybridSystem& system) {
  ParameterVector par(system.layout());
  if (system.table().initial_parameters != nullptr)
    for (int i = 0; i < system.parameters(); ++i) par(i) = system.table().initial_parameters[i];
  return par;
}

std::vector<std::pair<int, double>> given_parameters(const DatFile& data, const HybridSystem& system,
                                                     const std::string& path, const ParameterVector& par) {
  std::vector<std::pair<int, double>> given = data.parameters;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const int k = given[i].first; k > par.size())
      throw UserError(fmt::format(
          "{}:{}: PAR({}) is neither a parameter of problem {}, which has {}, nor a duration of its segments, "
          "PAR({}), ...",
          path, data.parameter_lines[i], k, system.name(), system.parameters(), par.layout().first_duration()));
  for (const auto& [name, value] : data.named_parameters)
    given.emplace_back(parameter_index(system, name, path), value);
  return given;
}

std::string parameter_lines(const HybridSystem& system, const Eigen::VectorXd& par) {
  std::string text;
  for (int k = 1; k < system.layout().first_duration(); ++k)
    if (k <= system.parameters() || par(k - 1) != 0.0) text += fmt::format("# PAR({}) = {}\n", k, par(k - 1));
  return text;
}

bool apply_command_line(const HybridSystem& system, const RunSettings& settings, ParameterVector& par) {
  bool changed = false;
  const int segments = segment_count(settings);
  if (par.size() < par.layout().room(segments)) par.make_room(segments);  // a value may be that of a duration
  for (const RunSettings::ParameterValue& value : settings.parameter_values) {
    double& target = par(parameter_index(system, value.name, "command line") - 1);
    changed = changed || target != value.value;
    target = value.value;
  }
  return changed;
}

}  // namespace tchat
