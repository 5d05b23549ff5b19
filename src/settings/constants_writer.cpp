#include "settings/constants_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t commentary_column = 40;
constexpr std::size_t comment_column = 30;

std::string label_text(const StartLabel& label) { return fmt::format("{}{}", label.type, label.number); }

int segment_value(const SegmentSettings& segment, const SegmentInteger& member) {
  return member.own ? segment.*member.own : segment.index.*member.of_index;
}

std::vector<int> segment_values(const RunSettings& settings, const SegmentInteger& member) {
  std::vector<int> values;
  for (const SegmentSettings& segment : settings.segments) values.push_back(segment_value(segment, member));
  return values;
}

std::string list_text(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

/// In quotes where it has one of these characters.
std::string quoted(const std::string& text, const char* characters) {
  return text.find_first_of(characters) == std::string::npos ? text : "\"" + text + "\"";
}

/// The number, or a name, in quotes where it has blanks or commas.
std::string index_text(const RunSettings& settings, int k) {
  if (!is_monitor(settings, k) && !is_name(settings, k)) return std::to_string(k);
  const std::string& name = is_name(settings, k)
                                ? settings.names[static_cast<std::size_t>(k - first_name)].text
                                : settings.monitors[static_cast<std::size_t>(k - first_monitor(settings))];
  return quoted(name, " \t:#=[]{}");
}

std::string written_index(const RunSettings& settings, const UserValue& value) {
  return (value.stop ? "-" : "") + index_text(settings, value.parameter);
}

/// "{1: [2.5, 3], -2: 4}": values with the same index that follow each other share an entry.
std::string user_values_text(const RunSettings& settings) {
  const std::vector<UserValue>& values = settings.user_values;
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < values.size();) {
    std::vector<std::string> same;
    const std::string index = written_index(settings, values[i]);
    for (; i < values.size() && written_index(settings, values[i]) == index; ++i)
      same.push_back(fmt::format("{}", values[i].value));
    entries.push_back(fmt::format("{}: {}", index, same.size() == 1 ? same[0] : list_text(same)));
  }
  return fmt::format("{{{}}}", fmt::join(entries, ", "));
}

/// The value of a constant in keyword form, one overload for each shape.
struct KeywordValue {
  const RunSettings& settings;

  std::string operator()(int RunSettings::*m) const { return fmt::format("{}", settings.*m); }
  std::string operator()(double RunSettings::*m) const { return fmt::format("{}", settings.*m); }
  std::string operator()(bool RunSettings::*m) const { return settings.*m ? "1" : "0"; }
  std::string operator()(std::string RunSettings::*m) const { return quoted(settings.*m, " \t:#=[]{},/"); }
  std::string operator()(StartLabel RunSettings::*m) const { return label_text(settings.*m); }
  std::string operator()(std::vector<int> RunSettings::*m) const {
    if (m != &RunSettings::free_parameters) return fmt::format("[{}]", fmt::join(settings.*m, ", "));
    std::vector<std::string> items;
    for (const int k : settings.*m) items.push_back(index_text(settings, k));
    return list_text(items);
  }
  std::string operator()(std::vector<IndexedValue> RunSettings::*m) const {
    std::vector<std::string> entries;
    for (const IndexedValue& pair : settings.*m)
      entries.push_back(fmt::format("{}: {}", index_text(settings, pair.index), pair.value));
    return fmt::format("{{{}}}", fmt::join(entries, ", "));
  }
  std::string operator()(std::vector<UserValue> RunSettings::*) const { return user_values_text(settings); }
  std::string operator()(std::vector<HeldValue> RunSettings::*m) const {
    const auto valued = [](const HeldValue& held) { return held.value.has_value(); };
    const bool pairs = !(settings.*m).empty() && std::all_of((settings.*m).begin(), (settings.*m).end(), valued);
    std::vector<std::string> items;
    for (const HeldValue& held : settings.*m)
      items.push_back(index_text(settings, held.parameter) + (pairs ? fmt::format(": {}", *held.value) : ""));
    return pairs ? fmt::format("{{{}}}", fmt::join(items, ", ")) : list_text(items);
  }
  std::string operator()(std::vector<BoundedValue> RunSettings::*m) const {
    std::vector<std::string> items;
    for (const BoundedValue& bounded : settings.*m)
      items.push_back(
          fmt::format("{}: [{}, {}]", index_text(settings, bounded.parameter), bounded.least, bounded.most));
    return fmt::format("{{{}}}", fmt::join(items, ", "));
  }
  std::string operator()(std::vector<StopRule> RunSettings::*m) const {
    std::vector<std::string> items;
    for (const StopRule& rule : settings.*m) items.push_back(fmt::format("{}{}", rule.type, rule.count));
    return list_text(items);
  }
  std::string operator()(std::vector<RunSettings::ParameterValue> RunSettings::*) const { return ""; }
  std::string operator()(const ListCount&) const { return ""; }
  std::string operator()(const SegmentCount&) const { return fmt::format("{}", settings.segments.size()); }
  std::string operator()(const SegmentInteger& m) const {
    return fmt::format("[{}]", fmt::join(segment_values(settings, m), ", "));
  }
  std::string operator()(const MonitorCounts&) const { return ""; }
  std::string operator()(const MonitorLists&) const {
    std::vector<std::string> items;
    for (const SegmentSettings& segment : settings.segments)
      items.push_back(fmt::format("[{}]", fmt::join(segment.monitor, ", ")));
    return list_text(items);
  }
};

/// Writes records of the positional form.
class PositionalWriter {
 public:
  explicit PositionalWriter(const RunSettings& settings) : settings_(settings) {}

  std::string text() {
    const auto records = positional_records();
    for (std::size_t r = 0; r < records.size(); ++r) write_record(static_cast<int>(r + 1), records[r].layout);
    for (const Constant* constant : constants_of_record(extension_record))
      if (const std::string value = value_text(*constant, settings_); !value.empty())
        text_ += fmt::format("{} = {}\n", constant->keyword, value);
    return text_;
  }

 private:
  void write_record(int record, std::string_view layout) {
    const std::vector<const Constant*> constants = constants_of_record(record);
    if (std::holds_alternative<MonitorLists>(constants.back()->member)) return write_monitors();
    std::vector<std::string> values;
    for (const Constant* constant : constants) append_values(*constant, values);
    write_line(values, layout);
    for (const std::string& pair : pairs_of(*constants.back())) text_ += pair + "\n";
  }

  void write_line(const std::vector<std::string>& values, std::string_view layout) {
    text_ += fmt::format("{:<{}} {}\n", fmt::format("{}", fmt::join(values, " ")), commentary_column, layout);
  }

  /// What a constant adds to its record's first line.
  void append_values(const Constant& constant, std::vector<std::string>& values) const {
    if (const auto* list = std::get_if<std::vector<int> RunSettings::*>(&constant.member)) {
      const bool indices = *list == &RunSettings::free_parameters;
      for (const int value : settings_.*(*list))
        values.push_back(indices ? index_text(settings_, value) : std::to_string(value));
    } else if (const auto* member = std::get_if<SegmentInteger>(&constant.member)) {
      for (const int value : segment_values(settings_, *member)) values.push_back(std::to_string(value));
    } else if (const auto* count = std::get_if<ListCount>(&constant.member)) {
      values.push_back(std::to_string(list_size(*find_constant(count->list))));
    } else if (!is_pair_list(constant)) {
      values.push_back(value_text(constant, settings_));
    }
  }

  static bool is_pair_list(const Constant& constant) {
    return std::holds_alternative<std::vector<IndexedValue> RunSettings::*>(constant.member) ||
           std::holds_alternative<std::vector<UserValue> RunSettings::*>(constant.member);
  }

  std::size_t list_size(const Constant& constant) const {
    if (const auto* list = std::get_if<std::vector<int> RunSettings::*>(&constant.member))
      return (settings_.*(*list)).size();
    return pairs_of(constant).size();
  }

  std::vector<std::string> pairs_of(const Constant& constant) const {
    std::vector<std::string> lines;
    if (const auto* weights = std::get_if<std::vector<IndexedValue> RunSettings::*>(&constant.member))
      for (const IndexedValue& pair : settings_.*(*weights))
        lines.push_back(fmt::format("{} {}", index_text(settings_, pair.index), pair.value));
    if (const auto* values = std::get_if<std::vector<UserValue> RunSettings::*>(&constant.member))
      for (const UserValue& value : settings_.*(*values))
        lines.push_back(fmt::format("{} {}", written_index(settings_, value), value.value));
    return lines;
  }

  void write_monitors() {
    for (std::size_t s = 0; s < settings_.segments.size(); ++s) {
      const std::vector<int>& monitor = settings_.segments[s].monitor;
      std::vector<std::string> values{std::to_string(monitor.size())};
      for (const int event : monitor) values.push_back(std::to_string(event));
      write_line(values, fmt::format("GCHNO({0}), (GCHGRZIND(I), I=1, GCHNO({0}))", s + 1));
    }
  }

  const RunSettings& settings_;
  std::string text_;
};

}  // namespace

std::string positional_text(const RunSettings& settings) { return PositionalWriter(settings).text(); }

std::string keyword_text(const RunSettings& settings) {
  std::string text;
  for (const Constant& constant : constants_table()) {
    const std::string value = value_text(constant, settings);
    if (value.empty()) continue;
    text +=
        fmt::format("{:<{}} # {}\n", fmt::format("{} = {}", constant.keyword, value), comment_column, constant.meaning);
  }
  return text;
}

std::string value_text(const Constant& constant, const RunSettings& settings) {
  return std::visit(KeywordValue{settings}, constant.member);
}

std::string default_text(const Constant& constant) {
  RunSettings defaults;
  defaults.segments.resize(1);
  return constant.keyword == "ICP" ? "" : value_text(constant, defaults);
}

namespace {

constexpr std::size_t keyword_width = 10;

std::string limits_line(const Constant& constant) {
  const std::string effect = constant.effect.empty() ? "" : fmt::format("; {}", constant.effect);
  return fmt::format("{:{}}   allowed: {}{}\n", "", keyword_width, allowed_text(constant), effect);
}

std::string segment_text(int number, const SegmentSettings& segment, bool ends_in_event) {
  std::string text = fmt::format("  segment {}: field {}", number, segment.index.field);
  if (!ends_in_event) return text + "\n";
  text += segment.index.event == no_function
              ? " for one period, fixed by the integral phase condition"
              : fmt::format(" until event function {} falls to zero{}", segment.index.event,
                            segment.type == 2 ? " in grazing contact (h = 0 and h_x f = 0)" : "");
  text += segment.index.jump == no_function ? ", no jump" : fmt::format(", then jump {}", segment.index.jump);
  if (!segment.monitor.empty())
    text += fmt::format("; watched along it: event functions {}", fmt::join(segment.monitor, ", "));
  return text + "\n";
}

/// The contacts that GCIPSI counts: through the monitored event functions of all segments, in order.
std::string contacts_text(const RunSettings& settings) {
  std::string text;
  int k = 0;
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    for (const int event : settings.segments[s].monitor)
      text += fmt::format("  test function {}: contact with event function {} on segment {}\n", ++k, event, s + 1);
  return text;
}

}  // namespace

std::string constants_guide() {
  std::string text =
      "Constants files gc.NAME hold KEY = value lines (comments with #), what is left out has its default;\n"
      "or the values alone in this order, one record a line. KEY=VALUE on the command line overrides both.\n\n";
  for (const Constant& constant : constants_table()) {
    const std::string value = default_text(constant);
    text += fmt::format("{:<{}} {}{}\n", constant.keyword, keyword_width, constant.meaning,
                        value.empty() ? "" : fmt::format(" (default {})", value));
    text += limits_line(constant);
    text += fmt::format("{:{}}   example: {} = {}\n", "", keyword_width, constant.keyword, constant.example);
  }
  return text;
}

std::string explained_text(const RunSettings& settings) {
  std::string text = "The signature:\n";
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    text += segment_text(static_cast<int>(s + 1), settings.segments[s], signature_rules(settings).ends_in_events);
  const std::string contacts = contacts_text(settings);
  if (!keeps_contact(settings.problem_type) && !contacts.empty()) text += "GCIPSI chooses from these:\n" + contacts;
  text += "\n";
  for (const Constant& constant : constants_table()) {
    const std::string value = value_text(constant, settings);
    if (value.empty()) continue;
    text += fmt::format("{} = {}\n{:{}}   {}\n", constant.keyword, value, "", keyword_width, constant.meaning);
    text += limits_line(constant);
  }
  return text;
}

}  // namespace tchat
