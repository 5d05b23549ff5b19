#include "resegment/segment_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "orbit/orbit.hpp"
#include "settings/constant_value.hpp"
#include "settings/problem_type.hpp"

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

}  // namespace tchat
