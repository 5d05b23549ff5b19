#include "simulate/sample_record.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>

#include "base/levels.hpp"

namespace tchat {

namespace {

/// Before what a line has only if it was asked for; no message begins with it.
constexpr const char* largest_values = "@max";
constexpr const char* events_seen = "@events";
constexpr const char* chatter_left_out = "@without_chatter";

/// FNV-1a: tells a line that was cut or damaged.
std::uint64_t line_hash(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

/// Words and numbers, each with a blank behind it.
class LineWriter {
 public:
  void number(double value) { fmt::format_to(std::back_inserter(text_), "{} ", value); }
  void integer(long value) { fmt::format_to(std::back_inserter(text_), "{} ", value); }
  void word(const std::string& word) { (text_ += word) += ' '; }
  void vector(const Eigen::VectorXd& values) {
    integer(values.size());
    for (const double value : values) number(value);
  }
  void matrix(const Eigen::MatrixXd& values) {
    integer(values.rows());
    integer(values.cols());
    for (const double value : values.reshaped()) number(value);
  }
  void integers(const std::vector<int>& values) {
    integer(static_cast<long>(values.size()));
    for (const int value : values) integer(value);
  }
  void index_vectors(const std::vector<IndexVector>& values) {
    integer(static_cast<long>(values.size()));
    for (const IndexVector& v : values) {
      integer(v.field);
      integer(v.event);
      integer(v.jump);
    }
  }
  /// The line so far, and the rest of it as it is.
  std::string finished(const std::string& rest) const { return hashed_line(text_ + rest); }

 private:
  std::string text_;
};

/// Reads what LineWriter wrote; after the first fault everything is zero and `ok` false.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  bool ok() const { return ok_; }
  std::string word() {
    const std::size_t end = text_.find(' ');
    if (end == std::string_view::npos) ok_ = false;
    if (!ok_) return "";
    std::string word(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return word;
  }
  double number() {
    const std::string text = word();
    double value = 0.0;
    if (ok_ && std::from_chars(text.data(), text.data() + text.size(), value).ptr != text.data() + text.size())
      ok_ = false;
    return value;
  }
  long integer() {
    const std::string text = word();
    long value = 0;
    if (ok_ && std::from_chars(text.data(), text.data() + text.size(), value).ptr != text.data() + text.size())
      ok_ = false;
    return value;
  }
  /// A number of entries: no more than there are characters.
  long size() {
    const long value = integer();
    if (value < 0 || value > static_cast<long>(text_.size())) ok_ = false;
    return ok_ ? value : 0;
  }
  Eigen::VectorXd vector() {
    Eigen::VectorXd values(size());
    for (double& value : values) value = number();
    return values;
  }
  Eigen::MatrixXd matrix() {
    const long rows = size();
    const long cols = size();
    if (rows * cols > static_cast<long>(text_.size())) ok_ = false;
    Eigen::MatrixXd values(ok_ ? rows : 0, ok_ ? cols : 0);
    for (double& value : values.reshaped()) value = number();
    return values;
  }
  /// An integer that no array is as long as is as good as damage.
  int small_integer() {
    const long value = integer();
    if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) ok_ = false;
    return ok_ ? static_cast<int>(value) : 0;
  }
  std::vector<int> integers() {
    std::vector<int> values(static_cast<std::size_t>(size()));
    for (int& value : values) value = small_integer();
    return values;
  }
  std::vector<IndexVector> index_vectors() {
    std::vector<IndexVector> values(static_cast<std::size_t>(size()));
    for (IndexVector& v : values) {
      v.field = small_integer();
      v.event = small_integer();
      v.jump = small_integer();
    }
    return values;
  }
  std::string rest() const { return std::string(text_); }

 private:
  std::string_view text_;
  bool ok_ = true;
};

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

}  // namespace

std::string hashed_line(const std::string& text) { return fmt::format("{} {:016x}\n", text, line_hash(text)); }

std::string record_line(const SampleRecord& record) {
  const AttractorSample& sample = record.sample;
  LineWriter line;
  line.integer(static_cast<long>(record.index));
  line.integer(record.start);
  line.integer(sample.known);
  line.word(to_string(sample.kind));
  line.index_vectors(sample.signature);
  line.number(sample.period);
  line.integer(sample.impacts);
  line.number(sample.penetration);
  line.vector(sample.exponents);
  line.vector(sample.errors);
  line.matrix(sample.sections);
  line.integers(sample.section_events);
  line.vector(sample.section_penetrations);
  line.matrix(sample.identity);
  line.vector(sample.sizes);
  line.vector(sample.last.x);
  line.index_vectors(sample.last.watched);
  if (sample.largest.size() > 0) {
    line.word(largest_values);
    line.matrix(sample.largest);
  }
  if (sample.events > 0) {
    line.word(events_seen);
    line.integer(sample.events);
  }
  if (!sample.without_chatter.empty()) {
    line.word(chatter_left_out);
    line.index_vectors(sample.without_chatter);
  }
  return line.finished(one_line(sample.message));
}

std::optional<SampleRecord> read_record(const std::string& line) {
  const std::size_t blank = line.rfind(' ');
  if (blank == std::string::npos) return std::nullopt;
  const std::string_view body = std::string_view(line).substr(0, blank);
  if (fmt::format("{:016x}", line_hash(body)) != std::string_view(line).substr(blank + 1)) return std::nullopt;
  LineReader reader(body);
  SampleRecord record;
  AttractorSample& sample = record.sample;
  record.index = static_cast<std::size_t>(reader.integer());
  record.start = reader.small_integer();
  sample.known = reader.small_integer();
  const std::optional<AttractorKind> kind = attractor_kind(reader.word());
  sample.signature = reader.index_vectors();
  sample.period = reader.number();
  sample.impacts = reader.small_integer();
  sample.penetration = reader.number();
  sample.exponents = reader.vector();
  sample.errors = reader.vector();
  sample.sections = reader.matrix();
  sample.section_events = reader.integers();
  sample.section_penetrations = reader.vector();
  sample.identity = reader.matrix();
  sample.sizes = reader.vector();
  sample.last.x = reader.vector();
  sample.last.watched = reader.index_vectors();
  if (reader.rest().starts_with(std::string(largest_values) + ' ')) {
    reader.word();
    sample.largest = reader.matrix();
  }
  if (reader.rest().starts_with(std::string(events_seen) + ' ')) {
    reader.word();
    sample.events = reader.integer();
  }
  if (reader.rest().starts_with(std::string(chatter_left_out) + ' ')) {
    reader.word();
    sample.without_chatter = reader.index_vectors();
  }
  sample.message = reader.rest();
  if (!reader.ok() || !kind) return std::nullopt;
  sample.kind = *kind;
  return record;
}

}  // namespace tchat
