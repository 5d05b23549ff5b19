/// What a sweep has computed so far, a line for each value as soon as it is there. Whatever ends the process, the next
/// one of the same command goes on behind the last whole line.
///
///     # tchat sweep journal 1
///     # KEY VALUE            what the results depend on: problem, plugin, swept quantities, starts, options
///     # end of heading
///     0 1 ...                sample_record.hpp
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "simulate/record_limits.hpp"
#include "simulate/sample_record.hpp"

namespace tchat {

/// What the results of a sweep depend on, in words, in order.
using SweepIdentity = std::vector<std::pair<std::string, std::string>>;

/// The heading of journals and parts.
std::string journal_heading(const SweepIdentity& identity);

struct JournalContents {
  bool is_there = false;  ///< with a whole heading
  SweepIdentity identity;
  std::vector<SampleRecord> records;
  std::size_t first_line = 0;  ///< number of the line of the first record, from 1; the others follow it
  std::size_t whole = 0;       ///< bytes up to the end of the last good line
};

/// A journal or a part from its text. Lines behind a damaged one do not count. The numbers in records have not been
/// compared with any sweep (record_limits.hpp). Throws UserError for a text that is no journal; `path` is its name.
JournalContents parse_journal(const std::string& text, const std::string& path);

/// The same of a file; nothing is there when the file is missing. Throws ComputationError when the device fails, and
/// UserError also for what is no regular file.
JournalContents read_journal(const std::string& path);

/// Throws UserError with file, line and `cure` where a record has a number that is out of range. The number of known
/// attractors is that of the contents themselves.
void check_records(const JournalContents& contents, RecordLimits limits, const std::string& path,
                   const std::string& cure);

/// The attractors that the first values have found, taken out of the records; nothing when the search for them did not
/// come to its end.
std::optional<std::vector<AttractorSample>> take_known(std::vector<SampleRecord>& records);

/// "" or what differs, for people: "tolerance is 1e-10 there and 1e-08 here".
std::string difference(const SweepIdentity& there, const SweepIdentity& here);

class SweepJournal {
 public:
  /// Opens it, or makes it, never through a symbolic link. Throws UserError when it belongs to another sweep, or when
  /// it holds what `limits` (but for `known`, which it sets itself) do not allow.
  SweepJournal(std::string path, const SweepIdentity& identity, const RecordLimits& limits);
  ~SweepJournal();
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;

  /// What was there.
  std::vector<SampleRecord> take_records() { return std::move(records_); }
  /// Throws ComputationError when the disk is full.
  void add(const SampleRecord& record);
  /// The sweep is complete: the journal is not needed any more.
  void remove();

 private:
  void write(const std::string& text);

  std::string path_;
  int descriptor_ = -1;
  std::vector<SampleRecord> records_;
};

}  // namespace tchat
