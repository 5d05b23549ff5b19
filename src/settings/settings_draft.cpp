#include "settings/settings_draft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_check.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using Shape = RawValue::Shape;

std::string element(const Constant& constant, std::size_t index) {
  return fmt::format("{}({})", constant.keyword, index + 1);
}

/// The values of a list; a scalar counts as a list of one, empty braces as an empty list.
std::vector<RawValue> items_of(const Constant& constant, const RawValue& value) {
  if (value.shape == Shape::scalar) return {value};
  if (value.shape == Shape::list || value.pairs.empty()) return value.items;
  refuse(constant, std::string(constant.keyword), value.token.place, in_quotes(value.token.text), "a list of values");
}

std::vector<int> integers_of(const Constant& constant, const std::vector<RawValue>& items) {
  std::vector<int> result;
  for (const RawValue& item : items)
    result.push_back(integer_value(constant, element(constant, result.size()), item, constant.limits));
  return result;
}

std::vector<int> integers_of(const Constant& constant, const RawValue& value) {
  return integers_of(constant, items_of(constant, value));
}

bool starts_like_name(std::string_view text) {
  return !text.empty() && (std::isalpha(static_cast<unsigned char>(text.front())) != 0 || text.front() == '_');
}

/// The pairs of a dictionary; an empty list counts as none.
const std::vector<RawPair>& pairs_of(const Constant& constant, const RawValue& value) {
  if (value.shape == Shape::pairs || (value.shape == Shape::list && value.items.empty())) return value.pairs;
  refuse(constant, std::string(constant.keyword), value.token.place, in_quotes(value.token.text),
         "pairs of an index and a value");
}

bool has_parameter_indices(const Constant& constant) {
  return constant.keyword == "ICP" || constant.keyword == "THL" || constant.keyword == "UZR" ||
         constant.keyword == "HOLD" || constant.keyword == "BOUNDS";
}

int pair_index(const Constant& constant, const Token& key) {
  return integer_value(constant, fmt::format("I{}", constant.keyword), RawValue::scalar(key), constant.index_limits);
}

std::string pair_name(const Constant& constant, int index) { return fmt::format("{}({})", constant.keyword, index); }

}  // namespace

/// One overload for each shape of constant.
struct SettingsDraft::Assigner {
  SettingsDraft& draft;
  const Constant& constant;
  const RawValue& value;

  std::string name() const { return std::string(constant.keyword); }
  RunSettings& settings() const { return draft.settings_; }

  void operator()(int RunSettings::*member) const {
    settings().*member = integer_value(constant, name(), value, constant.limits);
  }
  void operator()(double RunSettings::*member) const {
    settings().*member = real_value(constant, name(), value, constant.limits);
  }
  void operator()(bool RunSettings::*member) const {
    settings().*member = integer_value(constant, name(), value, constant.limits) != 0;
  }
  void operator()(std::string RunSettings::*member) const {
    if (value.shape != Shape::scalar) refuse(constant, name(), value.token.place, in_quotes(value.token.text));
    settings().*member = value.token.text;
  }
  void operator()(StartLabel RunSettings::*member) const {
    const auto typed = parse_typed_label(value.token.text);
    if (value.shape == Shape::scalar && typed)
      settings().*member = *typed;
    else
      settings().*member = {"", integer_value(constant, name(), value, constant.limits)};
  }
  void operator()(std::vector<int> RunSettings::*member) const {
    std::vector<RawValue> items = items_of(constant, value);
    for (std::size_t i = 0; i < items.size(); ++i)
      if (items[i].shape == Shape::scalar)
        items[i].token = draft.index_token(constant, element(constant, i), items[i].token);
    settings().*member = integers_of(constant, items);
  }
  void operator()(std::vector<IndexedValue> RunSettings::*member) const {
    std::vector<IndexedValue> result;
    for (const auto& [key, weight] : pairs_of(constant, value)) {
      const int index = pair_index(constant, draft.index_token(constant, "I" + std::string(constant.keyword), key));
      const auto same = [index](const IndexedValue& other) { return other.index == index; };
      if (std::any_of(result.begin(), result.end(), same))
        refuse(constant, pair_name(constant, index), key.place, "the index " + in_quotes(key.text) + " twice",
               "each index once");
      result.push_back({index, real_value(constant, pair_name(constant, index), weight, constant.limits)});
    }
    settings().*member = std::move(result);
  }
  void operator()(std::vector<UserValue> RunSettings::*member) const {
    std::vector<UserValue> result;
    for (const auto& [key, values] : pairs_of(constant, value)) {
      const int index = pair_index(constant, draft.index_token(constant, "I" + std::string(constant.keyword), key));
      for (const RawValue& item : items_of(constant, values))
        result.push_back(
            {std::abs(index), real_value(constant, pair_name(constant, index), item, constant.limits), index < 0});
    }
    settings().*member = std::move(result);
  }
  void operator()(std::vector<StopRule> RunSettings::*member) const {
    std::vector<StopRule> result;
    for (const RawValue& item : items_of(constant, value)) {
      const auto label = item.shape == Shape::scalar ? parse_typed_label(item.token.text) : std::nullopt;
      if (!label) refuse(constant, name(), item.token.place, in_quotes(item.token.text));
      result.push_back({label->type, label->number});
    }
    settings().*member = std::move(result);
  }
  void operator()(std::vector<HeldValue> RunSettings::*member) const {
    std::vector<HeldValue> result;
    const auto add = [&](const Token& key, std::optional<double> held) {
      const Token token = draft.index_token(constant, name(), key);
      const int index = integer_value(constant, name(), RawValue::scalar(token), constant.index_limits);
      const auto same = [index](const HeldValue& other) { return other.parameter == index; };
      if (std::any_of(result.begin(), result.end(), same))
        refuse(constant, name(), key.place, in_quotes(key.text) + " twice", "each name once");
      result.push_back({index, held});
    };
    if (value.shape == Shape::pairs) {
      for (const auto& [key, number] : value.pairs) add(key, real_value(constant, name(), number, constant.limits));
    } else {
      for (const RawValue& item : items_of(constant, value)) add(item.token, std::nullopt);
    }
    settings().*member = std::move(result);
  }
  void operator()(std::vector<BoundedValue> RunSettings::*member) const {
    std::vector<BoundedValue> result;
    for (const auto& [key, range] : pairs_of(constant, value)) {
      const Token token = draft.index_token(constant, name(), key);
      const int index = integer_value(constant, name(), RawValue::scalar(token), constant.index_limits);
      const std::vector<RawValue> ends = items_of(constant, range);
      if (ends.size() != 2)
        refuse(constant, name(), key.place,
               fmt::format("{} for {}", ends.size() == 1 ? "one value" : fmt::format("{} values", ends.size()),
                           in_quotes(key.text)),
               "the least and the largest value, as in {T1: [0, 10]}");
      const auto number = [&](const RawValue& end) { return real_value(constant, name(), end, constant.limits); };
      result.push_back({index, number(ends[0]), number(ends[1])});
      if (result.back().least >= result.back().most)
        refuse(constant, name(), ends[1].token.place, in_quotes(ends[1].token.text),
               fmt::format("a number greater than {}", result.back().least));
    }
    settings().*member = std::move(result);
  }
  void operator()(std::vector<RunSettings::ParameterValue> RunSettings::*) const {
    for (const auto& [key, number] : pairs_of(constant, value)) draft.assign_parameter(constant, key, number);
  }
  void operator()(const ListCount&) const {
    draft.counts_[constant.keyword] = integer_value(constant, name(), value, constant.limits);
  }
  void operator()(const SegmentCount&) const {
    draft.segment_count_ = integer_value(constant, name(), value, constant.limits);
  }
  void operator()(const SegmentInteger&) const { draft.lists_[constant.keyword] = integers_of(constant, value); }
  void operator()(const MonitorCounts&) const { draft.lists_[constant.keyword] = integers_of(constant, value); }
  void operator()(const MonitorLists&) const {
    const bool nested = value.shape == Shape::list && !value.items.empty() &&
                        std::all_of(value.items.begin(), value.items.end(),
                                    [](const RawValue& item) { return item.shape != Shape::scalar; });
    draft.monitors_.reset();
    draft.flat_monitors_.clear();
    if (!nested) {
      draft.flat_monitors_ = integers_of(constant, value);
      return;
    }
    draft.monitors_.emplace();
    for (const RawValue& item : value.items) draft.monitors_->push_back(integers_of(constant, item));
  }
};

SettingsDraft::SettingsDraft(RunSettings base, std::string source)
    : settings_(std::move(base)), source_(std::move(source)) {}

/// A name, which may have the sign of an index, becomes the index that stands for it (RunSettings::names); everything
/// else stays as it is. `shown` is the value in messages, "ICP(2)".
Token SettingsDraft::index_token(const Constant& constant, const std::string& shown, const Token& token) {
  const bool negative = token.text.starts_with('-');
  const std::string name = token.text.substr(negative ? 1 : 0);
  if (!has_parameter_indices(constant)) return token;
  if (!starts_like_name(name)) {
    if (parse_integer(name).value_or(0) > most_parameters + 2 * max_segments)
      refuse(constant, shown, token.place, in_quotes(token.text),
             "1, 2, ... (parameters of the problem, then durations of the segments)");
    return token;
  }
  std::vector<GivenName>& names = settings_.names;
  const auto known = std::find_if(names.begin(), names.end(), [&](const auto& given) { return given.text == name; });
  const auto k = static_cast<std::size_t>(known - names.begin());
  if (k == max_names)
    refuse(constant, shown, token.place, in_quotes(token.text), fmt::format("at most {} different names", max_names));
  if (known == names.end()) names.push_back({name, std::string(constant.keyword), token.place});
  return {fmt::format("{}{}", negative ? "-" : "", name_index(k)), token.place};
}

void SettingsDraft::assign(const Constant& constant, const RawValue& value) {
  std::visit(Assigner{*this, constant, value}, constant.member);
  places_[constant.keyword] = value.token.place;
}

void SettingsDraft::add_monitored(const Constant& constant, const RawValue& list) {
  if (!monitors_) monitors_.emplace();
  monitors_->push_back(integers_of(constant, list));
  places_[constant.keyword] = list.token.place;
}

void SettingsDraft::assign_parameter(const Constant& constant, const Token& name, const RawValue& value) {
  std::string key = name.text;
  if (const auto index = parse_integer(key)) key = std::to_string(*index);
  const double number = real_value(constant, fmt::format("PAR({})", key), value, constant.limits);
  const auto unusable = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
  if (key.empty() || key.size() > 256 || std::any_of(key.begin(), key.end(), unusable))
    refuse(constant, "PAR", name.place, in_quotes(name.text), "an index or a name of a parameter");
  settings_.parameter_values.push_back({key, number});
  places_[constant.keyword] = name.place;
}

Place SettingsDraft::place_of(std::string_view keyword) const {
  const auto found = places_.find(keyword);
  return found == places_.end() ? Place{source_} : found->second;
}

/// Without GCNOSEG the lists of the signature say how many segments there are, so their lengths must agree; a list that
/// is not given is as long as before.
void SettingsDraft::check_lengths_agree() const {
  if (segment_count_) return;
  struct Length {
    std::string_view keyword;
    std::size_t values;
    bool given;
  };
  std::vector<Length> lengths;
  const std::size_t before = settings_.segments.size();
  const bool monitored = std::any_of(settings_.segments.begin(), settings_.segments.end(),
                                     [](const SegmentSettings& segment) { return !segment.monitor.empty(); });
  for (const Constant& constant : constants_table()) {
    const auto* of_segment = std::get_if<SegmentInteger>(&constant.member);
    const bool monitors = std::holds_alternative<MonitorLists>(constant.member);
    const auto list = lists_.find(constant.keyword);
    if (of_segment != nullptr && list != lists_.end())
      lengths.push_back({constant.keyword, list->second.size(), true});
    else if (monitors && monitors_)
      lengths.push_back({constant.keyword, monitors_->size(), true});
    else if (before > 0 && ((of_segment != nullptr && of_segment->of_index != nullptr) ||
                            (monitors && monitored && places_.count(constant.keyword) == 0)))
      lengths.push_back({constant.keyword, before, false});
  }
  const auto first = std::find_if(lengths.begin(), lengths.end(), [](const Length& each) { return each.given; });
  if (first == lengths.end()) return;
  if (std::all_of(lengths.begin(), lengths.end(), [&](const Length& each) { return each.values == first->values; }))
    return;
  std::string found;
  for (const Length& each : lengths)
    found += fmt::format("{}{} has {}{}", found.empty() ? "" : ", ", each.keyword, each.values,
                         each.given ? "" : " (not given here)");
  throw UserError(
      fmt::format("{}: the lists of the signature have different lengths: {}; allowed: one value (GCHGRZIND: one list) "
                  "for each segment in all of them; give those too that are to change",
                  place_of(first->keyword).text(), found));
}

/// GCNOSEG where it is given, else the length of the first list given, else what there was.
int SettingsDraft::settle_segment_count() const {
  if (segment_count_) return *segment_count_;
  for (const Constant& constant : constants_table()) {
    const auto list = lists_.find(constant.keyword);
    if (list != lists_.end()) return static_cast<int>(list->second.size());
  }
  if (monitors_) return static_cast<int>(monitors_->size());
  return std::max<int>(1, static_cast<int>(settings_.segments.size()));
}

/// Of a list that is not given.
int SettingsDraft::missing_value(const SegmentInteger& member) const {
  return member.of_ring && !signature_rules(settings_).ends_in_events ? no_function : 1;
}

void SettingsDraft::settle_segment_integers(const Constant& constant, const SegmentInteger& member) {
  const std::size_t count = settings_.segments.size();
  std::vector<int> values(count, missing_value(member));
  if (const auto list = lists_.find(constant.keyword); list != lists_.end()) values = list->second;
  if (values.size() != count)
    refuse(constant, std::string(constant.keyword), place_of(constant.keyword),
           fmt::format("{} values for {} segments", values.size(), count), "one value for each segment");
  for (std::size_t s = 0; s < count; ++s) {
    SegmentSettings& segment = settings_.segments[s];
    (member.own ? segment.*member.own : segment.index.*member.of_index) = values[s];
  }
}

/// GCHGRZIND as lists of the segments, cut by GCHNO where it came as one list.
SettingsDraft::Lists SettingsDraft::monitors_of_segments(const Constant& constant) const {
  if (monitors_) return *monitors_;
  const std::size_t count = settings_.segments.size();
  const auto lengths = lists_.find("GCHNO");
  if (lengths == lists_.end()) {
    if (count == 1) return {flat_monitors_};
    if (flat_monitors_.empty()) return Lists(count);
    refuse(constant, std::string(constant.keyword), place_of(constant.keyword),
           fmt::format("one list for {} segments", count), "a list for each segment, or one list and GCHNO");
  }
  if (std::reduce(lengths->second.begin(), lengths->second.end()) != static_cast<int>(flat_monitors_.size()))
    refuse(constant, std::string(constant.keyword), place_of(constant.keyword),
           fmt::format("{} values, {} by GCHNO", flat_monitors_.size(),
                       std::reduce(lengths->second.begin(), lengths->second.end())),
           "as many values as GCHNO says");
  Lists result;
  auto next = flat_monitors_.begin();
  for (const int length : lengths->second) {
    result.emplace_back(next, next + length);
    next += length;
  }
  return result;
}

void SettingsDraft::settle_monitors() {
  const Constant& constant = *find_constant("GCHGRZIND");
  const Lists lists = monitors_of_segments(constant);
  if (lists.size() != settings_.segments.size())
    refuse(constant, std::string(constant.keyword), place_of(constant.keyword),
           fmt::format("{} lists for {} segments", lists.size(), settings_.segments.size()), "a list for each segment");
  const Limits& lengths_allowed = find_constant("GCHNO")->limits;
  for (std::size_t s = 0; s < lists.size(); ++s) {
    if (!lengths_allowed.contain(static_cast<double>(lists[s].size())))
      refuse(constant, "GCHGRZIND", place_of("GCHGRZIND"),
             fmt::format("{} values for segment {}", lists[s].size(), s + 1),
             fmt::format("at most {} values", lengths_allowed.highest));
    settings_.segments[s].monitor = lists[s];
  }
  const auto lengths = lists_.find("GCHNO");
  for (std::size_t s = 0; lengths != lists_.end() && s < lists.size(); ++s) {
    const int given = s < lengths->second.size() ? lengths->second[s] : -1;
    if (given != static_cast<int>(lists[s].size()))
      refuse(*find_constant("GCHNO"), fmt::format("GCHNO({})", s + 1), place_of("GCHNO"),
             in_quotes(std::to_string(given)),
             fmt::format("{}, the number of values of GCHGRZIND for this segment", lists[s].size()));
  }
}

void SettingsDraft::settle_segments() {
  check_lengths_agree();
  const int count = settle_segment_count();
  const Constant& segment_count = *find_constant("GCNOSEG");
  if (!segment_count.limits.contain(count))
    refuse(segment_count, "GCNOSEG", place_of("GCNOSEG"), fmt::format("lists for {} segments", count));
  const bool same_count = settings_.segments.size() == static_cast<std::size_t>(count);
  bool monitored = false;
  for (const SegmentSettings& segment : settings_.segments) monitored = monitored || !segment.monitor.empty();
  settings_.segments.resize(static_cast<std::size_t>(count));
  for (const Constant& constant : constants_table()) {
    const auto* member = std::get_if<SegmentInteger>(&constant.member);
    if (member == nullptr) continue;
    const bool given = lists_.count(constant.keyword) > 0;
    if (!given && !same_count && count > 1 && member->of_index != nullptr && missing_value(*member) != no_function)
      refuse(constant, std::string(constant.keyword), place_of(segment_count.keyword),
             fmt::format("nothing for {} segments", count), "one value for each segment");
    if (given || !same_count) settle_segment_integers(constant, *member);
  }
  const bool monitors_given = places_.count("GCHGRZIND") > 0 || places_.count("GCHNO") > 0;
  if (!monitors_given && !same_count && monitored)
    refuse(*find_constant("GCHGRZIND"), "GCHGRZIND", place_of("GCNOSEG"), fmt::format("nothing for {} segments", count),
           "a list for each segment");
  if (monitors_given) settle_monitors();
}

void SettingsDraft::check_count(const Constant& constant, std::size_t actual) const {
  const std::string_view list = std::get<ListCount>(constant.member).list;
  if (static_cast<double>(actual) > constant.limits.highest)
    refuse(*find_constant(list), std::string(list), place_of(list), fmt::format("{} values", actual),
           fmt::format("at most {} values", constant.limits.highest));
  const auto given = counts_.find(constant.keyword);
  if (given == counts_.end() || given->second == static_cast<int>(actual)) return;
  refuse(constant, std::string(constant.keyword), place_of(constant.keyword), in_quotes(std::to_string(given->second)),
         fmt::format("{}, the number of values of {}; to change it give {} itself", actual, list, list));
}

void SettingsDraft::check_counts() const {
  for (const Constant& constant : constants_table()) {
    const auto* count = std::get_if<ListCount>(&constant.member);
    if (count == nullptr) continue;
    const auto size_of_list = [this](const auto& member) -> std::size_t {
      if constexpr (requires { (settings_.*member).size(); })
        return (settings_.*member).size();
      else
        return 0;
    };
    check_count(constant, std::visit(size_of_list, find_constant(count->list)->member));
  }
}

/// A list that was read before and is not checked yet keeps its place.
void SettingsDraft::note_indices() {
  std::vector<GivenIndices> unchecked;
  for (const Constant& constant : constants_table()) {
    if (!has_parameter_indices(constant) && constant.keyword != "PAR") continue;
    const auto earlier = std::find_if(settings_.unchecked.begin(), settings_.unchecked.end(),
                                      [&](const auto& given) { return given.keyword == constant.keyword; });
    const bool is_earlier = !is_given(constant.keyword) && earlier != settings_.unchecked.end();
    unchecked.push_back(is_earlier ? *earlier
                                   : GivenIndices{std::string(constant.keyword), place_of(constant.keyword)});
  }
  settings_.unchecked = std::move(unchecked);
}

RunSettings SettingsDraft::finish(Warnings* warnings) {
  settle_segments();
  check_counts();
  settings_.branch_mode = standard_branch_mode(settings_.branch_mode);
  check_settings(settings_, [this](std::string_view keyword) { return place_of(keyword); });
  note_indices();
  if (warnings != nullptr)
    for (std::string& sentence : settings_warnings(settings_, source_)) warnings->push_back(std::move(sentence));
  return settings_;
}

}  // namespace tchat
