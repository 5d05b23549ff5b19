#include "plugin/cpp_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "base/text_file.hpp"
#include "plugin/expression.hpp"

namespace tchat::formulas {

namespace {

/// Helper functions, written into the class when the text uses them.
struct Helper {
  const char* use;
  const char* text;
};
constexpr std::array<Helper, 8> helpers = {{
    {"square(", "  template <class A>\n  static A square(const A& a) {\n    return a * a;\n  }\n"},
    {"cube(", "  template <class A>\n  static A cube(const A& a) {\n    return a * a * a;\n  }\n"},
    {"larger<T>(",
     "  template <class T>\n  static T larger(const T& a, const T& b) {\n    return a < b ? b : a;\n  }\n"},
    {"smaller<T>(",
     "  template <class T>\n  static T smaller(const T& a, const T& b) {\n    return b < a ? b : a;\n  }\n"},
    {"sign_of<T>(",
     "  template <class T>\n  static T sign_of(const T& a) {\n    return T(a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : 0.0);\n  "
     "}\n"},
    {"heaviside<T>(",
     "  template <class T>\n  static T heaviside(const T& a) {\n    return T(a >= 0.0 ? 1.0 : 0.0);\n  }\n"},
    {"floor_of<T>(",
     "  template <class T>\n  static T floor_of(const T& a) {\n    return tchat::whole_numbers::floor(a);\n  }\n"},
    {"remainder_of<T>(",
     "  template <class T>\n  static T remainder_of(const T& a, const T& b) {\n    return a - b * "
     "tchat::whole_numbers::floor(T(a / b));\n  }\n"},
}};

class CppWriter {
 public:
  CppWriter(const ProblemModel& model, const std::string& class_name) : model_(model) {
    class_ = names_.unique(class_name);
    if (!model.slides.empty()) names_.unique(slides_member);  // hidden by nothing of the user's
    if (!model.contacts.empty()) names_.unique(contacts_member);
    for (const std::string& state : model.names.states()) cpp_[state] = names_.unique(state);
    for (const Assignment& parameter : model.file.parameters) name(parameter.name);
    for (const Assignment& definition : model.file.definitions) name(definition.name);
    for (const FunctionDefinition& function : model.file.functions) name(function.name);
  }

  std::string source(const std::string& origin) {
    const std::string functions = user_functions() + fields() + events() + jumps() + user_values() + successors();
    std::string text = fmt::format(
        "// {}\n//\n// Indices count from 1, state[0] and par[0] are the first ones. T is double or a number that "
        "carries derivatives.\n#include <array>\n#include <cmath>\n#include <tchat/problem.hpp>\n#include "
        "<vector>\n\nstruct {} {{\n",
        origin, class_);
    text += sizes() + names() + slides() + contacts() + "\n";
    for (const Helper& helper : helpers)
      if (functions.find(helper.use) != std::string::npos) text += std::string(helper.text) + "\n";
    return text + functions + fmt::format("}};\n\nTCHAT_PROBLEM({})\n", class_);
  }

 private:
  using Lines = std::vector<std::string>;

  void name(const Token& token) { cpp_[token.text] = names_.unique(token.text); }

  std::string sizes() const {
    const auto count = [](const char* name, std::size_t number) {
      return number == 0 ? "" : fmt::format(", {} = {}", name, number);
    };
    return fmt::format(
        "  static constexpr int dimension = {}, parameters = {};\n"
        "  static constexpr int fields = {}{}{};\n{}",
        model_.names.states().size(), model_.parameter_values.size(), field_count(),
        count("events", model_.events.size() + 2 * model_.slides.size() + 3 * model_.contacts.size()),
        count("jumps", model_.jumps.size() + 2 * model_.contacts.size()),
        model_.file.modes.empty() ? "" : dimensions());
  }

  /// Of modes that differ.
  std::string dimensions() const {
    std::vector<std::size_t> fields, jumps;
    for (const ProblemModel::Field& field : model_.fields) fields.push_back(field.rates.size());
    fields.resize(field_count(), model_.names.states().size());
    for (const ProblemModel::Jump& jump : model_.jumps) jumps.push_back(jump.states);
    jumps.resize(model_.jumps.size() + 2 * model_.contacts.size(), model_.names.states().size());
    return fmt::format(
        "  static constexpr int dimension_of(int field) {{\n    constexpr int states[] = {{{}}};\n"
        "    return states[field - 1];\n  }}\n"
        "  static constexpr int dimension_after(int jump) {{\n    constexpr int states[] = {{{}}};\n"
        "    return states[jump - 1];\n  }}\n",
        fmt::join(fields, ", "), fmt::join(jumps, ", "));
  }

  static constexpr const char* slides_member = "sliding";

  /// The sliding modes, whose fields and events tchat makes.
  std::string slides() const {
    if (model_.slides.empty()) return "";
    std::vector<std::string> modes;
    for (const ProblemModel::Slide& slide : model_.slides)
      modes.push_back(
          fmt::format("{{.field = {}, .minus = {}, .plus = {}, .surface = {}, .to_minus = {}, .to_plus = {}}}",
                      slide.field, slide.minus, slide.plus, slide.surface, slide.to_minus, slide.to_plus));
    return fmt::format("  static constexpr tchat::Sliding {}[] = {{\n      {}}};\n", slides_member,
                       fmt::join(modes, ",\n      "));
  }

  static constexpr const char* contacts_member = "chatter";

  /// The modes of contact, whose fields, events and jumps tchat makes.
  std::string contacts() const {
    if (model_.contacts.empty()) return "";
    std::vector<std::string> modes;
    for (const ProblemModel::Contact& c : model_.contacts)
      modes.push_back(
          fmt::format("{{.field = {}, .event = {}, .impact = {}, .contact = {}, .release = {}, .limit = "
                      "{}, .margin = {}, .leave = {}, .time = {}}}",
                      c.field, c.event, c.impact, c.contact, c.release, c.limit, c.margin, c.leave, c.time));
    return fmt::format("  static constexpr tchat::Chatter {}[] = {{\n      {}}};\n", contacts_member,
                       fmt::join(modes, ",\n      "));
  }

  std::size_t field_count() const { return model_.fields.size() + model_.slides.size() + model_.contacts.size(); }

  static std::string strings(const char* member, const std::vector<std::string>& texts) {
    if (texts.empty()) return "";
    return fmt::format("  static constexpr const char* {}[] = {{\"{}\"}};\n", member, fmt::join(texts, "\", \""));
  }

  static std::string numbers(const char* member, const std::vector<double>& values) {
    if (values.empty()) return "";
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(cpp_number(value));
    return fmt::format("  static constexpr double {}[] = {{{}}};\n", member, fmt::join(texts, ", "));
  }

  template <class Parts>
  static std::vector<std::string> names_of_parts(const Parts& parts) {
    std::vector<std::string> result;
    for (const auto& part : parts) result.push_back(part.name);
    return result;
  }

  std::string names() const {
    std::vector<std::string> parameters;
    for (const Assignment& parameter : model_.file.parameters) parameters.push_back(parameter.name.text);
    std::vector<std::string> fields = names_of_parts(model_.fields), events = names_of_parts(model_.events);
    for (const ProblemModel::Slide& slide : model_.slides) {
      fields.push_back(slide.name);
      events.insert(events.end(), slide.end_names.begin(), slide.end_names.end());
    }
    std::vector<std::string> jumps = names_of_parts(model_.jumps);
    for (const ProblemModel::Contact& contact : model_.contacts) {
      fields.push_back(contact.name);
      events.insert(events.end(), {contact.release_name, contact.margin_name, contact.time_name});
      jumps.insert(jumps.end(), {contact.limit_name, contact.leave_name});
    }
    return strings("state_names", model_.names.states()) + strings("parameter_names", parameters) +
           strings("field_names", fields) + strings("event_names", events) + strings("jump_names", jumps) +
           numbers("initial_parameters", model_.parameter_values) + numbers("initial_state", model_.initial_state);
  }

  // Expressions, in the scope of a function's arguments.

  using Scope = std::map<std::string, std::string>;  ///< arguments -> C++

  std::string text_of(const Expression& expression, const Scope& scope = {}) const {
    const auto name_of = [&](const std::string& name) {
      const auto argument = scope.find(name);
      return argument != scope.end() ? argument->second : cpp_.at(name);
    };
    const auto call_of = [&](const std::string& name) {
      return is_user_function(name) ? cpp_.at(name) + "<T>(state, par, " : std::string();
    };
    return cpp_expression(expression, name_of, call_of);
  }

  bool is_user_function(const std::string& name) const {
    const Symbol* const symbol = model_.names.find(name);
    return symbol != nullptr && symbol->kind == Symbol::Kind::function;
  }

  /// States, parameters and definitions that expressions use, and what these use.
  struct Needs {
    std::set<std::size_t> states;
    std::set<std::size_t> parameters;
    std::vector<std::size_t> definitions;  ///< each behind those that it uses
  };

  void need(Needs& needs, const Expression& expression, const Scope& scope = {}) const {
    for (const Node& node : expression.nodes)
      if (node.kind == Node::Kind::name && scope.count(node.text) == 0)
        if (const Symbol* const symbol = model_.names.find(node.text)) need(needs, *symbol);
  }

  void need(Needs& needs, const Symbol& symbol) const {
    if (symbol.kind == Symbol::Kind::state) needs.states.insert(symbol.index);
    if (symbol.kind == Symbol::Kind::parameter) needs.parameters.insert(symbol.index);
    if (symbol.kind != Symbol::Kind::definition) return;
    if (std::find(needs.definitions.begin(), needs.definitions.end(), symbol.index) != needs.definitions.end()) return;
    need(needs, model_.file.definitions[symbol.index].value);
    needs.definitions.push_back(symbol.index);
  }

  /// Names for states and parameters, then the definitions.
  Lines locals(const Needs& needs) const {
    std::vector<std::string> references;
    for (const std::size_t k : needs.states)
      references.push_back(fmt::format("&{} = state[{}]", cpp_.at(model_.names.states()[k]), k));
    for (const std::size_t k : needs.parameters)
      references.push_back(fmt::format("&{} = par[{}]", cpp_.at(model_.file.parameters[k].name.text), k));
    Lines lines;
    if (!references.empty()) lines.push_back(fmt::format("const T {};", fmt::join(references, ", ")));
    for (const std::size_t k : needs.definitions) {
      const Assignment& definition = model_.file.definitions[k];
      lines.push_back(fmt::format("const T {} = {};", cpp_.at(definition.name.text), text_of(definition.value)));
    }
    return lines;
  }

  static void append(Lines& lines, const Lines& more) { lines.insert(lines.end(), more.begin(), more.end()); }

  static std::string indented(const Lines& lines, int blanks) {
    std::string text;
    for (const std::string& line : lines) text += std::string(static_cast<std::size_t>(blanks), ' ') + line + "\n";
    return text;
  }

  /// A body for each index; the last one, which is alone when there is one only, needs no condition.
  template <class Parts, class BodyOf>
  static std::string choice(const Parts& parts, const BodyOf& body_of) {
    std::string text;
    for (std::size_t k = 0; k + 1 < parts.size(); ++k)
      text += fmt::format("    if (index == {}) {{  // {}\n{}    }}\n", k + 1, parts[k].name,
                          indented(body_of(parts[k], true), 6));
    if (parts.size() > 1) text += fmt::format("    // {}\n", parts.back().name);
    return text + indented(body_of(parts.back(), false), 4);
  }

  std::string fields() const {
    const auto body = [&](const ProblemModel::Field& field, bool returns) {
      Needs needs;
      for (const Expression& rate : field.rates) need(needs, rate);
      Lines lines = locals(needs);
      for (std::size_t k = 0; k < field.rates.size(); ++k)
        lines.push_back(fmt::format("rate[{}] = {};", k, text_of(field.rates[k])));
      if (returns) lines.emplace_back("return;");
      return lines;
    };
    return fmt::format("  template <class T>\n  void field({}, T* rate) const {{\n{}  }}\n\n", marked_arguments(),
                       choice(model_.fields, body));
  }

  /// Plugins may be compiled with all warnings.
  static std::string marked_arguments() {
    return "[[maybe_unused]] int index, [[maybe_unused]] const T* state, [[maybe_unused]] const T* par";
  }

  std::string events() const {
    if (model_.events.empty()) return "";
    const auto body = [&](const ProblemModel::Function& event, bool) {
      Needs needs;
      need(needs, event.value);
      Lines lines = locals(needs);
      lines.push_back(fmt::format("return {};", text_of(event.value)));
      return lines;
    };
    return fmt::format("  template <class T>\n  T event({}) const {{\n{}  }}\n\n", marked_arguments(),
                       choice(model_.events, body));
  }

  std::string jumps() const {
    if (model_.jumps.empty()) return "";
    const auto body = [&](const ProblemModel::Jump& jump, bool returns) {
      Needs needs;
      for (const auto& [state, value] : jump.values) need(needs, value);
      Lines lines = locals(needs);
      for (const auto& [state, value] : jump.values)
        lines.push_back(fmt::format("image[{}] = {};", state, text_of(value)));
      if (returns) lines.emplace_back("return;");
      return lines;
    };
    return fmt::format(
        "  template <class T>\n  void jump({}, T* image) const {{\n"
        "    for (int i = 0; i < dimension; ++i) image[i] = state[i];\n{}  }}\n",
        marked_arguments(), choice(model_.jumps, body));
  }

  std::string user_functions() {
    std::string text;
    for (const FunctionDefinition& function : model_.file.functions) {
      Scope scope;
      std::string list;
      for (const Token& argument : function.arguments) {
        scope[argument.text] = names_.unique(argument.text);
        list += fmt::format(", const T& {}", scope[argument.text]);
      }
      Needs needs;
      need(needs, function.body, scope);
      Lines lines = locals(needs);
      lines.push_back(fmt::format("return {};", text_of(function.body, scope)));
      text += fmt::format(
          "  template <class T>\n  static T {}([[maybe_unused]] const T* state, [[maybe_unused]] const T* par{}) {{\n"
          "{}  }}\n\n",
          cpp_.at(function.name.text), list, indented(lines, 4));
    }
    return text;
  }

  std::string user_values() const {
    if (model_.user_values.empty()) return "";
    Needs needs;
    for (const auto& value : model_.user_values) need(needs, value.value);
    Lines lines = {"using T = double;"};
    append(lines, locals(needs));
    for (std::size_t k = 0; k < model_.user_values.size(); ++k)
      lines.push_back(fmt::format("values[{}] = {};", k, text_of(model_.user_values[k].value)));
    return fmt::format(
        "\n  static constexpr int user_values = {};\n{}"
        "  void user_value([[maybe_unused]] const double* state, [[maybe_unused]] const double* par, double* values) "
        "const {{\n{}  }}\n",
        model_.user_values.size(), strings("user_value_names", names_of_parts(model_.user_values)), indented(lines, 4));
  }

  std::string successors() const {
    if (model_.successors.empty()) return "";
    std::string text;
    bool is_last = false;
    for (const auto& rule : model_.successors)
      if (!is_last) text += indented(successor_lines(rule, is_last), 4);
    return fmt::format(
        "\n  /// The index vectors, field, event, jump, of which one follows `from`.\n"
        "  std::vector<std::array<int, 3>> successors([[maybe_unused]] std::array<int, 3> from,\n"
        "                                             [[maybe_unused]] const double* state,\n"
        "                                             [[maybe_unused]] const double* par) const {{\n"
        "{}{}  }}\n",
        text, is_last ? "" : "    return {};\n");
  }

  /// `is_last` becomes true for a rule that always holds.
  Lines successor_lines(const ProblemModel::SuccessorRule& rule, bool& is_last) const {
    std::vector<std::string> tests;
    if (rule.at_start) tests.emplace_back("from[0] == 0");
    for (std::size_t k = 0; k < 3; ++k)
      if (rule.from[k] != 0) tests.push_back(fmt::format("from[{}] == {}", k, rule.from[k]));
    std::vector<std::string> vectors;
    for (const std::array<int, 3>& next : rule.next) vectors.push_back(fmt::format("{{{}}}", fmt::join(next, ", ")));
    const std::string result = fmt::format("return {{{}}};", fmt::join(vectors, ", "));
    if (rule.following)
      tests.push_back(fmt::format("tchat::next_field(*this, {}[{}], from, state, par) == {}", slides_member,
                                  rule.following->slide, rule.following->field));
    is_last = tests.empty() && !rule.condition;
    if (!rule.condition) return {is_last ? result : fmt::format("if ({}) {}", fmt::join(tests, " && "), result)};
    Needs needs;
    need(needs, *rule.condition);
    Lines lines = {tests.empty() ? "{" : fmt::format("if ({}) {{", fmt::join(tests, " && ")), "  using T = double;"};
    for (const std::string& local : locals(needs)) lines.push_back("  " + local);
    lines.push_back(fmt::format("  if ({}) {}", text_of(*rule.condition), result));
    lines.emplace_back("}");
    return lines;
  }

  const ProblemModel& model_;
  CppNames names_;
  std::string class_;
  std::map<std::string, std::string> cpp_;
};

}  // namespace

std::string cpp_source(const ProblemModel& model, const std::string& class_name, const std::string& origin) {
  return CppWriter(model, class_name).source(origin);
}

}  // namespace tchat::formulas

namespace tchat {

namespace {

/// two-walls -> TwoWalls
std::string problem_name(const std::string& path) {
  std::string name;
  bool capital = true;
  for (const char c : std::filesystem::path(path).stem().string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_part = byte < 0x80 && std::isalnum(byte) != 0;
    if (is_part) name += capital ? static_cast<char>(std::toupper(byte)) : c;
    capital = !is_part;
  }
  return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0 ? "Problem" + name : name;
}

/// For a comment of one line, whatever the file is called.
std::string origin(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < 0x20 || c > 0x7e || c == '\\'; }, '_');
  return fmt::format("Translated from the formulas of {}.", name);
}

}  // namespace

Translation translate_formulas(std::string_view text, const std::string& path) {
  formulas::FormulaErrors errors;
  formulas::FormulaFile file = formulas::read_formula_file(text, errors);
  errors.throw_if_any(path, text);
  const formulas::ProblemModel model = formulas::check_formulas(std::move(file), errors);
  errors.throw_if_any(path, text);

  Translation result;
  result.cpp = formulas::cpp_source(model, problem_name(path), origin(path));
  for (const formulas::FormulaError& remark : model.remarks)
    result.remarks.push_back(fmt::format("{}:{}:{}: {}", path, remark.at.line, remark.at.column, remark.message));
  result.has_successors = !model.successors.empty();
  return result;
}

Translation translate_formula_file(const std::string& path) {
  return translate_formulas(read_text_file(path, "formulas of a problem", "give the path of NAME.tch"), path);
}

}  // namespace tchat
