// Journals and parts of sweeps: records of lines with a right hash, whatever their numbers are. What passes the check
// of ranges can be used: it is written and read back, numbered, and its known attractors are there. The hash of each
// line is made right first, for no fuzzer would guess it.

#include <map>

#include "fuzz_target.hpp"
#include "simulate/attractor_numbering.hpp"
#include "simulate/sweep_journal.hpp"

using namespace tchat;

namespace {

/// The limits of a sweep of 5 values from 2 starts; 3 states, 2 fields, 3 event functions, 2 jumps.
RecordLimits limits() {
  RecordLimits limits;
  limits.values = 5;
  limits.starts = 2;
  limits.dimension = 3;
  limits.fields = 2;
  limits.events = 3;
  limits.jumps = 2;
  return limits;
}

SweptQuantity quantity() {
  SweptQuantity q;
  q.name = "mu";
  q.from = 0.0;
  q.to = 1.0;
  q.count = 5;
  return q;
}

/// Behind the heading the last word of each line is what belongs there.
std::string with_right_hashes(std::string_view text) {
  std::string result;
  bool is_heading = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    const std::size_t blank = line.rfind(' ');
    if (is_heading || blank == std::string_view::npos)
      result += line;
    else
      result += hashed_line(std::string(line.substr(0, blank)));
    if (line == "# end of heading") is_heading = false;
    if (end < text.size() && !result.ends_with('\n')) result += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

void use(JournalContents& contents) {
  const std::vector<AttractorSample> known = take_known(contents.records).value_or(std::vector<AttractorSample>{});
  std::map<std::pair<std::size_t, int>, SampleRecord> unique;
  for (SampleRecord& record : contents.records) {
    const auto again = read_record(record_line(record).substr(0, record_line(record).size() - 1));
    fuzz::require(again && record_line(*again) == record_line(record), "a record is read back");
    fuzz::require(record.sample.known >= 0 && record.sample.known <= static_cast<int>(known.size()), "known is there");
    unique.emplace(std::pair(record.index, record.start), std::move(record));
  }
  std::vector<SampleRecord> sorted;
  for (auto& [key, record] : unique) sorted.push_back(std::move(record));
  const std::vector<SweptQuantity> over{quantity()};
  const AttractorNumbers numbers = number_attractors(sorted, known, SweepGrid(over));
  fuzz::require(numbers.of_record.size() == sorted.size(), "a number for each record");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  for (const std::string& one : {std::string(text), with_right_hashes(text)}) {
    JournalContents contents;
    const bool accepted = fuzz::accepts([&] {
      contents = parse_journal(one, fuzz::source);
      fuzz::require(contents.whole <= one.size(), "whole lines lie within the text");
      check_records(contents, limits(), fuzz::source, "Remove it.");
    });
    if (accepted) use(contents);
  }
  return 0;
}
