#include "plugin/compiler_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>

namespace tchat {

namespace {

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer;
  while (true) {
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

/// This process's environment with the compiler's words in English, which is what is read in them.
std::vector<std::string> english_environment() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable)
    if (const std::string text = *variable;
        !text.starts_with("LC_ALL=") && !text.starts_with("LC_MESSAGES=") && !text.starts_with("LANGUAGE="))
      variables.push_back(text);
  variables.emplace_back("LC_ALL=C.UTF-8");
  return variables;
}

std::vector<char*> pointers(const std::vector<std::string>& words) {
  std::vector<char*> result;
  for (const std::string& word : words) result.push_back(const_cast<char*>(word.c_str()));
  result.push_back(nullptr);
  return result;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& words) {
  ProcessResult result;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    result.spawn_error = errno;
    return result;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  const std::vector<std::string> variables = english_environment();
  const std::vector<char*> arguments = pointers(words);

  pid_t child = 0;
  result.spawn_error =
      posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (result.spawn_error == 0) {
    result.output = read_all(ends[0]);
    while (waitpid(child, &result.status, 0) < 0 && errno == EINTR) {
    }
  }
  close(ends[0]);
  return result;
}

namespace {

constexpr std::size_t most_errors = 5;
constexpr std::size_t longest_line = 4000;  // regular expressions recurse for each character

struct PlaceInText {
  std::string file;
  int line = 0;
  bool operator==(const PlaceInText&) const = default;
};

struct CompileError {
  PlaceInText place;
  std::string text;          // the compiler's, names shortened
  std::string details = {};  // lines that the compiler adds: "author LINE: note" or "system LINE: note"
};

bool contains(const std::string& text, const char* pattern) { return std::regex_search(text, std::regex(pattern)); }

/// Straight quotes, and T for every dual number.
std::string tidied(const std::string& text) {
  static const std::regex quote("‘|’");
  static const std::regex dual("(?:tchat::)?Dual<(?:[^<>]|<[^<>]*>)*>");
  std::string tidy = std::regex_replace(text, quote, "'");
  while (std::regex_search(tidy, dual)) tidy = std::regex_replace(tidy, dual, "T");
  return tidy;
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

  void read(const std::string& whole_line) {
    static const std::regex positioned(R"((.*?):(\d{1,9}):(?:\d+:)? *(.*))");
    static const std::regex error("(?:fatal )?error: (.*)");
    const std::string line = whole_line.substr(0, longest_line);
    if (contains(line, ": (In|At) ")) context_.reset();
    std::smatch part;
    if (!std::regex_match(line, part, positioned)) return;
    const PlaceInText place = {part[1], std::stoi(part[2])};
    const std::string text = tidied(part[3]);
    std::smatch found;
    if (std::regex_match(text, found, error))
      add({place, found[1]});
    else
      add_detail(place, text);
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
  void add_detail(const PlaceInText& place, const std::string& text) {
    const bool authors = is_authors(place);
    if (authors && !context_ && contains(text, "required from")) context_ = place;
    if (errors_.empty()) return;
    CompileError& last = errors_.back();
    if (authors && !placed_ && text.starts_with("note: ")) last.place = place, placed_ = true;
    last.details += fmt::format("\n{} {}: {}", authors ? "author" : "system", place.line, text);
    static const std::regex comparison(R"(comparison reduces to '\((.*) == (.*?)\))");
    if (std::smatch counts; std::regex_search(text, counts, comparison))
      last.text += fmt::format(" ({} found, {} needed)", counts[1].str(), counts[2].str());
  }

  std::string include_folder_;
  std::vector<CompileError> errors_;
  std::optional<PlaceInText> context_;  // from where the author's code has come to where the next error is
  bool placed_ = false;                 // the last error is at a place of the author's
};

/// What to do about a mistake that authors of problems often make.
struct Cure {
  Cure(const std::string& for_error, const std::string& for_line, std::string sentence)
      : error(for_error), line(for_line), text(std::move(sentence)) {}

  std::regex error;  // of the compiler's text and details
  std::regex line;   // of the author's line
  std::string text;  // $1 is the first group of `error`
};

const std::string wrong_call = "^(?:no matching function for call to|call of overloaded).*";
const std::string wrong_type = "^.*(?:cannot convert|no viable conversion|cannot initialize).*\\bT\\b";
const std::string system_argument = wrong_type + R"([^]*\nsystem \d+:.*initializing argument \d+ of '.*?\b)";
const std::string own_argument = wrong_type + R"([^]*\nauthor \d+:.*initializing argument \d+ of '.*?\b)";

const std::string array_given =
    "an array is given where one number is needed: x[0] is the first state, par[0] is PAR(1)";
const std::string without_std = "std::$1 takes no derivatives; write $1(...), without std::";
const std::string unknown_function =
    "tchat has no derivative of $1; it knows sin, exp, log, sqrt, pow, atan2, fabs, fmax, fmod and the like "
    "(tchat/dual.hpp lists them)";
const std::string smooth_sign =
    "there is no $1; where the sign changes is an event: write two fields, or for a smooth model tanh(a / width)";

/// The functions of dual numbers, those that tchat/dual.hpp defines, as alternatives of a regular expression.
std::string known_functions(const std::string& include_folder) {
  static const std::regex definition(R"(TCHAT_DUAL_FUNCTION\((\w+),|> (\w+)\(const Dual<N, B>& )");
  std::string names = "none";
  for (const std::string& line : lines_of_file(include_folder + "/tchat/dual.hpp"))
    if (std::smatch name; std::regex_search(line, name, definition)) names += "|" + name[1].str() + name[2].str();
  return names;
}

/// The first one that fits is shown. `known`: the functions of dual numbers, as alternatives.
std::vector<Cure> cures_of(const std::string& known) {
  return {
      {wrong_call + R"((?:\bT|double) ?\*)", "", array_given},
      {wrong_call + R"('(?:std::)?(max|min)\b)", "", "write f$1(a, b)"},
      {wrong_call + "'(?:std::)?(" + known + ")\\b", "", without_std},
      {wrong_call + R"('(?:std::)?(\w+))", "", unknown_function},
      {"'(max|min)' was not declared|undeclared identifier '(max|min)'", "", "there is no $1$2; write f$1$2(a, b)"},
      {"'(pi|PI)' was not declared|undeclared identifier '(pi|PI)'", "", "there is no $1$2; write M_PI"},
      {"'(sign|sgn|signum|heaviside)' was not declared", "", smooth_sign},
      {"undeclared identifier '(sign|sgn|signum|heaviside)'", "", smooth_sign},
      {R"(^.*double ?\*')", "", array_given},
      {system_argument + "(" + known + ")\\(", "", without_std},
      {system_argument + R"((\w+)\()", "", unknown_function},
      {own_argument + R"((\w+)\()", "",
       "$1 takes plain numbers, and derivatives are lost; make it a template: template <class T> T $1(const T& a)"},
      {wrong_type + ".*in return", "",
       "what depends on x or par is of type T; let the function return T (or auto), not double"},
      {wrong_type, "^return", "what depends on x or par is of type T; let the function return T (or auto), not double"},
      {wrong_type, "", "what depends on x or par is of type T; write T (or auto), not double or int"},
      {"^.*(?:invalid cast|invalid 'static_cast|static_cast from)", "",
       "a cast loses the derivatives; leave it out, or cast to T"},
      {"^.*operator\\^'", "", "^ is no power in C++; write pow(a, b)"},
      {"^.*operator%'", "", "% is for integers; write fmod(a, b)"},
      {"^expected (?:',' or )?';'", "", "a ; is missing here or at the end of the line before"},
      {R"(^expected '\}'[^]*\n\w+ (\d+): .*to match this '\{')", "",
       "a } is missing above: the { of line $1 is not closed"},
      {R"(^expected '\}')", "", "a } is missing above"},
      {"^expected unqualified-id", "TCHAT_PROBLEM", "a ; is missing after the } that ends the class"},
      {"^.*(?:cannot be used as a function|called object type)", "",
       "elements are written in square brackets and count from 0: x[0] is the first state, par[0] is PAR(1)"},
      {"^(?:expected constructor|.*type specifier)", "^TCHAT_PROBLEM",
       "the first line of a problem is missing: #include <tchat/problem.hpp>"},
      {"^.*o such file", "#include.*tchat", "the header is called <tchat/problem.hpp>"},
      {"^.*(?:'T' does not name a type|unknown type name 'T')", "", "write template <class T> above the function"},
      {"^.*(?:assignment of read-only|discards qualifiers|is not assignable)", "",
       "x and par are given and stay as they are; copy what you change: T a = x[0]"}};
}

/// The cure, or what the compiler says.
std::string sentence_for(const CompileError& error, const std::string& line, const std::vector<Cure>& cures) {
  const std::string text = error.text + error.details;
  for (const Cure& cure : cures)
    if (std::smatch found; std::regex_search(line, cure.line) && std::regex_search(text, found, cure.error))
      return found.format(cure.text);
  return error.text;
}

constexpr const char* own_words = "tchat: ";  // the static assertions of problem.hpp

/// The assertions are in problem.hpp; the first word in backticks is the author's, if he has it outside of comments.
PlaceInText place_of_word(const PlaceInText& place, const std::string& text) {
  std::smatch word;
  if (!std::regex_search(text, word, std::regex("`(\\w+)`"))) return place;
  const std::regex uses_word("^(?:(?!//).)*\\b" + word[1].str() + "\\b");
  const std::vector<std::string> lines = lines_of_file(place.file);
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (std::regex_search(lines[k], uses_word)) return {place.file, static_cast<int>(k) + 1};
  return place;
}

std::string explained(const CompileError& error, const std::vector<Cure>& cures) {
  const auto shown = [](const PlaceInText& place, const std::string& sentence) {
    return fmt::format("{}:{}: {}\n      {}\n", place.file, place.line, sentence, line_of(place));
  };
  const std::size_t own = error.text.find(own_words);
  if (own == std::string::npos) return shown(error.place, sentence_for(error, line_of(error.place), cures));
  std::string text = error.text.substr(own + std::string(own_words).size());
  std::erase(text, '"');
  return shown(place_of_word(error.place, text), text);
}

/// A part of the errors that says it all: a bracket that is not closed, or what problem.hpp asserts; else all.
std::vector<CompileError> decisive(const std::vector<CompileError>& errors) {
  for (const char* sign : {own_words, "expected '\\}' at end"}) {
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
  const std::vector<Cure> cures = cures_of(known_functions(include_folder));
  std::vector<std::string> texts;
  std::vector<PlaceInText> seen;
  for (const CompileError& error : decisive(reader.errors())) {
    const bool own = contains(error.text, own_words);
    if (!own && std::find(seen.begin(), seen.end(), error.place) != seen.end()) continue;
    seen.push_back(error.place);
    const std::string text = explained(error, cures);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  std::string all;
  for (std::size_t k = 0; k < std::min(texts.size(), most_errors); ++k) all += (k > 0 ? "  " : "") + texts[k];
  if (texts.size() > most_errors) all += fmt::format("  and {} errors more\n", texts.size() - most_errors);
  return all;
}

}  // namespace tchat
