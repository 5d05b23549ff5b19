#include "resegment/segment_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "model/events.hpp"
#include "orbit/orbit.hpp"
#include "settings/constant_value.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {}  // namespace

SegmentList segments_of(const RunSettings& settings) {
  SegmentList segments;
  int counted = 0;
  for (std::size_t s = 0; s < settings.segments.size(); ++s) {
    const SegmentSettings& old = settings.segments[s];
    NewSegment segment{{static_cast<int>(s), 0.0, 1.0}, old.index, old.type == 2, {}};
    for (const int event : old.monitor) {
      ++counted;
      const auto& tests = settings.test_functions;
      const bool located =
          keeps_contact(settings.problem_type) || std::find(tests.begin(), tests.end(), counted) != tests.end();
      segment.watched.push_back({event, located});
    }
    segments.push_back(segment);
  }
  return segments;
}

SegmentList rotated(const SegmentList& segments, int k) {
  const int m = static_cast<int>(segments.size());
  SegmentList result = segments;
  std::rotate(result.begin(), result.begin() + ((k % m) + m) % m, result.end());
  return result;
}

SegmentList joined(SegmentList segments, const SegmentList& further) {
  segments.insert(segments.end(), further.begin(), further.end());
  return segments;
}

SegmentList repeated(const SegmentList& segments) { return joined(segments, segments); }

void watch(NewSegment& segment, int event) {
  for (const WatchedEvent& watched : segment.watched)
    if (watched.event == event) return;
  segment.watched.push_back({event, true});
}

CutList cut_at(CutList cut, const ContactPoint& contact, int jump) {
  const auto at = cut.segments.begin() + contact.segment;
  if (contact.where == ContactPoint::inside) {
    NewSegment rest = *at;
    rest.piece.from = contact.tau;
    watch(rest, contact.event);
    at->piece.to = contact.tau;
    cut.segments.insert(at + 1, rest);
    for (std::size_t& later : cut.contacts) ++later;
  }
  const auto position = static_cast<std::size_t>(contact.segment);
  cut.contacts.insert(cut.contacts.begin(), position);
  NewSegment& first = cut.segments[position];
  first.index.event = contact.event;
  first.index.jump = jump;
  first.grazes = false;
  watch(first, contact.event);
  return cut;
}

CutList without_empty_segments(CutList cut, std::size_t k, const Orbit& x) {
  while (cut.segments.size() > 1) {
    const std::size_t next = (cut.contacts[k] + 1) % cut.segments.size();
    if (!lasts_no_time(x, cut.segments[next].piece.segment)) break;
    cut.segments.erase(cut.segments.begin() + static_cast<std::ptrdiff_t>(next));
    for (std::size_t& contact : cut.contacts)
      if (next < contact) --contact;
  }
  return cut;
}

CutList with_empty_segments(CutList cut, std::size_t k, int count) {
  const NewSegment& before = cut.segments[cut.contacts[k]];
  const NewSegment empty{
      {before.piece.segment, before.piece.to, before.piece.to}, {}, false, {{before.index.event, true}}};
  cut.segments.insert(cut.segments.begin() + static_cast<std::ptrdiff_t>(cut.contacts[k]) + 1,
                      static_cast<std::size_t>(count), empty);
  for (std::size_t later = k + 1; later < cut.contacts.size(); ++later)
    cut.contacts[later] += static_cast<std::size_t>(count);
  return cut;
}

namespace {

int segment_type(const HybridSystem& system, const NewSegment& segment) {
  if (segment.grazes) return 2;
  return is_identity_jump(system, segment.index) ? 0 : 1;
}

/// `now` has the monitors and the problem type of the new constants, and the old ICP without durations. Further
/// monitors are columns of files, so that they stand behind the parameters unless they come first.
std::vector<int> new_free_parameters(const RunSettings& now, const RunSettings& old, std::size_t segments,
                                     const NewProblem& problem, const HybridSystem& system) {
  std::vector<int> list, monitors;
  for (const int k : now.free_parameters) (is_monitor(now, k) ? monitors : list).push_back(k);
  const auto had = static_cast<std::size_t>(free_parameter_count(old));
  const auto needed = static_cast<std::size_t>(free_parameter_count(now));
  for (std::size_t k = needed; k < had && list.size() > needed; ++k)
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(needed));  // free no longer; those printed only stay
  for (int k = 1; k <= system.parameters() && list.size() < needed; ++k)
    if (std::find(list.begin(), list.end(), k) == list.end()) list.push_back(k);
  if (list.size() < needed && !problem.names_parameters)
    throw UserError(
        fmt::format("a grazing curve has two free parameters, but of problem {} only one is known; name both, as in "
                    "ICP=[1,2,61]",
                    system.name()));
  const bool first = !monitors.empty() && now.free_parameters.front() == monitors.front();
  list.insert(first ? list.begin() : list.end(), monitors.begin(), monitors.end());
  for (std::size_t s = 0; s < segments; ++s) list.push_back(now.layout.duration(static_cast<int>(s)));
  return list;
}

std::vector<IndexedValue> new_weights(const RunSettings& old, const SegmentList& segments) {
  std::vector<IndexedValue> weights;
  for (const IndexedValue& w : old.parameter_weights)
    if (!is_duration(old, w.index)) weights.push_back(w);
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const IndexedValue& w : old.parameter_weights)
      if (is_duration(old, w.index) && old.layout.duration_segment(w.index) == segments[s].piece.segment)
        weights.push_back({old.layout.duration(static_cast<int>(s)), w.value});
  return weights;
}

/// A contact that changes no state has no xi_n.
std::vector<int> new_test_functions(const SegmentList& segments, const NewProblem& problem,
                                    const HybridSystem& system) {
  if (keeps_contact(problem.problem_type))
    return is_identity_jump(system, problem.grazing_jump) ? std::vector<int>{} : std::vector<int>{1, 2, 3, 4, 5};
  std::vector<int> tests;
  int counted = 0;
  for (const NewSegment& segment : segments)
    for (const WatchedEvent& watched : segment.watched) {
      ++counted;
      if (watched.located) tests.push_back(counted);
    }
  return tests;
}

}  // namespace

RunSettings new_settings(const RunSettings& old, const SegmentList& segments, const NewProblem& problem,
                         const HybridSystem& system) {
  const int m = static_cast<int>(old.segments.size());
  RunSettings settings = old;
  leave_out_monitors(settings);
  std::erase_if(settings.free_parameters, [&old](int k) { return is_duration(old, k); });
  settings.problem_type = problem.problem_type;
  settings.branch_mode = problem.branch_mode;
  settings.grazing_jump = problem.grazing_jump;
  settings.start = {"", 1};
  settings.segments.clear();
  for (const NewSegment& segment : segments) {
    SegmentSettings next{segment_type(system, segment), segment.index, {}};
    for (const WatchedEvent& watched : segment.watched) next.monitor.push_back(watched.event);
    settings.segments.push_back(next);
  }
  if (!problem_type(settings).facts().may_conserve) settings.conserved.clear();
  renumber_monitors(settings, m);
  settings.free_parameters = new_free_parameters(settings, old, segments.size(), problem, system);
  settings.parameter_weights = new_weights(old, segments);
  settings.test_functions = new_test_functions(segments, problem, system);
  const auto is_left_out = [&old](const auto& value) { return !is_parameter(old, value.parameter); };
  std::erase_if(settings.user_values, is_left_out);
  std::erase_if(settings.bounds, is_left_out);
  settings.stop_rules.clear();
  return settings;
}

}  // namespace tchat
