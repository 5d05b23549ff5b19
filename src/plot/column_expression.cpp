#include "plot/column_expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <sstream>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "plot/gnuplot.hpp"
#include "plot/gnuplot_script.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::array<std::string_view, 28> words_of_gnuplot = {
    "abs",  "acos", "acosh", "asin", "asinh", "atan",  "atan2", "atanh", "besj0", "besj1",
    "ceil", "cos",  "cosh",  "erf",  "exp",   "floor", "gamma", "int",   "log",   "log10",
    "norm", "pi",   "sgn",   "sin",  "sinh",  "sqrt",  "tan",   "tanh"};

bool is_decimal(char c) { return c >= '0' && c <= '9'; }
bool continues_word(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || c == '_' || byte >= 0x80;
}

struct FormulaToken {
  enum class Kind { name, number, word, sign };
  Kind kind = Kind::sign;
  std::string text;
};

std::size_t length_of_number(std::string_view text) {
  std::size_t k = 0;
  while (k < text.size() && (is_decimal(text[k]) || text[k] == '.')) ++k;
  if (k == 0 || k >= text.size() || (text[k] != 'e' && text[k] != 'E')) return k;
  std::size_t exponent = k + 1;
  if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
  if (exponent >= text.size() || !is_decimal(text[exponent])) return k;
  while (exponent < text.size() && is_decimal(text[exponent])) ++exponent;
  return exponent;
}

std::size_t length_of_word(std::string_view text) {
  std::size_t k = 0;
  while (k < text.size() && continues_word(text[k])) ++k;
  return k;
}

std::size_t length_of_sign(std::string_view text) {
  for (const std::string_view sign : {"**", "<=", ">=", "==", "!=", "&&", "||"})
    if (text.starts_with(sign)) return sign.size();
  return std::string_view("+-*/()<>!?:,").find(text.front()) != std::string_view::npos ? 1 : 0;
}

/// Splits and checks nothing but that every part is something.
class FormulaTokens {
 public:
  FormulaTokens(std::string_view text, const KnownNames& known, std::string where)
      : known_(known), where_(std::move(where)) {
    while (!text.empty()) {
      if (text.front() == ' ') {
        text.remove_prefix(1);
        continue;
      }
      const FormulaToken token = next(text);
      text.remove_prefix(token.text.size());
      list_.push_back(token);
    }
  }

  const std::vector<FormulaToken>& list() const { return list_; }

 private:
  FormulaToken next(std::string_view text) const {
    const auto part = [&text](FormulaToken::Kind kind, std::size_t size) {
      return FormulaToken{kind, std::string(text, 0, size)};
    };
    if (const std::size_t size = length_of_number(text); size > 0)
      return number(part(FormulaToken::Kind::number, size));
    if (const std::size_t size = known_.length(text); size > 0) return part(FormulaToken::Kind::name, size);
    if (const std::size_t size = length_of_word(text); size > 0) return word(part(FormulaToken::Kind::word, size));
    if (const std::size_t size = length_of_sign(text); size > 0) return part(FormulaToken::Kind::sign, size);
    if (text.front() == '^') throw UserError(fmt::format("{}: a power is written x**2, not x^2", where_));
    throw UserError(
        fmt::format("{}: {} cannot stand in an expression; it is made of columns ({}), numbers, signs such as "
                    "+ - * / ** ( ) and functions such as sqrt(x)",
                    where_, in_quotes(text.substr(0, length_of_character(text))), known_.list));
  }

  static std::size_t length_of_character(std::string_view text) {
    std::size_t size = 1;
    while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) ++size;
    return size;
  }

  FormulaToken number(FormulaToken token) const {
    if (!parse_real(token.text)) throw UserError(fmt::format("{}: {} is no number", where_, in_quotes(token.text)));
    return token;
  }

  FormulaToken word(FormulaToken token) const {
    if (std::find(words_of_gnuplot.begin(), words_of_gnuplot.end(), token.text) == words_of_gnuplot.end())
      throw UserError(
          fmt::format("{}: {} is neither a column ({}) nor a function", where_, in_quotes(token.text), known_.list));
    return token;
  }

  const KnownNames& known_;
  std::string where_;
  std::vector<FormulaToken> list_;
};

/// 1/2 is a half, and x**2 is real for a negative x.
std::string real_number(const std::string& text, bool is_exponent) {
  const bool integer = text.find_first_not_of("0123456789") == std::string::npos;
  return integer && !is_exponent ? text + ".0" : text;
}

/// The sentence in what gnuplot prints: behind "line 0:", or the first line that is not only a pointer into the text.
std::string complaint(const std::string& output) {
  std::istringstream in(output);
  std::string first;
  for (std::string line; std::getline(in, line);) {
    if (const auto at = line.find("line "); at != std::string::npos)
      if (const auto colon = line.find(": ", at); colon != std::string::npos)
        return std::string(line, colon + 2, line.find_last_not_of(' ') - colon - 1);
    const bool says_something = line.find_first_not_of(" ^") != std::string::npos && !line.starts_with("gnuplot>");
    if (first.empty() && says_something) first = line;
  }
  return first.empty() ? "no value came back" : first;
}

}  // namespace

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char c, unsigned char d) { return std::tolower(c) == std::tolower(d); });
}

std::size_t length_of_name(std::string_view text, const std::vector<std::string>& names) {
  std::size_t longest = 0;
  for (const std::string& name : names) {
    if (name.empty() || !same_letters(text.substr(0, name.size()), name)) continue;
    const bool ends = name.size() == text.size() || !continues_word(name.back()) || !continues_word(text[name.size()]);
    if (ends) longest = std::max(longest, name.size());
  }
  return longest;
}

bool looks_like_expression(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return std::ispunct(static_cast<unsigned char>(c)) != 0 && c != '_' && c != '.'; });
}

ColumnExpression parse_expression(std::string_view text, const KnownNames& known, const std::string& where) {
  ColumnExpression expression;
  bool after_power = false;
  const FormulaTokens tokens(text, known, where);
  for (const FormulaToken& token : tokens.list()) {
    if (!expression.formula.empty()) expression.formula += ' ';
    if (token.kind == FormulaToken::Kind::name) {
      const auto known_name = std::find(expression.names.begin(), expression.names.end(), token.text);
      expression.formula += fmt::format("c{}", known_name - expression.names.begin() + 1);
      if (known_name == expression.names.end()) expression.names.push_back(token.text);
    } else {
      expression.formula +=
          token.kind == FormulaToken::Kind::number ? real_number(token.text, after_power) : token.text;
    }
    after_power = token.text == "**";
  }
  if (expression.names.empty())
    throw UserError(fmt::format("{}: there is no column in it; the columns are {}", where, known.list));
  return expression;
}

LabelText expression_label(std::string_view text, const KnownNames& known,
                           const std::function<LabelText(const std::string&)>& label) {
  LabelText result;
  bool after_power = false;
  const FormulaTokens tokens(text, known, "");
  for (const FormulaToken& token : tokens.list()) {
    if (token.text == "**") {
      after_power = true;
      continue;
    }
    LabelText part = plain_text(token.text);
    if (token.kind == FormulaToken::Kind::name) part = label(token.text);
    if (token.text == "*") part = plain_text("·");
    if (token.text == "-") part = plain_text("−");
    if (token.text == "pi" && token.kind == FormulaToken::Kind::word) part = plain_text("π");
    if (after_power && token.kind == FormulaToken::Kind::number) part = {fmt::format("^{{{}}}", token.text), true};
    if (after_power && token.kind != FormulaToken::Kind::number) part = joined(plain_text("^"), part);
    after_power = false;
    result = joined(result, part);
  }
  return result;
}

std::vector<double> evaluate(const ColumnExpression& expression, const std::vector<std::vector<double>>& rows,
                             const std::string& where) {
  const std::string output = gnuplot_output(values_script(expression.formula, expression.names.size(), rows));
  std::vector<double> values;
  std::istringstream in(output);
  for (std::string word; in >> word;) {
    const auto value = word == "nan" || word == "-nan" ? std::numeric_limits<double>::quiet_NaN()
                       : word == "inf" || word == "-inf"
                           ? std::numeric_limits<double>::infinity()
                           : parse_real(word).value_or(-std::numeric_limits<double>::infinity());
    if (value == -std::numeric_limits<double>::infinity()) break;  // no number: gnuplot complains
    values.push_back(value);
  }
  if (values.size() != rows.size())
    throw UserError(fmt::format("{}: gnuplot does not understand this expression ({})", where, complaint(output)));
  return values;
}

}  // namespace tchat
