/// What a sweep has computed so far, a line for each value as soon as it is there. Whatever ends the process, the next
/// one of the same command goes on behind the last whole line.
///
///     # tchat sweep journal 1
///     # KEY VALUE            what the results depend on: problem, plugin, swept quantities, starts, options
///     # end of heading
///     0 1 ...                sample_record.hpp
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sweep/sample_record.hpp"

namespace tchat {

/// What the results of a sweep depend on, in words, in order.
using SweepIdentity = std::vector<std::pair<std::string, std::string>>;

/// The heading of journals and parts.
std::string journal_heading(const SweepIdentity& identity);

struct JournalContents {
  bool is_there = false;  ///< with a whole heading
  SweepIdentity identity;
  std::vector<SampleRecord> records;
  std::size_t whole = 0;  ///< bytes up to the end of the last good line
};

/// A journal or a part. Lines behind a damaged one do not count. Throws ComputationError when the device fails, and
/// UserError for a file that is no journal.
JournalContents read_journal(const std::string& path);

/// "" or what differs, for people: "tolerance is 1e-10 there and 1e-08 here".
std::string difference(const SweepIdentity& there, const SweepIdentity& here);

class SweepJournal {
 public:
  /// Opens it, or makes it. Throws UserError when it belongs to another sweep.
  SweepJournal(std::string path, const SweepIdentity& identity);
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
