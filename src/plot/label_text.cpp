#include "plot/label_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr double subscript_size = 0.8;

constexpr std::array<std::pair<std::string_view, std::string_view>, 34> greek = {{
    {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"},   {"delta", "δ"},  {"epsilon", "ε"}, {"zeta", "ζ"},   {"eta", "η"},
    {"theta", "θ"}, {"iota", "ι"},  {"kappa", "κ"},   {"lambda", "λ"}, {"mu", "μ"},      {"nu", "ν"},     {"xi", "ξ"},
    {"pi", "π"},    {"rho", "ρ"},   {"sigma", "σ"},   {"tau", "τ"},    {"upsilon", "υ"}, {"phi", "φ"},    {"chi", "χ"},
    {"psi", "ψ"},   {"omega", "ω"}, {"Gamma", "Γ"},   {"Delta", "Δ"},  {"Theta", "Θ"},   {"Lambda", "Λ"}, {"Xi", "Ξ"},
    {"Pi", "Π"},    {"Sigma", "Σ"}, {"Upsilon", "Υ"}, {"Phi", "Φ"},    {"Psi", "Ψ"},     {"Omega", "Ω"},
}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// In markup these characters are commands.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("{}_^@&~\\").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string_view greek_letter(std::string_view name) {
  for (const auto& [word, letter] : greek)
    if (word == name) return letter;
  return {};
}

/// "omega" -> letter, "x12" -> x with subscript, "x_front" -> likewise; nothing for other words.
std::string symbol(std::string_view word) {
  std::size_t letters = 0;
  while (letters < word.size() && is_letter(word[letters])) ++letters;
  const std::string_view base = word.substr(0, letters);
  std::string_view rest = word.substr(letters);
  if (base.empty()) return "";
  if (rest.starts_with('_')) rest.remove_prefix(1);
  const bool index = std::all_of(rest.begin(), rest.end(), [](char c) { return is_digit(c) || is_letter(c); });
  const std::string_view letter = greek_letter(base);
  const bool short_name = base.size() <= 2 || !letter.empty();
  if (!short_name || !index || (word.ends_with('_'))) return "";
  const std::string head(letter.empty() ? base : letter);
  return rest.empty() ? head : fmt::format("{}_{{{}}}", head, rest);
}

std::string word_as_mathematics(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 5> words = {
      {{"MAX", "max"}, {"MIN", "min"}, {"INTEGRAL", "integral of"}, {"L2-NORM", "L_2 norm"}, {"PERIOD", "period"}}};
  for (const auto& [heading, text] : words)
    if (word == heading) return std::string(text);
  const std::string found = symbol(word);
  return found.empty() ? escaped(word) : found;
}

/// Advance of one character of a sans-serif font, in units of the font's size.
double character_width(char c) {
  if (std::string_view("ijlI|.,:;'! ").find(c) != std::string_view::npos) return 0.32;
  if (std::string_view("frt()[]-/").find(c) != std::string_view::npos) return 0.40;
  if (std::string_view("mW%@").find(c) != std::string_view::npos) return 0.98;
  if (std::string_view("Mw=+<>~").find(c) != std::string_view::npos) return 0.88;
  if (std::string_view("DGHNOQU&").find(c) != std::string_view::npos) return 0.78;
  if (static_cast<unsigned char>(c) == 0xE2) return 0.95;  // first byte of the ellipsis and the minus sign
  return c >= 'A' && c <= 'Z' ? 0.70 : 0.62;
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

}  // namespace

LabelText plain_text(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  return {result, false};
}

LabelText mathematical_name(std::string_view name) {
  LabelText result{"", true};
  for (const std::string_view word : split_words(name)) {
    if (!result.text.empty()) result.text += ' ';
    result.text += word_as_mathematics(word);
  }
  return result;
}

LabelText xi_name(const std::vector<int>& n) {
  const bool in_a_row = n.size() > 2 && n.back() - n.front() + 1 == static_cast<int>(n.size());
  const std::string subscript =
      in_a_row ? fmt::format("{}…{}", n.front(), n.back()) : fmt::format("{}", fmt::join(n, ","));
  return {fmt::format("ξ_{{{}}}", subscript), true};
}

LabelText number_text(double value) {
  std::string text = fmt::format("{:.5g}", value);
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 1)) text.replace(at, 1, "−");
  return {text, false};
}

LabelText joined(const LabelText& first, const LabelText& second) {
  if (first.empty()) return second;
  if (second.empty()) return first;
  if (!first.markup && !second.markup) return {first.text + second.text, false};
  return {(first.markup ? first.text : escaped(first.text)) + (second.markup ? second.text : escaped(second.text)),
          true};
}

double text_width(const LabelText& text) {
  double width = 0.0;
  bool small = false;    // the next character or group is a subscript
  bool grouped = false;  // inside its braces
  for (std::size_t k = 0; k < text.text.size(); ++k) {
    char c = text.text[k];
    if (continues_character(c)) continue;
    if (text.markup && (c == '_' || c == '^')) {
      small = true;
      continue;
    }
    if (text.markup && (c == '{' || c == '}')) {
      grouped = c == '{';
      small = small && grouped;
      continue;
    }
    if (text.markup && c == '\\' && k + 1 < text.text.size()) c = text.text[++k];
    width += character_width(c) * (small ? subscript_size : 1.0);
    small = small && grouped;
  }
  return width;
}

double text_height(const LabelText& text) {
  const bool subscript = text.markup && text.text.find('_') != std::string::npos;
  return subscript ? 1.1 : 0.95;
}

std::string gnuplot_quoted(std::string_view text) {
  refuse_control_characters(text, "a text of the picture");
  if (text.find('\'') == std::string_view::npos) return fmt::format("'{}'", text);
  std::string result = "\"";
  for (const char c : text)
    result += std::string_view("'\"\\`$").find(c) == std::string_view::npos
                  ? std::string(1, c)
                  : fmt::format("\\{:03o}", static_cast<unsigned char>(c));
  return result + "\"";
}

void refuse_control_characters(std::string_view name, std::string_view what) {
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7f) continue;
    throw UserError(fmt::format("{} {}: the {} in it cannot stand in a script for gnuplot; give it another name", what,
                                in_quotes(name),
                                c == '\n' ? "line break" : fmt::format("control character of code {}", byte)));
  }
}

}  // namespace tchat
