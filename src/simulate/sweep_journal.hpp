/// The journal of a sweep, and the ranges of the numbers in it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/hybrid_system.hpp"
#include "simulate/sample_record.hpp"

namespace tchat {

// Ranges of the numbers in a journal or part of a sweep. Its lines index into arrays and name functions of the
// problem, and a file may have been edited: nothing of a line is used before it has been checked.

/// `start` of a record that holds a known attractor, whose number, from 1, is its index. An empty record ends them.
inline constexpr int start_of_known = 0;

struct RecordLimits {
  std::size_t values = 0;                 ///< index of a value: 0 to values - 1
  int starts = 0;                         ///< start: 1 to starts
  int known = 0;                          ///< number of a known attractor: 1 to known, 0 for none
  int dimension = 0;                      ///< of states
  int fields = 0, events = 0, jumps = 0;  ///< numbers in index vectors: from 1, in signatures also no_function

  /// Dimension and functions; the other limits are those of a sweep.
  static RecordLimits of(const HybridSystem& system);
};

/// "" or what is out of range: "known is 999; allowed are 0 to 3".
std::string fault_of(const SampleRecord& record, const RecordLimits& limits);

// What a sweep has computed so far, a line for each value as soon as it is there. Whatever ends the process, the next
// one of the same command goes on behind the last whole line.
//
//     # tchat sweep journal 1
//     # KEY VALUE            what the results depend on: problem, plugin, swept quantities, starts, options
//     # end of heading
//     0 1 ...                sample_record.hpp

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
/// compared with any sweep (RecordLimits). Throws UserError for a text that is no journal; `path` is its name.
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
