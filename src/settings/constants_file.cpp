#include "settings/constants_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "settings/keyword_form.hpp"
#include "settings/settings_check.hpp"

namespace tchat {

namespace {

/// Where the first word of a line ends. A comma inside of parentheses is of the word: max(x,2).
std::size_t word_end(std::string_view line) {
  int depth = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ' ' || c == '\t' || c == '\f' || c == '\v' || c == '/' || (c == ',' && depth == 0)) return i;
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
  }
  return line.size();
}

bool is_separator(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

/// Hands out the values of records one by one.
class RecordReader {
 public:
  RecordReader(std::string_view text, std::string source, Warnings* warnings)
      : rest_(text), source_(std::move(source)), warnings_(warnings) {}

  void begin_record() {
    next_line();
    first_value_line_ = 0;
    repeats_left_ = 0;
    comma_seen_ = true;  // a comma before the first value would be a null value
  }

  /// The next value of the record; `name` is what it is for.
  Token next(const Constant& constant, const std::string& name) {
    if (repeats_left_ > 0) {
      --repeats_left_;
      return repeated_;
    }
    skip_separators(constant, name);
    Token token{std::string(line_.substr(0, word_end(line_))), place()};
    note_continuation(constant);
    line_.remove_prefix(token.text.size());
    comma_seen_ = false;
    if (token.text.find('*') != std::string::npos) token = first_of_repeated(constant, name, token);
    return token;
  }

  /// The rest of the line is commentary. A number there is suspicious: counts too small are the common mistake.
  void end_record(const Constant& last) {
    const std::size_t begin = line_.find_first_not_of(" \t\f\v,");
    if (warnings_ == nullptr || begin == std::string_view::npos) return;
    const std::string_view word = line_.substr(begin, line_.find_first_of(" \t\f\v,/", begin) - begin);
    if (parse_real(word))
      warnings_->push_back(fmt::format("{}: {} after the last value of the record ({}) is taken as commentary",
                                       place().text(), in_quotes(word), last.keyword));
  }

  /// What may explain a later error: the first record that took values from a further line. Empty if there is none.
  const std::string& continuation() const { return continuation_; }

  std::string_view remaining() const { return rest_; }
  /// Of the text that remains.
  Place next_place() const { return {source_, line_number_ + 1, true}; }

 private:
  Place place() const { return {source_, std::max(line_number_, 1), true}; }

  bool next_line() {
    if (rest_.empty()) {
      line_ = {};
      return false;
    }
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_number_;
    return true;
  }

  void note_continuation(const Constant& constant) {
    if (first_value_line_ == 0) first_value_line_ = line_number_;
    if (first_value_line_ == line_number_ || !continuation_.empty()) return;
    continuation_ = fmt::format("; the record {} on line {} has been read on to line {}: does it lack a value?",
                                positional_records()[static_cast<std::size_t>(constant.record - 1)].layout,
                                first_value_line_, line_number_);
  }

  void skip_separators(const Constant& constant, const std::string& name) {
    while (true) {
      while (!line_.empty() && is_separator(line_[0])) line_.remove_prefix(1);
      if (line_.empty()) {
        if (!next_line()) refuse(constant, name, place(), "the end of the file");
      } else if (line_[0] == ',') {
        if (comma_seen_) refuse(constant, name, place(), "',' (a null value)");
        comma_seen_ = true;
        line_.remove_prefix(1);
      } else if (line_[0] == '/') {
        refuse(constant, name, place(), "'/' (the end of a record before its last value)");
      } else {
        return;
      }
    }
  }

  Token first_of_repeated(const Constant& constant, const std::string& name, const Token& token) {
    const std::size_t star = token.text.find('*');
    const auto count = parse_integer(token.text.substr(0, star));
    const std::string value = token.text.substr(star + 1);
    if (!count || *count < 1 || value.empty() || value.find('*') != std::string::npos)
      refuse(constant, name, token.place, in_quotes(token.text) + " (neither a value nor r*v with a repeat count r)");
    repeated_ = {value, token.place};
    repeats_left_ = *count - 1;
    return repeated_;
  }

  std::string_view rest_;
  std::string_view line_;
  std::string source_;
  Warnings* warnings_;
  std::string continuation_;
  int line_number_ = 0;
  int first_value_line_ = 0;
  int repeats_left_ = 0;
  Token repeated_;
  bool comma_seen_ = true;
};

class PositionalForm {
 public:
  PositionalForm(RecordReader& reader, SettingsDraft& draft) : reader_(reader), draft_(draft) {}

  void read() {
    for (int record = 1; record <= static_cast<int>(positional_records().size()); ++record) {
      const std::vector<const Constant*> constants = constants_of_record(record);
      if (std::holds_alternative<MonitorLists>(constants.back()->member))
        read_monitors(*constants.front(), *constants.back());
      else
        read_record(constants);
    }
  }

 private:
  void read_record(const std::vector<const Constant*>& constants) {
    reader_.begin_record();
    int count = 0;  // of the list of the record
    for (const Constant* constant : constants) {
      if (holds_pairs(*constant)) {
        read_pairs(*constant, count);
      } else if (holds_list(*constant)) {
        const bool per_segment = std::holds_alternative<SegmentInteger>(constant->member);
        read_list(*constant, per_segment ? draft_.segments() : count);
      } else {
        draft_.assign(*constant, RawValue::scalar(reader_.next(*constant, std::string(constant->keyword))));
        if (std::holds_alternative<ListCount>(constant->member)) count = draft_.count(*constant);
      }
    }
    if (!holds_pairs(*constants.back())) reader_.end_record(*constants.back());
  }

  static bool holds_pairs(const Constant& constant) {
    return std::holds_alternative<std::vector<IndexedValue> RunSettings::*>(constant.member) ||
           std::holds_alternative<std::vector<UserValue> RunSettings::*>(constant.member);
  }

  static bool holds_list(const Constant& constant) {
    return std::holds_alternative<std::vector<int> RunSettings::*>(constant.member) ||
           std::holds_alternative<SegmentInteger>(constant.member);
  }

  RawValue list_of(const Constant& constant, int count) {
    std::vector<Token> tokens;
    for (int i = 1; i <= count; ++i)
      tokens.push_back(reader_.next(constant, fmt::format("{}({})", constant.keyword, i)));
    return RawValue::list(tokens, tokens.empty() ? Place{} : tokens.front().place);
  }

  void read_list(const Constant& constant, int count) { draft_.assign(constant, list_of(constant, count)); }

  /// Each pair is a record of its own, after the rest of the count's line.
  void read_pairs(const Constant& constant, int count) {
    reader_.end_record(constant);
    RawValue pairs;
    pairs.shape = RawValue::Shape::pairs;
    for (int i = 1; i <= count; ++i) {
      reader_.begin_record();
      Token index = reader_.next(constant, fmt::format("I{}({})", constant.keyword, i));
      Token value = reader_.next(constant, fmt::format("{}({})", constant.keyword, i));
      pairs.token.place = index.place;
      pairs.pairs.push_back({std::move(index), RawValue::scalar(std::move(value))});
      draft_.assign(constant, pairs);  // each time, so that the first wrong pair is the one that is reported
      reader_.end_record(constant);
    }
    if (count == 0) draft_.assign(constant, pairs);
  }

  void read_monitors(const Constant& count_constant, const Constant& list_constant) {
    for (int s = 1; s <= draft_.segments(); ++s) {
      reader_.begin_record();
      const std::string name = fmt::format("{}({})", count_constant.keyword, s);
      const int count = integer_value(count_constant, name, RawValue::scalar(reader_.next(count_constant, name)),
                                      count_constant.limits);
      draft_.add_monitored(list_constant, list_of(list_constant, count));
      reader_.end_record(list_constant);
    }
  }

  RecordReader& reader_;
  SettingsDraft& draft_;
};

/// One line after the last record.
void read_extension_line(std::string_view line, const Place& place, SettingsDraft& draft, Warnings* warnings) {
  const std::size_t begin = line.find_first_not_of(" \t\f\v");
  if (begin == std::string_view::npos || line[begin] == '#') return;
  line.remove_prefix(begin);
  if (!begins_with_assignment(line)) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t\f\v,=:("));
    if (parse_real(word) || find_constant(word) != nullptr)
      throw UserError(
          fmt::format("{}: found {} after the last record; allowed: KEY = value lines, comments after #; for example: "
                      "GRSTOP = 0. If "
                      "it belongs to a record, check the counts NICP, NTHL, NTHU, NUZR, GCNOSEG, GCHNO",
                      place.text(), in_quotes(line)));
    if (warnings != nullptr) warnings->push_back(fmt::format("{}: ignored: {}", place.text(), in_quotes(line)));
    return;
  }
  for (const Assignment& assignment : parse_assignments(line, place)) {
    const Constant& constant = constant_of(assignment);
    if (constant.record != extension_record)
      refuse(constant, std::string(constant.keyword), place, "a KEY = value line",
             constant.record == command_line_record ? "on the command line only, or '# PAR(2) = 0.8' in the .dat file"
                                                    : "its value in the positional records above only");
    draft.assign(constant, assignment.value);
  }
}

}  // namespace

void read_positional_form(std::string_view text, const std::string& source, SettingsDraft& draft, Warnings* warnings) {
  RecordReader reader(text, source, warnings);
  try {
    PositionalForm(reader, draft).read();
  } catch (const UserError& error) {
    throw UserError(error.what() + reader.continuation());
  }
  std::string_view rest = reader.remaining();
  Place place = reader.next_place();
  for (; !rest.empty(); ++place.line) {
    const std::size_t end = rest.find('\n');
    read_extension_line(rest.substr(0, end), place, draft, warnings);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
}

namespace {

constexpr std::size_t longest_file = 4'000'000;  // far more than any constants need

constexpr std::string_view two_forms =
    "allowed: records of numbers, the first NDIM IPS IRS ILP, or KEY = value lines; for example: 5 180 1 1 or NDIM = 5";

std::string file_contents(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw UserError(fmt::format("{}: no such constants file; give its NAME or path with -c", path));
  if (std::filesystem::is_directory(status))
    throw UserError(fmt::format("{}: is a directory; give a constants file, for example {}/gc.NAME", path, path));
  std::optional<std::string> text = read_text_if_there(path, "constants", longest_file + 1);
  if (!text) throw UserError(fmt::format("{}: cannot be read: {}; check its permissions", path, std::strerror(errno)));
  if (text->size() > longest_file)
    throw UserError(fmt::format("{}: longer than {} bytes, no constants file; {}", path, longest_file, two_forms));
  return *std::move(text);
}

/// Newlines for CRLF and CR, no byte order mark.
std::string with_newlines(std::string_view text) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    result += text[i] == '\r' ? '\n' : text[i];
  }
  return result;
}

void refuse_binary(std::string_view text, const std::string& name) {
  const auto control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && std::string_view("\n\t\r\f\v\x1a").find(c) == std::string_view::npos;
  };
  const auto found = std::find_if(text.begin(), text.end(), control);
  if (found == text.end()) return;
  throw UserError(fmt::format("{}:{}: found a byte with the value {}, so this is no text file; {}", name,
                              1 + std::count(text.begin(), found, '\n'), static_cast<int>(*found), two_forms));
}

ConstantsForm form_of(std::string_view text, const std::string& name) {
  const std::size_t first = text.find_first_not_of(" \t\n\f\v\x1a");
  if (first == std::string_view::npos) throw UserError(fmt::format("{}: found an empty file; {}", name, two_forms));
  const bool number = std::string_view("0123456789+-.").find(text[first]) != std::string_view::npos;
  return number ? ConstantsForm::positional : ConstantsForm::keyword;
}

/// A file of `KEY = value` lines; each constant at most once.
void read_keyword_form(std::string_view text, const std::string& name, SettingsDraft& draft) {
  std::map<std::string_view, int> lines;
  for (const Assignment& assignment : parse_assignments(text, Place{name, 1})) {
    const Constant& constant = constant_of(assignment);
    const Place& place = assignment.key.place;
    if (constant.record == command_line_record)
      refuse(constant, "PAR", place, in_quotes("PAR"),
             "on the command line only, or '# PAR(2) = 0.8' in the .dat file; leave it out here");
    const auto [earlier, first] = lines.emplace(constant.keyword, place.line);
    if (!first)
      refuse(constant, std::string(constant.keyword), place, "it again",
             fmt::format("once (it is given on line {} already)", earlier->second));
    draft.assign(constant, assignment.value);
  }
}

void assign_override(SettingsDraft& draft, const Assignment& assignment) {
  const Constant& constant = constant_of(assignment);
  if (assignment.has_argument)
    draft.assign_parameter(constant, {assignment.argument, assignment.key.place}, assignment.value);
  else
    draft.assign(constant, assignment.value);
}

}  // namespace

RunSettings read_constants_text(std::string_view given, const std::string& name, Warnings* warnings) {
  refuse_binary(given, name);
  const std::string text = with_newlines(given);
  SettingsDraft draft(RunSettings{}, name);
  if (form_of(text, name) == ConstantsForm::positional)
    read_positional_form(text, name, draft, warnings);
  else
    read_keyword_form(text, name, draft);
  return draft.finish(warnings);
}

ConstantsForm constants_form(const std::string& path) { return form_of(with_newlines(file_contents(path)), path); }

RunSettings read_constants_file(const std::string& path, Warnings* warnings) {
  return read_constants_text(file_contents(path), path, warnings);
}

void apply_overrides(RunSettings& settings, std::span<const std::string> key_values, Warnings* warnings) {
  const Place place{"command line"};
  SettingsDraft draft(settings, place.source);
  for (const std::string& key_value : key_values) {
    const std::vector<Assignment> assignments = parse_assignments(key_value, place);
    if (assignments.empty())
      throw UserError(
          fmt::format("{}: found {}; allowed: KEY=VALUE; for example: DS=-0.01", place.text(), in_quotes(key_value)));
    for (const Assignment& assignment : assignments) assign_override(draft, assignment);
  }
  RunSettings changed = draft.finish(warnings);
  if (warnings != nullptr && draft.is_given("GCHGRZIND") && !draft.is_given("GCIPSI"))
    if (const std::string sentence = unlocated_contacts(settings, changed); !sentence.empty())
      warnings->push_back(fmt::format("{}: {}", place.text(), sentence));
  settings = std::move(changed);
}

bool is_overridden(std::span<const std::string> key_values, std::string_view keyword) {
  return std::any_of(key_values.begin(), key_values.end(), [&](const std::string& text) {
    const std::vector<Assignment> assignments = parse_assignments(text, Place{"command line"});
    return std::any_of(assignments.begin(), assignments.end(),
                       [&](const Assignment& a) { return constant_of(a).keyword == keyword; });
  });
}

}  // namespace tchat
