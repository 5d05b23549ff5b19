#include "simulate/sweep_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "simulate/attractor_numbering.hpp"

namespace tchat {

namespace {

/// Keeps the first number that is out of range.
class RangeCheck {
 public:
  void number(const char* name, long value, long least, long largest) {
    if (!fault_.empty() || (value >= least && value <= largest)) return;
    fault_ = fmt::format("{} is {}; allowed are {} to {}", name, value, least, largest);
  }

  void count(const char* name, Eigen::Index value, Eigen::Index wanted, bool may_be_empty) {
    if (!fault_.empty() || value == wanted || (value == 0 && may_be_empty)) return;
    fault_ = fmt::format("{} has {} entries; needed are {}", name, value, wanted);
  }

  void index_vectors(const char* name, const std::vector<IndexVector>& vectors, const RecordLimits& limits, int least) {
    for (const IndexVector& v : vectors) {
      number(fmt::format("a field in the {}", name).c_str(), v.field, 1, limits.fields);
      number(fmt::format("an event function in the {}", name).c_str(), v.event, least, limits.events);
      number(fmt::format("a jump in the {}", name).c_str(), v.jump, least, limits.jumps);
    }
  }

  void require(bool holds, const char* fault) {
    if (fault_.empty() && !holds) fault_ = fault;
  }

  const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
};

void check_states(const AttractorSample& sample, int dimension, RangeCheck& check) {
  const Eigen::Index n = dimension;
  if (sample.sections.cols() > 0) check.count("a recorded state", sample.sections.rows(), n, false);
  if (sample.largest.cols() > 0) check.count("a list of largest values", sample.largest.rows(), n, false);
  if (sample.identity.cols() > 0) check.count("a section state", sample.identity.rows(), n, false);
  check.count("the sizes", sample.sizes.size(), n, sample.identity.cols() == 0);
  check.count("the last state", sample.last.x.size(), n, true);
  check.require(!is_attractor(sample.kind) || sample.last.x.allFinite(), "the last state is not finite");
}

}  // namespace

RecordLimits RecordLimits::of(const HybridSystem& system) {
  RecordLimits limits;
  limits.dimension = system.dimension();
  limits.fields = system.count(FunctionKind::field);
  limits.events = system.count(FunctionKind::event);
  limits.jumps = system.count(FunctionKind::jump);
  return limits;
}

std::string fault_of(const SampleRecord& record, const RecordLimits& limits) {
  const AttractorSample& sample = record.sample;
  const bool is_known = record.start == start_of_known;
  const auto values = static_cast<long>(limits.values);
  RangeCheck check;
  check.number("start", record.start, start_of_known, limits.starts);
  check.number("index", static_cast<long>(record.index), is_known ? 1 : 0, is_known ? values + 1 : values - 1);
  check.number("known", sample.known, 0, is_known ? 0 : limits.known);
  check.number("impacts", sample.impacts, -1, static_cast<long>(sample.signature.size()));
  check.index_vectors("signature", sample.signature, limits, is_known ? 1 : no_function);
  check.index_vectors("watched index vectors", sample.last.watched, limits, 1);
  check_states(sample, limits.dimension, check);
  if (is_known && sample.kind == AttractorKind::periodic) {
    check.require(!sample.signature.empty(), "a periodic attractor has no signature");
    check.count("the sizes", sample.sizes.size(), limits.dimension, false);
    check.count("the last state", sample.last.x.size(), limits.dimension, false);
  }
  return check.fault();
}

namespace {

constexpr const char* journal_line = "# tchat sweep journal 1";
constexpr const char* heading_end = "# end of heading";

/// The line from `at` without its newline, and `at` behind it; false when there is no whole line.
bool take_line(const std::string& text, std::size_t& at, std::string& line) {
  const std::size_t end = text.find('\n', at);
  if (end == std::string::npos) return false;
  line = text.substr(at, end - at);
  at = end + 1;
  return true;
}

/// How many attractors take_known gives; none where the search for them did not come to its end.
int known_count(const std::vector<SampleRecord>& records) {
  int count = 0;
  bool is_complete = false;
  for (const SampleRecord& record : records) {
    if (record.start != start_of_known) continue;
    is_complete = record.sample.kind == AttractorKind::none;
    if (!is_complete) count = record.index == 1 ? 1 : count + 1;
  }
  return is_complete ? count : 0;
}

/// Whoever may write in the folder could have another file of ours written through a link.
void refuse_link(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(path, error))) return;
  throw UserError(fmt::format(
      "{}: this is a symbolic link, and a journal is not written through links.\n  Remove it (rm {}), or give another "
      "name with -o.",
      path, path));
}

[[noreturn]] void fail(const std::string& path, const char* what) {
  throw ComputationError(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

}  // namespace

std::string journal_heading(const SweepIdentity& identity) {
  std::string text = fmt::format("{}\n", journal_line);
  for (const auto& [key, value] : identity) text += fmt::format("# {} {}\n", key, value);
  return text + heading_end + "\n";
}

JournalContents parse_journal(const std::string& text, const std::string& path) {
  JournalContents contents;
  std::size_t at = 0;
  std::string line;
  if (!text.empty() && !text.starts_with(std::string(journal_line).substr(0, text.size())))
    throw UserError(
        fmt::format("{}: this is no journal or part of a sweep of this version of tchat; give another name "
                    "with -o, or remove it",
                    path));
  if (!take_line(text, at, line)) return contents;
  contents.first_line = 2;
  for (; take_line(text, at, line) && line != heading_end; ++contents.first_line) {
    const std::size_t blank = line.find(' ', 2);
    if (!line.starts_with("# ") || blank == std::string::npos) return contents;
    contents.identity.emplace_back(line.substr(2, blank - 2), line.substr(blank + 1));
  }
  if (line != heading_end) return contents;
  ++contents.first_line;
  contents.is_there = true;
  contents.whole = at;
  while (take_line(text, at, line)) {
    std::optional<SampleRecord> record = read_record(line);
    if (!record) break;
    contents.records.push_back(std::move(*record));
    contents.whole = at;
  }
  return contents;
}

JournalContents read_journal(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return {};
  if (!std::filesystem::is_regular_file(status))
    throw UserError(
        fmt::format("{}: this is no file, as a journal or part of a sweep is; remove it: rm {}", path, path));
  const std::optional<std::string> text = read_text_if_there(path, "journal of a sweep");
  return text ? parse_journal(*text, path) : JournalContents{};
}

void check_records(const JournalContents& contents, RecordLimits limits, const std::string& path,
                   const std::string& cure) {
  limits.known = known_count(contents.records);
  for (std::size_t r = 0; r < contents.records.size(); ++r)
    if (const std::string fault = fault_of(contents.records[r], limits); !fault.empty())
      throw UserError(fmt::format("{}:{}: {}.\n  The file has been changed since tchat wrote it. {}", path,
                                  contents.first_line + r, fault, cure));
}

std::optional<std::vector<AttractorSample>> take_known(std::vector<SampleRecord>& records) {
  std::vector<AttractorSample> known;
  bool is_complete = false;
  for (SampleRecord& record : records) {
    if (record.start != start_of_known) continue;
    is_complete = record.sample.kind == AttractorKind::none;
    if (is_complete) continue;
    if (record.index == 1) known.clear();  // of a search that did not end
    known.push_back(std::move(record.sample));
  }
  std::erase_if(records, [](const SampleRecord& record) { return record.start == start_of_known; });
  if (!is_complete) return std::nullopt;
  return known;
}

std::string difference(const SweepIdentity& there, const SweepIdentity& here) {
  for (std::size_t i = 0; i < std::max(there.size(), here.size()); ++i) {
    if (i < there.size() && i < here.size()) {
      if (there[i] == here[i]) continue;
      if (there[i].first == here[i].first)
        return fmt::format("{} is {} there and {} here", here[i].first, there[i].second, here[i].second);
    }
    const auto& [key, value] = i < here.size() ? here[i] : there[i];
    return fmt::format("{} {} is {}", key, value, i < here.size() ? "not there" : "there alone");
  }
  return "";
}

SweepJournal::SweepJournal(std::string path, const SweepIdentity& identity, const RecordLimits& limits)
    : path_(std::move(path)) {
  refuse_link(path_);
  JournalContents contents = read_journal(path_);
  if (contents.is_there && contents.records.empty()) contents = {};
  if (contents.is_there)
    if (const std::string what = difference(contents.identity, identity); !what.empty())
      throw UserError(fmt::format(
          "{} holds {} computed values of another sweep: {}; give that command to go on with it, another name with "
          "-o, or --fresh to throw them away",
          path_, contents.records.size(), what));
  check_records(contents, limits, path_, fmt::format("Remove it, and give the command again: rm {}", path_));
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (descriptor_ < 0 && errno == ELOOP) refuse_link(path_);
  if (descriptor_ < 0) fail(path_, "it cannot be written");
  if (::ftruncate(descriptor_, static_cast<off_t>(contents.whole)) != 0) fail(path_, "it cannot be cut");
  if (::lseek(descriptor_, 0, SEEK_END) < 0) fail(path_, "it cannot be written");
  if (!contents.is_there) write(journal_heading(identity));
  records_ = std::move(contents.records);
}

SweepJournal::~SweepJournal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SweepJournal::add(const SampleRecord& record) { write(record_line(record)); }

void SweepJournal::remove() { ::unlink(path_.c_str()); }

void SweepJournal::write(const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(descriptor_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(path_, "writing fails; what was computed before is kept");
    written += static_cast<std::size_t>(count);
  }
}

}  // namespace tchat
