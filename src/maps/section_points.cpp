#include "maps/section_points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/point_file.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* cure =
    "give O.events of `tchat simulate` without contact, or O.sweep, or a label as q.NAME:LABEL";

struct Row {
  int field = 1, event = 0;
  VectorXd state;
};

MatrixXd columns(const std::vector<Row>& rows, int event, Index n) {
  std::vector<const Row*> chosen;
  for (const Row& row : rows)
    if (row.event == event) chosen.push_back(&row);
  MatrixXd states(n, static_cast<Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) states.col(static_cast<Index>(k)) = chosen[k]->state;
  return states;
}

std::vector<SectionPoints> of_each_event(const HybridSystem& system, const std::vector<Row>& rows,
                                         const std::string& path, int event) {
  std::vector<SectionPoints> all;
  std::string list;
  for (int j = 1; j <= system.count(FunctionKind::event); ++j) {
    const auto first = std::find_if(rows.begin(), rows.end(), [j](const Row& row) { return row.event == j; });
    if (first == rows.end()) continue;
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", j, system.function_name(FunctionKind::event, j));
    if (event == 0 || event == j) all.push_back({j, first->field, columns(rows, j, system.dimension())});
  }
  if (list.empty()) throw UserError(fmt::format("{}: there is no event in it; {}", path, cure));
  if (all.empty())
    throw UserError(
        fmt::format("{}: there is no point of event function {} ({}) in it, but of {}; name one of them with "
                    "--section, or simulate with that one recorded",
                    path, event, system.function_name(FunctionKind::event, event), list));
  return all;
}

/// segment i j k t h h_x_f, the states before, the states after, what.
std::vector<Row> event_rows(const HybridSystem& system, const std::string& text, const std::string& path) {
  const int n = system.dimension();
  std::vector<Row> rows;
  std::size_t begin = 0;
  for (int number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string_view> words = split_words(line);
    const auto fault = [&](const std::string& what) {
      return UserError(fmt::format("{}:{}: {}; {}", path, number, what, cure));
    };
    if (words.size() != static_cast<std::size_t>(8 + 2 * n))
      throw fault(fmt::format("{} columns where O.events of {} states has {}", words.size(), n, 8 + 2 * n));
    const std::string_view what = words.back();
    if (!what.starts_with("event") && what != "section") continue;
    Row row{1, 0, VectorXd(n)};
    const auto field = parse_integer(words[1]), event = parse_integer(words[2]);
    if (!field || !event) throw fault("columns 2 and 3 are no numbers of a field and an event function");
    row.field = *field, row.event = *event;
    if (row.event < 1 || row.event > system.count(FunctionKind::event) || row.field < 1 ||
        row.field > system.count(FunctionKind::field))
      throw fault(fmt::format(
          "field {} and event function {}, but {} has {} and {} of them: the file is of another "
          "problem",
          row.field, row.event, system.name(), system.count(FunctionKind::field), system.count(FunctionKind::event)));
    for (int k = 0; k < n; ++k) {
      const auto value = parse_real(words[static_cast<std::size_t>(7 + k)]);
      if (!value) throw fault(fmt::format("'{}' is no finite number", words[static_cast<std::size_t>(7 + k)]));
      row.state(k) = *value;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<SectionPoints> of_sweep(const HybridSystem& system, const std::string& path, int event) {
  const SweepTable table = read_sweep_file(path);
  const auto* index = table.column("index");
  if (index != nullptr && std::any_of(index->begin(), index->end(), [&](double i) { return i != index->front(); }))
    throw UserError(
        fmt::format("{}: it has section points of several values; a torus is one value's: sweep one, as "
                    "--over mu=5:5:1",
                    path));
  std::vector<Row> rows(table.rows());
  for (Row& row : rows) row.state.resize(system.dimension());
  const std::vector<std::string> states = ProblemNames::of(system).states;
  for (int k = 1; k <= system.dimension(); ++k) {
    const auto* column = table.state(k, states);
    if (column == nullptr)
      throw UserError(fmt::format("{}: it has not one column for each of {}; record states with --section", path,
                                  fmt::join(states, ", ")));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].state(k - 1) = (*column)[i];
  }
  if (const auto* events = table.column("event"))
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].event = static_cast<int>((*events)[i]);
  else if (event == 0)
    throw UserError(
        fmt::format("{}: it does not tell at which event its states were recorded; say so with --section", path));
  else
    for (Row& row : rows) row.event = event;
  return of_each_event(system, rows, path, event);
}

}  // namespace

std::vector<SectionPoints> read_section_points(const HybridSystem& system, const std::string& path, int event) {
  const std::string text = read_text_file(path, "points of a section", cure);
  if (text.starts_with("# tchat sweep")) return of_sweep(system, path, event);
  return of_each_event(system, event_rows(system, text, path), path, event);
}

}  // namespace tchat
