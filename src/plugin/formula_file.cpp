#include "plugin/formula_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tchat::formulas {

namespace {

const std::vector<std::string>& statement_words() {
  static const std::vector<std::string> words = {"par",  "init",  "number",  "aux",   "field", "event",
                                                 "jump", "slide", "contact", "after", "mode",  "done"};
  return words;
}

bool is_one_of(const Token& token, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return token.is(word); });
}

/// Statements of XPPAUT that mean something else here, with what is written instead.
const char* replacement_for(const Token& token) {
  if (token.is("global")) return "write 'event NAME = EXPRESSION' and 'jump NAME: STATE -> EXPRESSION'";
  if (is_one_of(token, {"wiener", "markov"})) return "tchat continues orbits of problems without noise";
  if (is_one_of(token, {"table", "volt", "solv", "bdry", "bd"})) return "tchat has nothing like it";
  if (token.is("@")) return "constants of a computation are in the file gc.NAME";
  if (token.is("\"") || token.is("%")) return "comments begin with #";
  if (token.is("!")) return "write a definition, NAME = EXPRESSION";
  if (is_one_of(token, {"set", "only", "options"})) return "constants of a computation are in the file gc.NAME";
  return nullptr;
}

class StatementReader {
 public:
  StatementReader(FormulaFile& file, const Statement& tokens) : file_(file), in_(tokens) {}

  void read() {
    if (const Token& next = in_.peek(1);
        in_.peek().is_name() && !is_one_of(next, {"=", "'", "(", "->", "/"}) && keyword_statement())
      return;
    formula();
    in_.expect_end();
  }

 private:
  /// False when the first word is none of those that begin a statement.
  bool keyword_statement() {
    const Token word = in_.peek();
    if (is_one_of(word, {"par", "param", "params", "parameter", "parameters"}))
      return in_.next(), list(file_.parameters, "a parameter", "parameters are written par a=1, b=2"), true;
    if (is_one_of(word, {"init", "initial"}))
      return in_.next(), list(file_.initial, "a state", "starting values are written init x=0, v=1"), true;
    if (is_one_of(word, {"number", "const"}))
      return in_.next(), list(file_.definitions, "a number", "numbers are written number g=9.81"), true;
    if (word.is("aux")) return in_.next(), list(file_.user_values, "a value", "values are written aux E = v^2/2"), true;
    if (word.is("event"))
      return in_.next(), list(file_.events, "an event", "events are written event wall = 1 - x"), true;
    if (word.is("field")) return in_.next(), field(), true;
    if (word.is("jump")) return in_.next(), jump(), true;
    if (word.is("mode") && in_.peek(1).is_name()) return in_.next(), mode(), true;
    if (word.is("slide")) return in_.next(), slide(), true;
    if (word.is("contact")) return in_.next(), contact(), true;
    if (word.is("after")) return in_.next(), successor(word.at), true;
    refuse_unknown(word);
  }

  [[noreturn]] void refuse_unknown(const Token& word) const {
    if (const char* const instead = replacement_for(word))
      throw FormulaError{word.at, fmt::format("'{}' is no statement of a file of formulas; {}", word.text, instead)};
    throw FormulaError{
        word.at, fmt::format("a statement cannot begin with '{}' before {}{}; it is NAME = EXPRESSION, "
                             "STATE' = EXPRESSION, or begins with par, init, number, aux, field, event, "
                             "jump, mode, slide, contact or after",
                             word.text.substr(0, 40), shown(in_.peek(1)), did_you_mean(word.text, statement_words()))};
  }

  /// NAME = EXPRESSION for each; commas between them may be left out, as in XPPAUT.
  void list(std::vector<Assignment>& target, const std::string& role, const std::string& cure) {
    do {
      const Token& name = in_.expect_name(role);
      in_.expect("=", cure);
      target.push_back({name, parse_expression(in_)});
    } while (in_.accept(",") || in_.accept(";") || in_.peek().is_name());
    in_.expect_end();
  }

  void field() {
    Block made{in_.expect_name("a field"), {}};
    if (opens_lines("field NAME: STATE' = EXPRESSION")) {
      do made.lines.push_back(equation());
      while (in_.accept(",") || in_.accept(";"));
    }
    in_.expect_end();
    file_.fields.push_back(std::move(made));
  }

  void jump() {
    Block made{in_.expect_name("a jump"), {}};
    if (in_.accept("to")) made.target = in_.expect_name("a field");
    if (opens_lines("jump NAME: STATE -> EXPRESSION")) {
      do made.lines.push_back(new_value());
      while (in_.accept(",") || in_.accept(";"));
    }
    in_.expect_end();
    file_.jumps.push_back(std::move(made));
  }

  /// False when the statement ends behind the name, with a colon or without one: lines may follow.
  bool opens_lines(const std::string& form) {
    if (!in_.peek().is_end()) in_.expect(":", fmt::format("it is written '{}'", form));
    return !in_.peek().is_end();
  }

  /// x' = EXPRESSION or dx/dt = EXPRESSION
  Assignment equation() {
    Token state = in_.expect_name("a state");
    if (in_.peek().is("/") && in_.peek(1).is("dt")) {
      if (state.text.size() < 2 || state.text[0] != 'd')
        throw FormulaError{state.at, fmt::format("'{}/dt' is no derivative; write STATE' or dSTATE/dt", state.text)};
      state.text.erase(0, 1);
      in_.next(), in_.next();
    } else {
      in_.expect("'", "an equation is written x' = EXPRESSION");
    }
    in_.expect("=", "an equation is written x' = EXPRESSION");
    return {std::move(state), parse_expression(in_)};
  }

  /// v -> EXPRESSION, and v = EXPRESSION behind `jump NAME:`, as in XPPAUT.
  Assignment new_value() {
    Token state = in_.expect_name("a state");
    if (!in_.accept("=")) in_.expect("->", "what a state becomes is written v -> EXPRESSION");
    return {std::move(state), parse_expression(in_)};
  }

  /// Everything that begins with a name of the user's.
  void formula() {
    if (!in_.peek().is_name() && replacement_for(in_.peek()) != nullptr) refuse_unknown(in_.peek());
    if (!in_.peek().is_name())
      throw FormulaError{in_.peek().at, fmt::format("a statement cannot begin with {}; it begins with a word or a name",
                                                    shown(in_.peek()))};
    const Token& second = in_.peek(1);
    if (second.is("'") || second.is("/"))
      (file_.fields.empty() ? file_.shared_equations : file_.fields.back().lines).push_back(equation());
    else if (second.is("->"))
      line_of_jump();
    else if (second.is("("))
      function_or_initial_value();
    else
      definition();
  }

  void line_of_jump() {
    if (file_.jumps.empty())
      throw FormulaError{in_.peek().at, fmt::format("'{0} -> ...' belongs to a jump, and there is none above it; write "
                                                    "'jump NAME: {0} -> ...'",
                                                    in_.peek().text)};
    file_.jumps.back().lines.push_back(new_value());
  }

  void definition() {
    const Token& name = in_.next();
    in_.expect("=", "a definition is written NAME = EXPRESSION");
    file_.definitions.push_back({name, parse_expression(in_)});
  }

  /// f(a, b) = EXPRESSION, or x(0) = EXPRESSION
  void function_or_initial_value() {
    const Token& name = in_.next();
    in_.next();
    if (in_.peek().kind == Token::Kind::number && in_.peek().number == 0.0) {
      in_.next();
      in_.expect(")", "a starting value is written x(0) = 1");
      in_.expect("=", "a starting value is written x(0) = 1");
      file_.initial.push_back({name, parse_expression(in_)});
      return;
    }
    FunctionDefinition made{name, {}, {}};
    do made.arguments.push_back(in_.expect_name("an argument"));
    while (in_.accept(","));
    in_.expect(")", "a function is written f(a, b) = EXPRESSION");
    in_.expect("=", "a function is written f(a, b) = EXPRESSION");
    made.body = parse_expression(in_);
    file_.functions.push_back(std::move(made));
  }

  void mode() {
    const std::string form = "it is written 'mode FIELD: states a, b, c'";
    ModeStatement made{in_.expect_name("a field"), {}};
    in_.expect(":", form);
    in_.expect("states", form);
    do made.states.push_back(in_.expect_name("a state"));
    while (in_.accept(","));
    in_.expect_end();
    file_.modes.push_back(std::move(made));
  }

  void slide() {
    const std::string form =
        "it is written 'slide NAME on EVENT: EVENT -> FIELD, EVENT -> FIELD', the field below first";
    SlideStatement made;
    made.name = in_.expect_name("a field");
    in_.expect("on", form);
    made.surface = in_.expect_name("an event");
    in_.expect(":", form);
    for (std::size_t k = 0; k < 2; ++k) {
      if (k > 0) in_.expect(",", form);
      made.ends[k].first = in_.expect_name("an event");
      in_.expect("->", form);
      made.ends[k].second = in_.expect_name("a field");
    }
    in_.expect_end();
    file_.slides.push_back(std::move(made));
  }

  void contact() {
    const std::string form = "it is written 'contact NAME on EVENT until EVENT: FIELD, JUMP -> JUMP'";
    ContactStatement made;
    made.name = in_.expect_name("a field");
    in_.expect("on", form);
    made.surface = in_.expect_name("an event");
    in_.expect("until", form);
    made.release = in_.expect_name("an event");
    in_.expect(":", form);
    made.field = in_.expect_name("a field");
    in_.expect(",", form);
    made.impact = in_.expect_name("a jump");
    in_.expect("->", form);
    made.limit = in_.expect_name("a jump");
    in_.expect_end();
    file_.contacts.push_back(std::move(made));
  }

  void successor(Position at) {
    SuccessorLine line{at, {}, {}, {}, {}};
    while (in_.peek().is_name() && !in_.peek().is("if")) line.from.push_back(in_.next());
    if (line.from.empty())
      throw FormulaError{in_.peek().at,
                         "after what? write a jump, an event, a field, 'start' or 'any', as in 'after any: wall -> "
                         "impact'"};
    if (in_.accept("if")) line.condition = parse_expression(in_);
    in_.expect(":", "it is written 'after JUMP if CONDITION: FIELD until EVENT -> JUMP, EVENT -> JUMP'");
    if (in_.peek(1).is("until")) {
      line.field = in_.expect_name("a field");
      in_.next();
    }
    do {
      const Token& event = in_.expect_name("an event");
      in_.expect("->", "behind an event comes its jump, as wall -> impact, and before them 'FIELD until'");
      line.ends.emplace_back(event, in_.expect_name("a jump"));
    } while (in_.accept(",") || in_.accept(";"));
    if (!in_.peek().is_end())
      throw FormulaError{in_.peek().at,
                         "a comma and the next event, or the end of the line, is expected here, as in 'after any: wall "
                         "-> impact, top -> rebound'"};
    file_.successors.push_back(std::move(line));
  }

  FormulaFile& file_;
  TokenReader in_;
};

/// "done" alone ends a file of XPPAUT.
bool is_end_of_file(const Statement& tokens) { return tokens.size() == 2 && tokens[0].is("done"); }

}  // namespace

FormulaFile read_formula_file(std::string_view text, FormulaErrors& errors) {
  FormulaFile file;
  for (const Statement& tokens : read_statements(text, errors)) {
    if (is_end_of_file(tokens)) break;
    collecting(errors, [&] { StatementReader(file, tokens).read(); });
  }
  return file;
}

std::string in_words(Symbol::Kind kind) {
  switch (kind) {
    case Symbol::Kind::state:
      return "a state";
    case Symbol::Kind::parameter:
      return "a parameter";
    case Symbol::Kind::definition:
      return "a definition";
    default:
      return "a function";
  }
}

void refuse_reserved(const Token& name) {
  for (const char* word : {"and", "or", "not", "if", "until", "start", "any"})
    if (name.text == word)
      throw FormulaError{name.at, fmt::format("'{}' is a word of the language; choose another name", name.text)};
  if (name.text == "pi" || find_function(name.text) != nullptr)
    throw FormulaError{name.at, fmt::format("'{}' is built in and cannot be defined again; choose another name, such "
                                            "as {}0",
                                            name.text, name.text)};
}

NameTable::NameTable(const FormulaFile& file, FormulaErrors& errors) {
  add_states(file.shared_equations, errors);
  for (const Block& field : file.fields) add_states(field.lines, errors);
  for (std::size_t k = 0; k < file.parameters.size(); ++k)
    add(file.parameters[k].name, Symbol::Kind::parameter, k, errors);
  for (std::size_t k = 0; k < file.definitions.size(); ++k)
    add(file.definitions[k].name, Symbol::Kind::definition, k, errors);
  for (std::size_t k = 0; k < file.functions.size(); ++k)
    add(file.functions[k].name, Symbol::Kind::function, k, errors);
}

/// Equations of one state stand in several fields.
void NameTable::add_states(const std::vector<Assignment>& equations, FormulaErrors& errors) {
  for (const Assignment& equation : equations) {
    const Symbol* const known = find(equation.name.text);
    if (known != nullptr && known->kind == Symbol::Kind::state) continue;
    add(equation.name, Symbol::Kind::state, states_.size(), errors);
    states_.push_back(equation.name.text);
  }
}

void NameTable::add(const Token& name, Symbol::Kind kind, std::size_t index, FormulaErrors& errors) {
  collecting(errors, [&] {
    refuse_reserved(name);
    const auto [place, is_new] = symbols_.emplace(name.text, Symbol{kind, index, name.at});
    if (is_new) return;
    const Symbol& first = place->second;
    const std::string cure = first.kind == Symbol::Kind::state
                                 ? fmt::format(
                                       "what a jump makes of it stands behind 'jump NAME:', as {} -> ...; else "
                                       "choose another name",
                                       name.text)
                                 : "choose another name";
    throw FormulaError{name.at, fmt::format("'{}' is used twice, it is {} already (line {}); {}", name.text,
                                            in_words(first.kind), first.at.line, cure)};
  });
}

const Symbol* NameTable::find(std::string_view name) const {
  const auto found = symbols_.find(name);
  return found != symbols_.end() ? &found->second : nullptr;
}

std::vector<std::string> NameTable::all() const {
  std::vector<std::string> names;
  for (const auto& [name, symbol] : symbols_) names.push_back(name);
  const std::vector<std::string> functions = function_names();
  names.insert(names.end(), functions.begin(), functions.end());
  names.emplace_back("pi");
  return names;
}

}  // namespace tchat::formulas
