#include "maps/grazing_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/point_file.hpp"
#include "files/solution_file_reader.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/orbit_pieces.hpp"
#include "resegment/signature_match.hpp"
#include "run/orbit_start.hpp"
#include "settings/settings_type.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Of the period: segments that last less are those of an impact of velocity zero.
constexpr double no_time = level::tolerance;

Orbit orbit_at(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
               const std::string& source) {
  const auto segments = static_cast<int>(settings.segments.size());
  return orbit_from_solution(in_layout(solution, system.layout()), stored_shape(solution, settings.dimension, segments),
                             {}, source)
      .orbit;
}

const IndexVector& index_of(const RunSettings& settings, int s) {
  return settings.segments[static_cast<std::size_t>(s)].index;
}

void require_one_contact(const ContactPoint& contact, const Orbit& x, const HybridSystem& system,
                         const RunSettings& settings, const std::string& source) {
  const std::vector<ContactPoint> all = simultaneous_contacts(contact, x, system, settings);
  if (all.size() < 2) return;
  std::string list;
  for (const ContactPoint& other : all)
    list += fmt::format("{}event {} ({}) on segment {} at tau = {:.6g}", list.empty() ? "" : "; ", other.event,
                        system.function_name(FunctionKind::event, other.event), other.segment + 1, other.tau);
  throw UserError(fmt::format(
      "{}: the orbit is in contact at {} places at once ({}): each impact meets the others before the orbit returns, "
      "and the map of one contact does not tell what becomes of it; choose a label with one contact",
      source, all.size(), list));
}

int named_parameter(const RunSettings& settings, const HybridSystem& system, int given, const std::string& source) {
  if (given > 0) return given;
  if (!settings.conserved.empty())
    throw UserError(
        fmt::format("{}: the orbit belongs to a family of CONSERVED = {}, along which no parameter changes, and the "
                    "expansion near grazing needs one; `tchat resegment --to impacting` continues the family, "
                    "or choose a parameter with --parameter",
                    source, settings.conserved));
  for (const int k : settings.free_parameters)
    if (k >= 1 && k <= system.parameters()) return k;
  if (system.parameters() > 0) return 1;
  throw UserError(
      fmt::format("{}: {} has no parameter that could move the orbit to its contact", source, system.name()));
}

/// The turn from x*: segments after the contact, those of no duration left out, and the way to the contact.
void cut(const Orbit& x, const RunSettings& settings, const ContactPoint& contact, ContactTurn& turn) {
  const int m = x.shape.segments;
  const double period = x.period();
  const auto add = [&](const IndexVector& index, double duration) {
    if (duration <= no_time * period) return;
    turn.segments.push_back(index);
    turn.durations.push_back(duration);
  };
  const int s = contact.segment;
  const bool inside = contact.where == ContactPoint::inside;
  if (inside) add(index_of(settings, s), (1.0 - contact.tau) * x.duration(s));
  for (int i = 1; i < m; ++i) add(index_of(settings, (s + i) % m), x.duration((s + i) % m));
  turn.segments.push_back({turn.contact.field, turn.contact.event, no_function});
  turn.durations.push_back(inside ? contact.tau * x.duration(s) : x.duration(s));
}

/// Surfaces behind which another field holds: contact brings no jump, and has another local map.
void require_jump(const HybridSystem& system, const ContactTurn& turn, const std::string& source) {
  if (turn.contact.jump > system.count(FunctionKind::jump))
    throw UserError(
        fmt::format("{}: contact with event {} ({}) brings jump {}, but problem {} has {} jumps: give it the jump "
                    "of an impact, and name it with --jump or GRJUMP",
                    source, turn.contact.event, system.function_name(FunctionKind::event, turn.contact.event),
                    turn.contact.jump, system.name(), system.count(FunctionKind::jump)));
  if (!is_identity_jump(system, turn.contact)) return;
  throw UserError(fmt::format(
      "{}: contact with event {} ({}) brings jump {} ({}), the identity: there is no discontinuity map of an impact "
      "(behind a surface where another field holds contact changes the motion in another way); name the jump of an "
      "impact with --jump, or GRJUMP in the constants",
      source, turn.contact.event, system.function_name(FunctionKind::event, turn.contact.event), turn.contact.jump,
      system.function_name(FunctionKind::jump, turn.contact.jump)));
}

}  // namespace

ContactTurn contact_turn(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                         std::optional<int> jump, int parameter, const std::string& source) {
  const Orbit x = orbit_at(solution, settings, system, source);
  const ContactPoint contact = contact_point(solution, x, system, settings, source);
  require_one_contact(contact, x, system, settings, source);
  ContactTurn turn;
  const IndexVector& own = index_of(settings, contact.segment);
  const int brought = jump                                    ? *jump
                      : contact.where == ContactPoint::impact ? own.jump
                                                              : jump_at_contact(system, settings, x, contact);
  turn.contact = {own.field, contact.event, brought};
  turn.par = x.par;
  turn.par.clear_durations();
  turn.x = state_at(x, CollocationRule(x.shape.collocation), contact.segment,
                    contact.where == ContactPoint::inside ? contact.tau : 1.0);
  if (contact.where == ContactPoint::section || contact.where == ContactPoint::grazing_curve)
    turn.section_jump = own.jump;
  turn.parameter = named_parameter(settings, system, parameter, source);
  require_jump(system, turn, source);
  turn.aftermath = segments_after_impact(system, turn.contact, turn.x, turn.par, own.field);
  cut(x, settings, contact, turn);
  return turn;
}

CrossSection cross_section(const HybridSystem& system, const std::string& text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  const bool is_number = error == std::errc() && stop == end;
  std::string events;
  for (int j = 1; j <= system.count(FunctionKind::event); ++j) {
    const std::string name = system.function_name(FunctionKind::event, j);
    if ((is_number && number == j) || text == name || text == fmt::format("h{}", j)) return {j, 0};
    events += fmt::format("{}{} ({})", j > 1 ? ", " : "", j, name);
  }
  std::string states;
  for (int k = 1; k <= system.dimension(); ++k) {
    if (text == system.state_name(k) || text == fmt::format("U({})", k)) return {0, k};
    states += fmt::format("{}{}", k > 1 ? ", " : "", system.state_name(k));
  }
  throw UserError(fmt::format(
      "--section {}: {} has no such event function or state; give the number or name of an event function ({}) or the "
      "name of a state that is constant on the section ({})",
      text, system.name(), events, states));
}

std::optional<CrossSection> own_section(const RunSettings& settings, const HybridSystem& system,
                                        const GrazingPoint& point) {
  constexpr double on_it = level::located;
  const VectorXd sizes = sizes_at(system, point.field, point.x, point.par);
  constexpr double parallel = level::orbit;
  for (const SegmentSettings& segment : settings.segments) {
    const int j = segment.index.event;
    if (j == no_function || j == point.event || !is_identity_jump(system, segment.index)) continue;
    const EventAt at = event_at(system, j, point.field, point.x.data(), point.par.data());
    if (std::abs(at.h) > on_it * at.scale(point.x.data(), sizes) || std::abs(at.rate()) <= on_it * at.rate_scale(sizes))
      continue;
    const double cosine =
        at.gradient.dot(point.section_gradient) / (at.gradient.norm() * point.section_gradient.norm());
    if (1.0 - std::abs(cosine) > parallel) return CrossSection{j, 0};
  }
  return std::nullopt;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

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
