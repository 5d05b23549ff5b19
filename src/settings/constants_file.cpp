#include "settings/constants_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "settings/keyword_form.hpp"
#include "settings/positional_form.hpp"
#include "settings/settings_check.hpp"

namespace tchat {

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
