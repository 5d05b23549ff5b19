#include "plugin/compiler_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace tchat {

namespace {

constexpr std::size_t most_errors = 5;

struct PlaceInText {
  std::string file;
  int line = 0;
  bool operator==(const PlaceInText&) const = default;
};

struct CompileError {
  PlaceInText place;
  std::string text;                        // the compiler's, names shortened
  std::string called = {};                 // the function whose argument does not fit, as declared
  bool called_is_foreign = false;          // it is declared in a header of the system
  std::optional<PlaceInText> opened = {};  // the bracket that is not closed
};

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// The position of a whole word; npos when there is none.
std::size_t find_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const bool begins = at == 0 || !is_word_character(text[at - 1]);
    const bool ends = at + word.size() == text.size() || !is_word_character(text[at + word.size()]);
    if (begins && ends) return at;
  }
  return std::string_view::npos;
}

/// Straight quotes, and T for every dual number.
std::string tidied(std::string text) {
  for (const char* quote : {"‘", "’"}) replace_all(text, quote, "'");
  for (const std::string_view name : {"tchat::Dual<", "Dual<"}) {
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
      std::size_t end = at + name.size();
      for (int depth = 1; depth > 0 && end < text.size(); ++end)
        depth += text[end] == '<' ? 1 : text[end] == '>' ? -1 : 0;
      text.replace(at, end - at, "T");
    }
  }
  return text;
}

/// "FILE:LINE:COLUMN: rest" or "FILE:LINE: rest" at the begin of a line.
struct Positioned {
  PlaceInText place;
  std::string rest;
};

std::optional<Positioned> positioned(const std::string& line) {
  for (std::size_t colon = line.find(':'); colon != std::string::npos; colon = line.find(':', colon + 1)) {
    int number = 0;
    const char* const begin = line.data() + colon + 1;
    const auto [end, error] = std::from_chars(begin, line.data() + line.size(), number);
    if (error != std::errc() || end == line.data() + line.size() || *end != ':') continue;
    std::size_t rest = static_cast<std::size_t>(end - line.data()) + 1;
    int column = 0;
    const auto [stop, none] = std::from_chars(line.data() + rest, line.data() + line.size(), column);
    if (none == std::errc() && stop != line.data() + line.size() && *stop == ':')
      rest = static_cast<std::size_t>(stop - line.data()) + 1;
    while (rest < line.size() && line[rest] == ' ') ++rest;
    return Positioned{{line.substr(0, colon), number}, line.substr(rest)};
  }
  return std::nullopt;
}

std::vector<std::string> lines_of_file(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string line_of(const PlaceInText& place) {
  const std::vector<std::string> lines = lines_of_file(place.file);
  if (place.line < 1 || static_cast<std::size_t>(place.line) > lines.size()) return "";
  const std::string& line = lines[static_cast<std::size_t>(place.line) - 1];
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

/// Reads the compiler's output line by line.
class OutputReader {
 public:
  explicit OutputReader(std::string include_folder) : include_folder_(std::move(include_folder)) {}

  void read(const std::string& line) {
    if (contains(line, ": In ") || contains(line, ": At ")) context_.reset();
    const auto found = positioned(line);
    if (!found) return;
    const std::size_t word = found->rest.starts_with("error: ") ? 7 : found->rest.starts_with("fatal error: ") ? 13 : 0;
    if (word > 0)
      add({found->place, tidied(found->rest.substr(word))});
    else
      add_detail(*found);
  }

  /// Those without a place in the author's files come last.
  std::vector<CompileError> errors() const { return errors_; }

 private:
  bool is_authors(const PlaceInText& place) const {
    return !place.file.starts_with(include_folder_ + "/") && !place.file.starts_with("/usr/") &&
           !place.file.starts_with("<");
  }

  void add(CompileError error) {
    placed_ = is_authors(error.place);
    if (!placed_ && context_) error.place = *context_, placed_ = true;
    errors_.push_back(std::move(error));
  }

  /// A line that says more of the error before it, or from where the next one comes.
  void add_detail(const Positioned& line) {
    const bool authors = is_authors(line.place);
    if (authors && !context_ && contains(line.rest, "required from")) context_ = line.place;
    if (errors_.empty()) return;
    CompileError& last = errors_.back();
    const std::string text = tidied(line.rest);
    if (authors && !placed_ && text.starts_with("note: ")) last.place = line.place, placed_ = true;
    if (contains(text, "to match this '{'")) last.opened = line.place;
    if (const std::size_t of = text.find("initializing argument"); of != std::string::npos && last.called.empty()) {
      const std::size_t quote = text.find('\'', of);
      if (quote != std::string::npos) last.called = text.substr(quote + 1, text.rfind('\'') - quote - 1);
      last.called_is_foreign = !authors;
    }
    if (const std::size_t of = text.find("comparison reduces to '("); of != std::string::npos)
      add_counts(last, text.substr(of + 24));
  }

  /// "3 == 4)'": how many there are and should be.
  static void add_counts(CompileError& error, const std::string& comparison) {
    const std::size_t sign = comparison.find(" == ");
    const std::size_t end = comparison.find(')');
    if (sign == std::string::npos || end == std::string::npos || end < sign) return;
    error.text +=
        fmt::format(" ({} found, {} needed)", comparison.substr(0, sign), comparison.substr(sign + 4, end - sign - 4));
  }

  std::string include_folder_;
  std::vector<CompileError> errors_;
  std::optional<PlaceInText> context_;  // from where the author's code has come to where the next error is
  bool placed_ = false;                 // the last error is at a place of the author's
};

/// The first word in single quotes that is a name, without std::, arguments and template arguments.
std::string quoted_name(const std::string& text) {
  const std::size_t quote = text.find('\'');
  if (quote == std::string::npos) return "";
  std::size_t begin = quote + 1;
  if (text.compare(begin, 5, "std::") == 0) begin += 5;
  std::size_t end = begin;
  while (end < text.size() && is_word_character(text[end])) ++end;
  return text.substr(begin, end - begin);
}

/// "double cube(double)" -> cube
std::string function_name(const std::string& declaration) {
  const std::size_t bracket = declaration.find('(');
  if (bracket == std::string::npos) return "";
  std::size_t begin = bracket;
  while (begin > 0 && is_word_character(declaration[begin - 1])) --begin;
  return declaration.substr(begin, bracket - begin);
}

/// Functions of dual numbers: what tchat/dual.hpp defines.
class KnownFunctions {
 public:
  explicit KnownFunctions(const std::string& include_folder) {
    for (const std::string& line : lines_of_file(include_folder + "/tchat/dual.hpp")) text_ += line + '\n';
  }
  bool has(const std::string& name) const {
    return contains(text_, "TCHAT_DUAL_FUNCTION(" + name + ",") || contains(text_, "> " + name + "(const Dual<N, B>& ");
  }

 private:
  std::string text_;
};

std::string unknown_function(const std::string& name, const KnownFunctions& known) {
  if (name == "max" || name == "min") return fmt::format("write f{}(a, b)", name);
  if (known.has(name)) return fmt::format("std::{0} takes no derivatives; write {0}(...), without std::", name);
  return fmt::format(
      "tchat has no derivative of {}; it knows sin, exp, log, sqrt, pow, atan2, fabs, fmax, fmod and the like "
      "(tchat/dual.hpp lists them)",
      name);
}

std::string wrong_call(const CompileError& error, const std::string&, const KnownFunctions& known) {
  if (!contains(error.text, "no matching function for call to") && !contains(error.text, "call of overloaded"))
    return "";
  if (contains(error.text, "T*") || contains(error.text, "double*"))
    return "an array is given where one number is needed: x[0] is the first state, par[0] is PAR(1)";
  return unknown_function(quoted_name(error.text), known);
}

std::string undeclared(const CompileError& error, const std::string&, const KnownFunctions&) {
  if (!contains(error.text, "was not declared") && !contains(error.text, "undeclared identifier")) return "";
  const std::string name = quoted_name(error.text);
  if (name == "max" || name == "min") return fmt::format("there is no {0}; write f{0}(a, b)", name);
  if (name == "pi" || name == "PI") return fmt::format("there is no {}; write M_PI", name);
  if (name == "sign" || name == "sgn" || name == "signum" || name == "heaviside")
    return fmt::format(
        "there is no {}; where the sign changes is an event: write two fields, or for a smooth model tanh(a / width)",
        name);
  return "";
}

std::string narrowed(const CompileError& error, const std::string& line, const KnownFunctions& known) {
  const bool converts = contains(error.text, "cannot convert") || contains(error.text, "no viable conversion") ||
                        contains(error.text, "cannot initialize");
  if (contains(error.text, "double*'")) return "an array is given where one number is needed: x[0] is the first state";
  if (!converts || find_word(error.text, "T") == std::string::npos) return "";
  if (!error.called.empty()) {
    const std::string name = function_name(error.called);
    if (error.called_is_foreign) return unknown_function(name, known);
    return fmt::format(
        "{0} takes plain numbers, and derivatives are lost; make it a template: template <class T> T {0}(const T& a)",
        name);
  }
  if (contains(error.text, "in return") || line.starts_with("return"))
    return "what depends on x or par is of type T; let the function return T (or auto), not double";
  return "what depends on x or par is of type T; write T (or auto), not double or int";
}

std::string cast(const CompileError& error, const std::string&, const KnownFunctions&) {
  const bool casts = contains(error.text, "invalid cast") || contains(error.text, "invalid 'static_cast") ||
                     contains(error.text, "static_cast from");
  return casts ? "a cast loses the derivatives; leave it out, or cast to T" : "";
}

std::string wrong_operator(const CompileError& error, const std::string&, const KnownFunctions&) {
  if (contains(error.text, "operator^'")) return "^ is no power in C++; write pow(a, b)";
  if (contains(error.text, "operator%'")) return "% is for integers; write fmod(a, b)";
  return "";
}

std::string missing_semicolon(const CompileError& error, const std::string&, const KnownFunctions&) {
  if (error.text.starts_with("expected ';'")) return "a ; is missing here or at the end of the line before";
  if (error.text.starts_with("expected ',' or ';'")) return "a , or ; is missing here or at the end of the line before";
  return "";
}

std::string missing_end(const CompileError& error, const std::string& line, const KnownFunctions&) {
  if (error.text.starts_with("expected '}'"))
    return error.opened ? fmt::format("a }} is missing above: the {{ of line {} is not closed", error.opened->line)
                        : "a } is missing above";
  if (error.text.starts_with("expected unqualified-id") && contains(line, "TCHAT_PROBLEM"))
    return "a ; is missing after the } that ends the class";
  return "";
}

std::string round_brackets(const CompileError& error, const std::string&, const KnownFunctions&) {
  if (!contains(error.text, "cannot be used as a function") && !contains(error.text, "called object type")) return "";
  return "elements are written in square brackets and count from 0: x[0] is the first state, par[0] is PAR(1)";
}

std::string missing_header(const CompileError& error, const std::string& line, const KnownFunctions&) {
  const bool registers = line.starts_with("TCHAT_PROBLEM");
  if (registers && (error.text.starts_with("expected constructor") || contains(error.text, "type specifier")))
    return "the first line of a problem is missing: #include <tchat/problem.hpp>";
  if (contains(line, "#include") && contains(line, "tchat") && contains(error.text, "o such file"))
    return "the header is called <tchat/problem.hpp>";
  return "";
}

std::string missing_template(const CompileError& error, const std::string&, const KnownFunctions&) {
  const bool missing =
      contains(error.text, "'T' does not name a type") || contains(error.text, "unknown type name 'T'");
  return missing ? "write template <class T> above the function" : "";
}

std::string changed_input(const CompileError& error, const std::string&, const KnownFunctions&) {
  const bool changes = contains(error.text, "assignment of read-only") || contains(error.text, "discards qualifiers") ||
                       contains(error.text, "is not assignable");
  return changes ? "x and par are given and stay as they are; copy what you change: T a = x[0]" : "";
}

using Cure = std::string (*)(const CompileError&, const std::string& line, const KnownFunctions&);
constexpr Cure cures[] = {wrong_call,     undeclared,        narrowed,     cast,
                          wrong_operator, missing_semicolon, missing_end,  round_brackets,
                          missing_header, missing_template,  changed_input};

constexpr std::string_view own_words = "tchat: ";  // the static assertions of problem.hpp

/// The assertions are in problem.hpp; the first word in backticks is the author's, if he has it.
PlaceInText place_of_word(const PlaceInText& place, const std::string& text) {
  const std::size_t begin = text.find('`');
  const std::size_t end = begin == std::string::npos ? begin : text.find('`', begin + 1);
  if (end == std::string::npos) return place;
  const std::vector<std::string> lines = lines_of_file(place.file);
  const std::string_view word = std::string_view(text).substr(begin + 1, end - begin - 1);
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (const std::size_t at = find_word(lines[k], word);
        at != std::string::npos && lines[k].find("//") > at)  // not in a comment
      return {place.file, static_cast<int>(k) + 1};
  return place;
}

std::string explained(const CompileError& error, const KnownFunctions& known) {
  const std::size_t own = error.text.find(own_words);
  if (own != std::string::npos) {
    std::string text = error.text.substr(own + own_words.size());
    std::erase(text, '"');
    const PlaceInText place = place_of_word(error.place, text);
    return fmt::format("{}:{}: {}\n      {}\n", place.file, place.line, text, line_of(place));
  }
  const std::string line = line_of(error.place);
  for (const Cure cure : cures)
    if (const std::string text = cure(error, line, known); !text.empty())
      return fmt::format("{}:{}: {}\n      {}\n", error.place.file, error.place.line, text, line);
  return fmt::format("{}:{}: {}\n      {}\n", error.place.file, error.place.line, error.text, line);
}

/// A part of the errors that says it all: a bracket that is not closed, or what problem.hpp asserts; else all.
std::vector<CompileError> decisive(const std::vector<CompileError>& errors) {
  for (const char* sign : {"tchat: ", "expected '}' at end"}) {
    std::vector<CompileError> chosen;
    for (const CompileError& error : errors)
      if (contains(error.text, sign)) chosen.push_back(error);
    if (!chosen.empty()) return chosen;
  }
  return errors;
}

}  // namespace

std::string short_errors(const std::string& output, const std::string& include_folder) {
  OutputReader reader(include_folder);
  std::istringstream in(output);
  for (std::string line; std::getline(in, line);) reader.read(line);
  const KnownFunctions known(include_folder);
  std::vector<std::string> texts;
  std::vector<PlaceInText> seen;
  for (const CompileError& error : decisive(reader.errors())) {
    const bool own = contains(error.text, own_words);
    if (!own && std::find(seen.begin(), seen.end(), error.place) != seen.end()) continue;
    seen.push_back(error.place);
    const std::string text = explained(error, known);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  std::string all;
  for (std::size_t k = 0; k < std::min(texts.size(), most_errors); ++k) all += (k > 0 ? "  " : "") + texts[k];
  if (texts.size() > most_errors) all += fmt::format("  and {} errors more\n", texts.size() - most_errors);
  return all;
}

}  // namespace tchat
