#include "resegment/segment_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/no_duration.hpp"
#include "constants/constant_value.hpp"
#include "constants/user_error.hpp"

namespace tchat {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

[[noreturn]] void refuse_signature(std::string_view text, const std::string& found) {
  throw UserError(fmt::format(
      "--signature {}: {}; allowed: index vectors (field, event, jump) of whole numbers from 1, separated by "
      "semicolons, for example --signature \"1,1,1;2,2,2\"",
      in_quotes(text), found));
}

}  // namespace

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
          settings.problem_type != 180 || std::find(tests.begin(), tests.end(), counted) != tests.end();
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
  if (segments.size() > static_cast<std::size_t>(max_segments))
    throw UserError(
        fmt::format("the new orbit has {} segments, at most {} are allowed", segments.size(), max_segments));
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

Signature parse_signature(std::string_view text) {
  std::string plain;  // "1,1,1;2,2,2;", whatever parentheses there were
  for (const char c : text)
    if (c == ')')
      plain += ';';
    else if (c != ' ' && c != '(' && c != '{' && c != '}')
      plain += c;
  Signature signature;
  for (const std::string_view part : split(plain, ';')) {
    const std::string_view vector = part.starts_with(',') ? part.substr(1) : part;
    if (vector.empty()) continue;
    std::vector<int> numbers;
    for (const std::string_view word : split(vector, ',')) {
      const auto value = parse_integer(word);
      if (!value || *value < 1) refuse_signature(text, fmt::format("found {}", in_quotes(word)));
      numbers.push_back(*value);
    }
    if (numbers.size() != 3)
      refuse_signature(text, fmt::format("index vector {} has {} numbers", signature.size() + 1, numbers.size()));
    signature.push_back({numbers[0], numbers[1], numbers[2]});
  }
  if (signature.empty()) refuse_signature(text, "found no index vector");
  if (signature.size() > static_cast<std::size_t>(max_segments))
    refuse_signature(text, fmt::format("{} segments, at most {} are allowed", signature.size(), max_segments));
  return signature;
}

}  // namespace tchat
