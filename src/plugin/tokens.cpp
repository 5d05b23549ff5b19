#include "plugin/tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <tuple>

#include "base/messages.hpp"
#include "base/words.hpp"

namespace tchat::formulas {

namespace {

constexpr std::size_t most_told = 10;
constexpr std::size_t longest_shown_line = 100;

std::string_view line_of(std::string_view text, int number) {
  for (int line = 1; line < number; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return "";
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The line of the text with a mark below the place; "" when the line is too long to be shown, or holds bytes whose
/// width on a terminal is not one.
std::string shown_place(std::string_view text, Position at) {
  std::string line(line_of(text, at.line));
  std::replace(line.begin(), line.end(), '\t', ' ');
  const bool plain = std::all_of(line.begin(), line.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  if (!plain || line.size() > longest_shown_line) return "";
  return fmt::format("\n    {}\n    {:>{}}", line, '^', at.column);
}

}  // namespace

void FormulaErrors::throw_if_any(const std::string& path, std::string_view text) const {
  if (errors_.empty()) return;
  std::vector<FormulaError> sorted = errors_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const FormulaError& a, const FormulaError& b) {
    return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
  });
  std::string message;
  for (std::size_t k = 0; k < std::min(most_told, sorted.size()); ++k) {
    const auto& [at, what] = sorted[k];
    if (k > 0) message += '\n';
    message += at.line == 0 ? fmt::format("{}: {}", path, what)
                            : fmt::format("{}:{}:{}: {}{}", path, at.line, at.column, what, shown_place(text, at));
  }
  if (sorted.size() > most_told) message += fmt::format("\n{} more mistakes are not shown", sorted.size() - most_told);
  throw UserError(message);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const std::vector<std::string> near = near_words(word, known);
  if (near.empty()) return "";
  return fmt::format(" (did you mean '{}'?)", near.front());
}

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool continues_name(char c) { return begins_name(c) || is_digit(c); }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// Longer ones first; the last ones have no meaning but in what users bring from elsewhere, which is told in better
/// words.
constexpr std::array<std::string_view, 32> symbols = {"**", "->", "<=", ">=", "==", "!=", "&&", "||", "+",  "-", "*",
                                                      "/",  "^",  "(",  ")",  ",",  ";",  ":",  "=",  "'",  "<", ">",
                                                      "&",  "|",  "[",  "]",  "{",  "}",  "@",  "!",  "\"", "%"};

/// One spelling for each meaning.
std::string spelled(std::string_view symbol) {
  if (symbol == "**") return "^";
  if (symbol == "&" || symbol == "&&") return "and";
  if (symbol == "|" || symbol == "||") return "or";
  return std::string(symbol);
}

/// Bytes of the character that begins the text, of UTF-8 too.
std::size_t character_length(std::string_view text) {
  std::size_t length = 1;
  while (length < text.size() && length < 4 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) ++length;
  return length;
}

class Tokenizer {
 public:
  Tokenizer(std::string_view text, FormulaErrors& errors) : text_(text), errors_(errors) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  std::vector<Statement> all() {
    std::vector<Statement> statements;
    while (!text_.empty()) {
      bool sound = true;
      Statement tokens;
      try {
        tokens = statement();
      } catch (FormulaError& error) {
        errors_.add(std::move(error));
        sound = false;
        skip_line();
      }
      if (sound && tokens.size() > 1) statements.push_back(std::move(tokens));
    }
    return statements;
  }

 private:
  /// Up to and with the newline.
  Statement statement() {
    Statement tokens;
    while (!text_.empty() && text_[0] != '\n') {
      if (text_[0] == '#')
        drop(text_.find('\n'));
      else if (is_blank(text_[0]))
        drop(1);
      else if (text_[0] == '\\')
        continue_on_next_line();
      else
        tokens.push_back(token());
    }
    tokens.push_back({Token::Kind::end, "", 0.0, at_});
    new_line();
    return tokens;
  }

  void continue_on_next_line() {
    const Position at = at_;
    drop(1);
    while (!text_.empty() && is_blank(text_[0])) drop(1);
    if (!text_.empty() && text_[0] == '#') drop(text_.find('\n'));
    if (!text_.empty() && text_[0] != '\n')
      throw FormulaError{at, "a backslash continues the line in the next one, so nothing may follow it"};
    new_line();
  }

  Token token() {
    if (begins_name(text_[0])) return name();
    if (is_digit(text_[0]) || (text_[0] == '.' && text_.size() > 1 && is_digit(text_[1]))) return number();
    for (const std::string_view symbol : symbols)
      if (text_.starts_with(symbol)) return taken(Token::Kind::symbol, symbol.size(), spelled(symbol));
    const std::string character(text_.substr(0, character_length(text_)));
    throw FormulaError{
        at_, fmt::format("the character '{}' has no meaning here; names have letters a to z, digits and _, operators "
                         "are + - * / ^, comments begin with #",
                         character)};
  }

  Token name() {
    std::size_t length = 1;
    while (length < text_.size() && continues_name(text_[length])) ++length;
    return taken(Token::Kind::name, length, std::string(text_.substr(0, length)));
  }

  /// 12, 1.5, .5, 2., 1e-3 and Fortran's 1d-3.
  Token number() {
    std::size_t length = 0;
    const auto take_digits = [&] {
      while (length < text_.size() && is_digit(text_[length])) ++length;
    };
    take_digits();
    if (length < text_.size() && text_[length] == '.') ++length, take_digits();
    length += exponent_length(text_.substr(length));
    Token result = taken(Token::Kind::number, length, std::string(text_.substr(0, length)));
    result.number = value_of(result);
    refuse_directly_after(result);
    return result;
  }

  /// 2x and 1.2.3
  void refuse_directly_after(const Token& number) {
    if (text_.empty() || (!continues_name(text_[0]) && text_[0] != '.')) return;
    const Position at = at_;
    const std::string follows = begins_name(text_[0]) ? name().text : std::string(1, text_[0]);
    throw FormulaError{at,
                       fmt::format("'{1}' follows the number {0} directly; write an operator between them, as {0}*{1}",
                                   number.text, follows)};
  }

  static std::size_t exponent_length(std::string_view text) {
    if (text.empty() || std::string_view("eEdD").find(text[0]) == std::string_view::npos) return 0;
    std::size_t length = 1;
    if (length < text.size() && (text[length] == '+' || text[length] == '-')) ++length;
    const std::size_t digits = length;
    while (length < text.size() && is_digit(text[length])) ++length;
    return length > digits ? length : 0;
  }

  static double value_of(const Token& token) {
    if (const std::optional<double> value = parse_real(token.text)) return *value;
    throw FormulaError{token.at, fmt::format("the number {} is out of the range of numbers, about 1e-308 to 1e308",
                                             token.text.substr(0, 40))};
  }

  Token taken(Token::Kind kind, std::size_t length, std::string text) {
    Token result{kind, std::move(text), 0.0, at_};
    drop(length);
    return result;
  }

  void drop(std::size_t length) {
    length = std::min(length, text_.size());
    text_.remove_prefix(length);
    at_.column += static_cast<int>(length);
  }

  void new_line() {
    if (!text_.empty()) text_.remove_prefix(1);
    at_ = {at_.line + 1, 1};
  }

  void skip_line() {
    drop(text_.find('\n'));
    new_line();
  }

  std::string_view text_;
  FormulaErrors& errors_;
  Position at_;
};

}  // namespace

std::vector<Statement> read_statements(std::string_view text, FormulaErrors& errors) {
  return Tokenizer(text, errors).all();
}

const Token& TokenReader::next() {
  const Token& token = peek();
  if (!token.is_end()) ++at_;
  return token;
}

bool TokenReader::accept(std::string_view what) {
  if (!peek().is(what)) return false;
  next();
  return true;
}

void TokenReader::expect(std::string_view what, const std::string& cure) {
  if (!accept(what))
    throw FormulaError{peek().at, fmt::format("'{}' is expected here, not {}; {}", what, shown(peek()), cure)};
}

const Token& TokenReader::expect_name(const std::string& role) {
  if (!peek().is_name())
    throw FormulaError{peek().at,
                       fmt::format("the name of {} is expected here, not {}{}", role, shown(peek()), hint())};
  return next();
}

void TokenReader::expect_end() const {
  if (peek().is_end()) return;
  throw FormulaError{
      peek().at, fmt::format("an operator or the end of the line is expected here, not {}{}", shown(peek()), hint())};
}

std::string TokenReader::hint() const {
  const auto is_number = [](const Token& token) { return token.kind == Token::Kind::number; };
  const std::size_t comma = peek().is(",") ? at_ : at_ - 1;  // "2,0*z", or "z=0,05" read as two settings
  if (at_ > 1 && comma > 0 && tokens_[comma].is(",") && is_number(tokens_[comma - 1]) &&
      is_number(peek(comma + 1 - at_)))
    return fmt::format("; decimals are written with a point, as {}.{}", tokens_[comma - 1].text,
                       peek(comma + 1 - at_).text);
  const bool side_by_side = at_ > 0 && (tokens_[at_ - 1].is_name() || is_number(tokens_[at_ - 1]));
  if (side_by_side && (peek().is_name() || is_number(peek())))
    return fmt::format("; write an operator between them, as {}*{}, or the comma of a list", tokens_[at_ - 1].text,
                       peek().text);
  return "";
}

std::string shown(const Token& token) {
  return token.is_end() ? "the end of the line" : fmt::format("'{}'", token.text.substr(0, 40));
}

}  // namespace tchat::formulas
