#include "simulate/sweep_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/replaced_file.hpp"
#include "simulate/attractor_numbering.hpp"
#include "simulate/sweep_workers.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t block = 1 << 20;  // bytes of a file written at once

std::string sweep_path(const std::string& output) { return output + ".sweep"; }
std::string part_path(const std::string& output, int part) { return fmt::format("{}.sweep.{}", output, part); }

/// Values computed one after the other by one worker.
struct Unit {
  std::vector<std::pair<std::size_t, int>> values;  // index and start
  bool follows = false;
};

std::vector<Unit> units_of(const SweepJob& job, const SweepGrid& grid) {
  std::vector<Unit> units;
  const auto starts = static_cast<int>(job.following.size());
  if (std::all_of(job.following.begin(), job.following.end(), [](Following f) { return f == Following::none; })) {
    units.resize(grid.size());
    for (std::size_t index = 0; index < grid.size(); ++index)
      for (int start = 1; start <= starts; ++start) units[index].values.emplace_back(index, start);
    return units;
  }
  for (std::size_t chain = 0; chain < grid.chains(); ++chain)
    for (int start = 1; start <= starts; ++start) {
      Unit unit{{}, true};
      for (std::size_t i = 0; i < grid.chain_length(); ++i)
        unit.values.emplace_back(chain * grid.chain_length() + i, start);
      if (job.following[static_cast<std::size_t>(start) - 1] == Following::down)
        std::reverse(unit.values.begin(), unit.values.end());
      units.push_back(std::move(unit));
    }
  return units;
}

/// Every N-th unit: neighbours cost alike, so that parts do.
std::vector<Unit> units_of_part(std::vector<Unit> units, const SweepTask& task) {
  if (task.part == 0) return units;
  std::vector<Unit> own;
  for (std::size_t u = static_cast<std::size_t>(task.part) - 1; u < units.size();
       u += static_cast<std::size_t>(task.parts))
    own.push_back(std::move(units[u]));
  return own;
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::lround(seconds));
  if (s < 3600) return fmt::format("{}:{:02d}", s / 60, s % 60);
  return fmt::format("{}:{:02d}:{:02d}", s / 3600, s / 60 % 60, s % 60);
}

using RecordKey = std::pair<std::size_t, int>;

/// The values of one part, or of all, on their way into the journal.
class Computation {
 public:
  Computation(const SweepJob& job, const SweepTask& task, const std::function<bool()>& interrupted,
              std::ostream* progress)
      : job_(job), task_(task), grid_(job.heading.over), interrupted_(interrupted), line_(progress) {}

  /// What a journal held.
  void take(std::vector<SampleRecord> records) {
    if (std::optional<std::vector<AttractorSample>> known = take_known(records)) {
      knows_ = true;
      known_ = std::move(*known);
    }
    for (SampleRecord& record : records) records_.emplace(RecordKey{record.index, record.start}, std::move(record));
    kept_ = records_.size();
  }

  /// False when it was interrupted.
  bool run(SweepJournal& journal) {
    std::vector<Unit> units = units_of_part(units_of(job_, grid_), task_);
    values_ = 0;
    for (const Unit& unit : units) values_ += unit.values.size();
    if (job_.first_values > 0 && !knows_ && !find_known(journal)) return false;
    if (job_.first_values > 0) job_.learn(known_, interrupted_);
    return work(units, [&](const SampleRecord& record) {
      journal.add(record);
      records_.emplace(RecordKey{record.index, record.start}, record);
    });
  }

  std::vector<SampleRecord> sorted_records() {
    std::vector<SampleRecord> sorted;
    sorted.reserve(records_.size());
    for (auto& [key, record] : records_) sorted.push_back(std::move(record));
    return sorted;
  }
  const std::vector<AttractorSample>& known() const { return known_; }
  std::size_t values() const { return values_; }
  std::size_t kept() const { return kept_; }
  std::size_t computed() const { return records_.size() - kept_; }

 private:
  /// The first values, spread over the whole sweep: every part finds the same attractors.
  bool find_known(SweepJournal& journal) {
    std::vector<Unit> units(job_.first_values);
    for (std::size_t k = 0; k < units.size(); ++k)
      for (int start = 1; start <= static_cast<int>(job_.following.size()); ++start)
        units[k].values.emplace_back(spread(k), start);
    std::map<RecordKey, SampleRecord> first;
    counts_ = false;
    const bool is_complete = work(units, [&](const SampleRecord& record) {
      first.emplace(RecordKey{record.index, record.start}, record);
    });
    counts_ = true;
    if (!is_complete) return false;
    std::vector<SampleRecord> records;
    for (auto& [key, record] : first) records.push_back(std::move(record));
    known_ = distinct_attractors(records);
    for (std::size_t k = 0; k < known_.size(); ++k) journal.add({k + 1, start_of_known, known_[k]});
    journal.add({known_.size() + 1, start_of_known, {}});
    return true;
  }

  /// Value k of the first ones: in two dimensions no lattice along an axis.
  std::size_t spread(std::size_t k) const {
    const double golden = 0.6180339887498949;
    const double share = std::fmod((static_cast<double>(k) + 0.5) * golden, 1.0);
    return std::min(grid_.size() - 1, static_cast<std::size_t>(share * static_cast<double>(grid_.size())));
  }

  template <class Add>
  bool work(const std::vector<Unit>& units, const Add& add) {
    const auto begun = std::chrono::steady_clock::now();
    std::atomic<std::size_t> done = 0;
    bool is_stopped = false;
    SweepWork work;
    work.tasks = units.size();
    work.work = [&](std::size_t task, int worker, const std::atomic<bool>& stop) {
      do_unit(units[task], job_.functions[static_cast<std::size_t>(worker)], stop, [&](const SampleRecord& record) {
        const std::lock_guard lock(mutex_);
        add(record);
        ++done;
      });
    };
    work.meanwhile = [&] {
      if (counts_ && line_.is_due()) show(done, begun);
      is_stopped = is_stopped || interrupted_();
      return is_stopped;
    };
    run_workers(task_.workers, work);
    line_.clear();
    return !is_stopped;
  }

  template <class Done>
  void do_unit(const Unit& unit, const SampleFunction& function, const std::atomic<bool>& stop, const Done& done) {
    std::optional<MotionState> last;
    for (const auto& [index, start] : unit.values) {
      if (stop) return;
      if (counts_)
        if (const SampleRecord* const there = find({index, start})) {
          go_on_from(unit, there->sample, last);
          continue;
        }
      SampleRecord record{index, start, {}};
      try {
        record.sample = function({index, grid_.values(index), start, last});
      } catch (const SampleInterrupted&) {
        return;
      }
      if (stop) return;  // it may have been cut short
      go_on_from(unit, record.sample, last);
      done(record);
    }
  }

  /// Where a value has settled on nothing the next one begins where this one did.
  static void go_on_from(const Unit& unit, const AttractorSample& sample, std::optional<MotionState>& last) {
    if (unit.follows && is_attractor(sample.kind) && sample.last.x.size() > 0) last = sample.last;
  }

  const SampleRecord* find(const RecordKey& key) {
    const std::lock_guard lock(mutex_);
    const auto at = records_.find(key);
    return at == records_.end() ? nullptr : &at->second;
  }

  void show(std::size_t done, std::chrono::steady_clock::time_point begun) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const std::size_t all = kept_ + done;
    std::string text =
        fmt::format("{} of {} values, {} %", all, values_, all * 100 / std::max<std::size_t>(1, values_));
    if (done > 0)
      text += fmt::format(", about {} left",
                          duration_text(seconds / static_cast<double>(done) * static_cast<double>(values_ - all)));
    line_.show(text + " ");
  }

  const SweepJob& job_;
  const SweepTask& task_;
  SweepGrid grid_;
  const std::function<bool()>& interrupted_;
  ProgressLine line_;
  std::mutex mutex_;
  std::map<RecordKey, SampleRecord> records_;
  std::vector<AttractorSample> known_;
  bool knows_ = false, counts_ = true;
  std::size_t values_ = 0, kept_ = 0;
};

/// "nan" for what does not exist, whatever sign it has.
void add_number(std::string& line, double value) {
  if (std::isnan(value))
    line += " nan";
  else
    fmt::format_to(std::back_inserter(line), " {}", value);
}

class TableWriter {
 public:
  TableWriter(const SweepJob& job, const std::vector<AttractorSample>& known) : job_(job), known_(known) {}

  std::string names() const {
    std::string line = "index";
    for (const SweptQuantity& quantity : job_.heading.over) line += " " + sweep_column(quantity.column());
    line += " start attractor kind";
    if (job_.columns.event) line += " event";
    line += " period time impacts";
    if (job_.columns.penetration) line += " penetration";
    for (int k = 1; k <= job_.columns.exponents; ++k) line += fmt::format(" lambda{} error{}", k, k);
    for (const std::string& state : job_.columns.largest) line += " " + sweep_column(largest_value_column(state));
    for (const std::string& state : job_.columns.states) line += " " + sweep_column(state);
    return line + "\n";
  }

  /// The rows of one (value, start).
  void rows(const SampleRecord& record, int number, const Eigen::VectorXd& values, std::string& text) const {
    const AttractorSample& sample =
        record.sample.known > 0 ? known_[static_cast<std::size_t>(record.sample.known) - 1] : record.sample;
    const bool has_states = !job_.columns.states.empty();
    const Eigen::Index count = has_states ? std::max<Eigen::Index>(1, sample.sections.cols()) : 1;
    for (Eigen::Index dot = 0; dot < count; ++dot) {
      fmt::format_to(std::back_inserter(text), "{}", record.index);
      for (const double value : values) add_number(text, value);
      fmt::format_to(std::back_inserter(text), " {} {} {}", record.start, number, to_string(sample.kind));
      const bool is_dot = has_states && dot < sample.sections.cols();
      if (job_.columns.event) add_event(sample, is_dot, dot, text);
      add_scalars(sample, is_dot, dot, text);
      add_largest(sample, dot, text);
      for (std::size_t k = 0; k < job_.columns.states.size(); ++k)
        add_number(text, is_dot ? sample.sections(static_cast<Eigen::Index>(k), dot) : NAN);
      text += '\n';
    }
  }

 private:
  static void add_event(const AttractorSample& sample, bool is_dot, Eigen::Index dot, std::string& text) {
    if (is_dot && dot < static_cast<Eigen::Index>(sample.section_events.size()))
      fmt::format_to(std::back_inserter(text), " {}", sample.section_events[static_cast<std::size_t>(dot)]);
    else
      text += " nan";
  }

  void add_scalars(const AttractorSample& sample, bool is_dot, Eigen::Index dot, std::string& text) const {
    const bool is_closed = repeats(sample.kind);
    add_number(text, is_closed ? static_cast<double>(sample.signature.size()) : NAN);
    add_number(text, is_closed ? sample.period : NAN);
    add_number(text, is_closed ? static_cast<double>(sample.impacts) : NAN);
    if (job_.columns.penetration)
      add_number(text, is_dot && dot < sample.section_penetrations.size() ? sample.section_penetrations(dot)
                                                                          : sample.penetration);
    for (Eigen::Index k = 0; k < job_.columns.exponents; ++k) {
      add_number(text, k < sample.exponents.size() ? sample.exponents(k) : NAN);
      add_number(text, k < sample.errors.size() ? sample.errors(k) : NAN);
    }
  }

  void add_largest(const AttractorSample& sample, Eigen::Index dot, std::string& text) const {
    for (std::size_t k = 0; k < job_.columns.largest.size(); ++k)
      add_number(text, dot < sample.largest.cols() ? sample.largest(static_cast<Eigen::Index>(k), dot) : NAN);
  }

  const SweepJob& job_;
  const std::vector<AttractorSample>& known_;
};

void count_found(const std::vector<SampleRecord>& records, const AttractorNumbers& numbers, SweepOutcome& outcome) {
  outcome.attractors = numbers.attractors;
  outcome.found.assign(numbers.attractors.size(), 0);
  outcome.least_events.assign(numbers.attractors.size(), 0);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const int number = numbers.of_record[r];
    if (number > 0) {
      const std::size_t a = static_cast<std::size_t>(number) - 1;
      const long events = records[r].sample.events;
      outcome.least_events[a] = outcome.found[a] == 0 ? events : std::min(outcome.least_events[a], events);
      ++outcome.found[a];
    } else if (outcome.without++ == 0) {
      outcome.first_without = records[r].index;
      outcome.first_message =
          numbers.left_after[r] > 0
              ? fmt::format("chaotic for {} events, and other starts have settled after up to {}: perhaps a transient",
                            records[r].sample.events, numbers.left_after[r])
              : records[r].sample.message;
    }
  }
}

void write_table(const SweepJob& job, const SweepTask& task, const std::vector<SampleRecord>& records,
                 const std::vector<AttractorSample>& known, SweepOutcome& outcome) {
  const SweepGrid grid(job.heading.over);
  const AttractorNumbers numbers = number_attractors(records, known, grid);
  SweepTable heading = job.heading;
  heading.attractors = numbers.attractors;
  const TableWriter writer(job, known);
  ReplacedFile file(sweep_path(task.output));
  std::string text = sweep_heading(heading) + writer.names();
  for (std::size_t r = 0; r < records.size(); ++r) {
    writer.rows(records[r], numbers.of_record[r], grid.values(records[r].index), text);
    if (text.size() < block) continue;
    file.write(text);
    text.clear();
  }
  file.write(text);
  file.finish();
  count_found(records, numbers, outcome);
  outcome.written = sweep_path(task.output);
}

SweepIdentity with_part(const SweepJob& job, int part, int parts) {
  SweepIdentity identity = job.identity;
  if (part > 0) identity.emplace_back("part", fmt::format("{} of {}", part, parts));
  return identity;
}

void write_part(const SweepJob& job, const SweepTask& task, const std::vector<SampleRecord>& records,
                const std::vector<AttractorSample>& known, SweepOutcome& outcome) {
  ReplacedFile file(part_path(task.output, task.part));
  std::string text = journal_heading(with_part(job, task.part, task.parts));
  for (std::size_t k = 0; k < known.size(); ++k) text += record_line({k + 1, start_of_known, known[k]});
  if (job.first_values > 0) text += record_line({known.size() + 1, start_of_known, {}});
  for (const SampleRecord& record : records) {
    text += record_line(record);
    if (text.size() < block) continue;
    file.write(text);
    text.clear();
  }
  file.write(text);
  file.finish();
  outcome.written = part_path(task.output, task.part);
}

/// Numbers I of the files O.sweep.I.
std::set<int> part_numbers(const std::string& output) {
  std::set<int> numbers;
  const fs::path path(sweep_path(output));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::string prefix = path.filename().string() + ".";
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    if (const std::optional<int> number = parse_integer(name.substr(prefix.size())); number && *number > 0)
      numbers.insert(*number);
  }
  return numbers;
}

/// N of "I of N" at the end of a part's identity.
int parts_of(const std::string& path, int part, const SweepIdentity& identity) {
  if (!identity.empty() && identity.back().first == "part") {
    const std::string& text = identity.back().second;
    if (const std::size_t of = text.find(" of "); of != std::string::npos)
      if (const std::optional<int> parts = parse_integer(text.substr(of + 4));
          parts && *parts >= part && *parts <= most_parts)
        return *parts;
  }
  throw UserError(fmt::format("{}: it is no part of a sweep; remove it, or make parts with --part I/N", path));
}

std::set<RecordKey> values_of_part(const std::vector<Unit>& units, int part, int parts) {
  std::set<RecordKey> values;
  for (auto u = static_cast<std::size_t>(part) - 1; u < units.size(); u += static_cast<std::size_t>(parts))
    values.insert(units[u].values.begin(), units[u].values.end());
  return values;
}

RecordLimits limits_of(const SweepJob& job) {
  RecordLimits limits = job.limits;
  limits.values = SweepGrid(job.heading.over).size();
  limits.starts = static_cast<int>(job.following.size());
  return limits;
}

[[noreturn]] void refuse_missing(const std::vector<int>& missing, int parts, const std::string& command) {
  constexpr std::size_t most_named = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(missing.size(), most_named); ++k)
    text += fmt::format("\n  {} --part {}/{}", command, missing[k], parts);
  if (missing.size() > most_named) text += fmt::format("\n  and {} more", missing.size() - most_named);
  throw UserError(fmt::format("{} of {} parts are missing; these commands make them:{}", missing.size(), parts, text));
}

/// Parts that have been read and found to belong to one sweep.
class Gathering {
 public:
  Gathering(const SweepJob& job, const SweepTask& task)
      : job_(job), task_(task), units_(units_of(job, SweepGrid(job.heading.over))) {}

  void add(int part) {
    const std::string path = part_path(task_.output, part);
    JournalContents contents = read_journal(path);
    if (parts_ == 0) parts_ = parts_of(path, part, contents.identity);
    if (const std::string what = difference(contents.identity, with_part(job_, part, parts_)); !what.empty())
      throw UserError(
          fmt::format("{} is a part of another sweep: {}; give the command that made it with --gather, or "
                      "make the part again",
                      path, what));
    const std::string again = fmt::format("{} --part {}/{}", task_.command, part, parts_);
    check_records(contents, limits_of(job_), path, fmt::format("Make it again: {}", again));
    std::vector<AttractorSample> known = take_known(contents.records).value_or(std::vector<AttractorSample>{});
    const std::set<RecordKey> expected = values_of_part(units_, part, parts_);
    std::size_t values = 0;
    for (SampleRecord& record : contents.records) {
      const RecordKey key{record.index, record.start};
      if (expected.contains(key) && records_.emplace(key, std::move(record)).second) ++values;
    }
    if (values != expected.size())
      throw UserError(fmt::format("{}: it holds {} of {} values, for it was cut or damaged; make it again: {}", path,
                                  values, expected.size(), again));
    if (known_ && known_->size() != known.size())
      throw UserError(fmt::format("{}: it has {} known attractors, and the parts before it {}; make it again: {}", path,
                                  known.size(), known_->size(), again));
    if (!known_) known_ = std::move(known);
  }

  /// N; 0 as long as there is none.
  int parts() const { return parts_; }
  std::vector<SampleRecord> take_records() {
    std::vector<SampleRecord> sorted;
    for (auto& [key, record] : records_) sorted.push_back(std::move(record));
    return sorted;
  }
  const std::vector<AttractorSample>& known() const { return *known_; }

 private:
  const SweepJob& job_;
  const SweepTask& task_;
  std::vector<Unit> units_;
  int parts_ = 0;
  std::map<RecordKey, SampleRecord> records_;
  std::optional<std::vector<AttractorSample>> known_;
};

SweepOutcome gather(const SweepJob& job, const SweepTask& task) {
  const std::set<int> there = part_numbers(task.output);
  if (there.empty())
    throw UserError(fmt::format("there is no part {} to gather; `{} --part 1/N` to `--part N/N` make N of them",
                                part_path(task.output, 1), task.command));
  Gathering gathering(job, task);
  for (const int part : there)
    if (gathering.parts() == 0 || part <= gathering.parts()) gathering.add(part);
  std::vector<int> missing;
  for (int part = 1; part <= gathering.parts(); ++part)
    if (!there.contains(part)) missing.push_back(part);
  if (!missing.empty()) refuse_missing(missing, gathering.parts(), task.command);
  SweepOutcome outcome;
  const std::vector<SampleRecord> records = gathering.take_records();
  outcome.values = records.size();
  outcome.kept = records.size();
  write_table(job, task, records, gathering.known(), outcome);
  outcome.is_complete = true;
  return outcome;
}

}  // namespace

SweepOutcome run_sweep(const SweepJob& job, const SweepTask& task, const std::function<bool()>& interrupted,
                       std::ostream* progress, std::ostream& screen) {
  const std::string result = task.part > 0 ? part_path(task.output, task.part) : sweep_path(task.output);
  require_writable(result);
  const std::unique_ptr<FileLock> lock = lock_output(result);
  if (task.gather) return gather(job, task);

  const std::string journal_path = result + ".journal";
  if (std::error_code error; task.fresh) fs::remove(journal_path, error);
  SweepJournal journal(journal_path, with_part(job, task.part, task.parts), limits_of(job));
  Computation computation(job, task, interrupted, progress);
  computation.take(journal.take_records());
  if (computation.kept() > 0)
    screen << fmt::format("Going on with {}: {} values are there.\n", journal_path, computation.kept()) << std::flush;
  SweepOutcome outcome;
  outcome.is_complete = computation.run(journal);
  outcome.values = computation.values();
  outcome.computed = computation.computed();
  outcome.kept = computation.kept();
  outcome.written = journal_path;
  if (!outcome.is_complete) return outcome;
  const std::vector<SampleRecord> records = computation.sorted_records();
  if (task.part > 0)
    write_part(job, task, records, computation.known(), outcome);
  else
    write_table(job, task, records, computation.known(), outcome);
  journal.remove();
  return outcome;
}

}  // namespace tchat
