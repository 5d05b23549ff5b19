#include "settings/keyword_form.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>

#include "base/messages.hpp"
#include "base/words.hpp"

namespace tchat {

namespace {

constexpr int deepest_nesting = 3;

bool is_key_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_key_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

class AssignmentParser {
 public:
  AssignmentParser(std::string_view text, Place start) : text_(text), place_(std::move(start)) {}

  std::vector<Assignment> all() {
    std::vector<Assignment> result;
    for (skip_between(true); !at_end(); skip_between(true)) result.push_back(assignment());
    return result;
  }

 private:
  bool at_end() const { return position_ >= text_.size(); }
  char peek() const { return at_end() ? '\n' : text_[position_]; }

  void advance() {
    if (peek() == '\n' && place_.line > 0) ++place_.line;
    ++position_;
  }

  void skip_blanks() {
    while (!at_end() && is_blank(peek())) ++position_;
  }

  /// Blanks, newlines and comments; commas too where asked.
  void skip_between(bool commas) {
    while (!at_end()) {
      const char c = peek();
      if (c == '#')
        skip_comment();
      else if (is_blank(c) || c == '\n' || (commas && c == ','))
        advance();
      else
        return;
    }
  }

  void skip_comment() {
    while (!at_end() && peek() != '\n') ++position_;
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw UserError(fmt::format("{}: found {}; allowed: {}; for example: NTST = 50 or UZR = {{1: [2.5, 3.0]}}",
                                place_.text(), found, expected));
  }

  std::string rest_of_line() const {
    if (at_end()) return "the end of the text";
    return in_quotes(text_.substr(position_, text_.find('\n', position_) - position_));
  }

  Assignment assignment() {
    Assignment result;
    const std::string beginning = rest_of_line();
    result.key = {std::string(key_word()), place_};
    if (result.key.text.empty()) fail(beginning, "KEY = value");
    if (peek() == '(') argument_of(result);
    skip_blanks();
    if (peek() != '=') fail(beginning, "KEY = value");
    advance();
    result.value = value_of(result.key);
    return result;
  }

  std::string_view key_word() {
    const std::size_t begin = position_;
    if (!at_end() && is_key_start(peek()))
      while (!at_end() && is_key_part(peek())) ++position_;
    return text_.substr(begin, position_ - begin);
  }

  void argument_of(Assignment& assignment) {
    const std::size_t begin = position_ + 1;
    const std::size_t end = text_.find_first_of(")\n", begin);
    if (end == std::string_view::npos || text_[end] != ')') fail(rest_of_line(), "a closing parenthesis");
    std::string_view argument = text_.substr(begin, end - begin);
    while (!argument.empty() && is_blank(argument.front())) argument.remove_prefix(1);
    while (!argument.empty() && is_blank(argument.back())) argument.remove_suffix(1);
    assignment.argument = std::string(argument);
    assignment.has_argument = true;
    position_ = end + 1;
  }

  /// An empty value removes a name.
  static bool may_be_empty(const Token& key) {
    const Constant* constant = find_constant(key.text);
    return constant != nullptr && std::holds_alternative<std::string RunSettings::*>(constant->member);
  }

  /// One item, or several without brackets up to the end of the line or the next assignment.
  RawValue value_of(const Token& key) {
    skip_blanks();
    const std::size_t begin = position_;
    const Place place = place_;
    if (at_end() || peek() == '\n' || peek() == '#' || peek() == ',') {
      if (may_be_empty(key)) return RawValue::scalar({"", place});
      fail(fmt::format("nothing after '{} ='", key.text), "a value");
    }
    std::vector<RawValue> items{item(0)};
    std::size_t end = position_;
    while (another_item_follows()) {
      items.push_back(item(0));
      end = position_;
    }
    if (items.size() == 1) return std::move(items.front());
    RawValue list;
    list.shape = RawValue::Shape::list;
    list.token = {std::string(text_.substr(begin, end - begin)), place};
    list.items = std::move(items);
    return list;
  }

  bool another_item_follows() {
    skip_blanks();
    if (!at_end() && peek() == ',') ++position_;
    skip_blanks();
    if (!at_end() && peek() == ',') fail("an empty value before ','", "a value between two commas");
    return !at_end() && peek() != '\n' && peek() != '#' && !begins_with_assignment(text_.substr(position_));
  }

  RawValue item(int depth) {
    if (depth > deepest_nesting) fail("brackets nested too deeply", "a list of values or of lists");
    if (peek() == '[') return bracketed(depth);
    if (peek() == '{') return braced(depth);
    return RawValue::scalar(word());
  }

  Token word() {
    Token token{"", place_};
    const std::size_t begin = position_;
    if (peek() == '\'' || peek() == '"') {
      const std::size_t end = text_.find(peek(), position_ + 1);
      if (end == std::string_view::npos || text_.substr(begin, end - begin).find('\n') != std::string_view::npos)
        fail(rest_of_line(), "a closing quote");
      token.text = std::string(text_.substr(begin + 1, end - begin - 1));
      position_ = end + 1;
      return token;
    }
    skip_word();
    if (position_ == begin) fail(rest_of_line(), "a value");
    token.text = std::string(text_.substr(begin, position_ - begin));
    return token;
  }

  /// Up to what separates words; blanks and commas inside of parentheses do not: max(x, 2) is one.
  void skip_word() {
    int depth = 0;
    for (; !at_end() && peek() != '\n'; ++position_) {
      const char c = peek();
      const bool separates = is_blank(c) || std::string_view(",[]{}:#='\"").find(c) != std::string_view::npos;
      const bool inside = depth > 0 && (is_blank(c) || c == ',');
      if (separates && !inside) return;
      depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    }
  }

  /// The separator after an item of a list or a pair: blanks, newlines and at most one comma.
  void skip_separator() {
    skip_between(false);
    if (!at_end() && peek() == ',') advance();
    skip_between(false);
    if (!at_end() && peek() == ',') fail("an empty value before ','", "a value between two commas");
  }

  RawValue bracketed(int depth) {
    RawValue list;
    list.shape = RawValue::Shape::list;
    list.token.place = place_;
    const std::size_t begin = position_;
    advance();
    for (skip_between(false); peek() != ']'; skip_separator()) {
      if (at_end()) fail("the end of the text inside '['", "a closing ']'");
      list.items.push_back(item(depth + 1));
    }
    advance();
    list.token.text = std::string(text_.substr(begin, position_ - begin));
    return list;
  }

  RawValue braced(int depth) {
    RawValue dictionary;
    dictionary.shape = RawValue::Shape::pairs;
    dictionary.token.place = place_;
    const std::size_t begin = position_;
    advance();
    for (skip_between(false); peek() != '}'; skip_separator()) {
      if (at_end()) fail("the end of the text inside '{'", "a closing '}'");
      Token key = word();
      skip_between(false);
      if (peek() != ':' || at_end()) fail(fmt::format("no ':' after {}", in_quotes(key.text)), "index: value");
      advance();
      skip_between(false);
      dictionary.pairs.push_back({std::move(key), item(depth + 1)});
    }
    advance();
    dictionary.token.text = std::string(text_.substr(begin, position_ - begin));
    return dictionary;
  }

  std::string_view text_;
  Place place_;
  std::size_t position_ = 0;
};

/// Near keywords where there are some; on the command line a word may also be meant for a parameter's name.
[[noreturn]] void refuse_keyword(const Assignment& assignment) {
  const Token& key = assignment.key;
  const std::vector<std::string> near = near_keywords(key.text);
  const std::string cure =
      near.empty() ? "`tchat constants` lists them" : fmt::format("did you mean: {}", fmt::join(near, ", "));
  const bool may_be_parameter =
      near.empty() && key.place.line == 0 && !assignment.has_argument && parse_real(assignment.value.token.text);
  throw UserError(fmt::format("{}: found {}, which is no constant; {}{}", key.place.text(), in_quotes(key.text), cure,
                              may_be_parameter ? fmt::format("; the value of a parameter is written 'PAR({})={}'",
                                                             key.text, assignment.value.token.text)
                                               : ""));
}

}  // namespace

std::vector<Assignment> parse_assignments(std::string_view text, const Place& start) {
  return AssignmentParser(text, start).all();
}

bool begins_with_assignment(std::string_view text) {
  std::size_t i = 0;
  if (text.empty() || !is_key_start(text[0])) return false;
  while (i < text.size() && is_key_part(text[i])) ++i;
  if (i < text.size() && text[i] == '(') {
    i = text.find_first_of(")\n", i);
    if (i == std::string_view::npos || text[i] != ')') return false;
    ++i;
  }
  while (i < text.size() && is_blank(text[i])) ++i;
  return i < text.size() && text[i] == '=';
}

const Constant& constant_of(const Assignment& assignment) {
  const Constant* constant = find_constant(assignment.key.text);
  if (constant == nullptr) refuse_keyword(assignment);
  if (assignment.has_argument && constant->record != command_line_record)
    refuse(*constant, std::string(constant->keyword), assignment.key.place,
           in_quotes(fmt::format("{}({})", assignment.key.text, assignment.argument)),
           "the whole value, not one element of it");
  return *constant;
}

}  // namespace tchat
