#include "plugin/problem_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/expression.hpp"
#include "plugin/formula_check.hpp"

namespace tchat::formulas {

namespace {

constexpr std::size_t most_definitions = 1000;

/// Names of fields, events or jumps, with their numbers.
class PartNames {
 public:
  explicit PartNames(std::string kind) : kind_(std::move(kind)) {}

  void add(const Token& name) {
    refuse_reserved_word(name);
    if (number(name.text) != 0)
      throw FormulaError{name.at,
                         fmt::format("there are two {}s with the name '{}'; choose another one", kind_, name.text)};
    names_.push_back(name.text);
  }

  /// From 1; 0 when there is none.
  int number(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found != names_.end() ? static_cast<int>(found - names_.begin()) + 1 : 0;
  }

  int required(const Token& name) const {
    const int found = number(name.text);
    if (found == 0)
      throw FormulaError{name.at,
                         fmt::format("there is no {0} '{1}'{2}; there {3} {4}; a line '{0} {1} ...' makes it", kind_,
                                     name.text, did_you_mean(name.text, names_), names_.size() == 1 ? "is" : "are",
                                     names_.empty() ? "none" : fmt::format("{}", fmt::join(names_, ", ")))};
    return found;
  }

  const std::vector<std::string>& all() const { return names_; }

 private:
  static void refuse_reserved_word(const Token& name) {
    for (const char* word : {"start", "any", "if", "until"})
      if (name.text == word)
        throw FormulaError{name.at, fmt::format("'{}' is a word of 'after' lines; choose another name", word)};
  }

  std::string kind_;
  std::vector<std::string> names_;
};

class ModelCheck {
 public:
  ModelCheck(ProblemModel& model, FormulaErrors& errors) : model_(model), errors_(errors) {}

  void all() {
    sizes();
    expressions();
    const DependenceTable* const table = dependences();
    parameters();
    initial_state();
    fields();
    events();
    slides();
    jumps();
    contacts();
    user_values();
    successors();
    if (table == nullptr) return;
    smoothness(*table);
    refuse_expensive_functions(file(), model_.names, errors_);
  }

 private:
  const FormulaFile& file() const { return model_.file; }

  template <class Work>
  void collect(Work&& work) {
    collecting(errors_, std::forward<Work>(work));
  }

  void sizes() {
    const Position file_as_a_whole{0, 0};
    if (model_.names.states().empty())
      errors_.add(file_as_a_whole, "there is no equation; write one for each state, as x' = v");
    if (model_.names.states().size() > static_cast<std::size_t>(most_states))
      errors_.add(file_as_a_whole, fmt::format("there are {} states, at most {} are allowed",
                                               model_.names.states().size(), most_states));
    if (file().parameters.size() > static_cast<std::size_t>(most_parameters))
      errors_.add(file().parameters[static_cast<std::size_t>(most_parameters)].name.at,
                  fmt::format("there are {} parameters, at most {} are allowed; write those that never change as "
                              "'number NAME=VALUE'",
                              file().parameters.size(), most_parameters));
    if (file().definitions.size() + file().functions.size() > most_definitions)
      errors_.add(file_as_a_whole, fmt::format("there are more than {} definitions", most_definitions));
  }

  /// Every expression of the file.
  void expressions() {
    const ExpressionCheck check(file(), model_.names, errors_);
    const auto values = [&](const std::vector<Assignment>& list) {
      for (const Assignment& one : list) check.value(one.value);
    };
    values(file().definitions);
    values(file().shared_equations);
    values(file().events);
    values(file().user_values);
    for (const Block& field : file().fields) values(field.lines);
    for (const Block& jump : file().jumps) values(jump.lines);
    for (const FunctionDefinition& function : file().functions) {
      check_arguments(function);
      check.value(function.body, function.arguments);
    }
    for (const SuccessorLine& line : file().successors)
      if (line.condition && !field_in(*line.condition)) check.condition(*line.condition);
  }

  /// A condition that is the name of a field of a sliding mode alone: is that the field that follows? Null for others.
  const std::string* field_in(const Expression& condition) const {
    if (condition.nodes.size() != 1 || condition.nodes.front().kind != Node::Kind::name) return nullptr;
    const std::string& name = condition.nodes.front().text;
    const auto has = [&](const SlideStatement& slide) {
      return slide.name.text == name || slide.ends[0].second.text == name || slide.ends[1].second.text == name;
    };
    return std::any_of(file().slides.begin(), file().slides.end(), has) ? &name : nullptr;
  }

  void check_arguments(const FunctionDefinition& function) {
    std::set<std::string> seen;
    for (const Token& argument : function.arguments)
      collect([&] {
        refuse_reserved(argument);
        if (!seen.insert(argument.text).second)
          throw FormulaError{argument.at, fmt::format("'{}' is an argument twice", argument.text)};
      });
  }

  /// Nothing when names are not as they must be for it.
  const DependenceTable* dependences() {
    if (!errors_.empty()) return nullptr;
    dependences_.emplace(file(), model_.names, errors_);
    return errors_.empty() ? &*dependences_ : nullptr;
  }

  void parameters() {
    for (const Assignment& parameter : file().parameters)
      collect([&] {
        model_.parameter_values.push_back(
            constant_value(parameter.value, fmt::format("the starting value of {}", parameter.name.text)));
      });
  }

  void initial_state() {
    if (file().initial.empty()) return;
    model_.initial_state.assign(model_.names.states().size(), 0.0);
    std::set<std::string> seen;
    for (const Assignment& value : file().initial)
      collect([&] {
        model_.initial_state[state_of(value.name)] =
            constant_value(value.value, fmt::format("the starting value of {}", value.name.text));
        if (!seen.insert(value.name.text).second)
          throw FormulaError{value.name.at, fmt::format("{} has two starting values", value.name.text)};
      });
  }

  std::size_t state_of(const Token& name) const {
    const Symbol* const symbol = model_.names.find(name.text);
    if (symbol != nullptr && symbol->kind == Symbol::Kind::state) return symbol->index;
    throw FormulaError{name.at, symbol != nullptr
                                    ? fmt::format("'{}' is {}, no state", name.text, in_words(symbol->kind))
                                    : fmt::format("there is no equation for '{0}'{1}; write {0}' = EXPRESSION",
                                                  name.text, did_you_mean(name.text, model_.names.states()))};
  }

  /// One for each state; null: none.
  using Equations = std::vector<const Assignment*>;

  Equations equations_of(const std::vector<Assignment>& lines) {
    Equations found(model_.names.states().size(), nullptr);
    for (const Assignment& line : lines)
      collect([&] {
        const Assignment*& equation = found[state_of(line.name)];
        if (equation != nullptr)
          throw FormulaError{line.name.at, fmt::format("{} has an equation already, in line {}; another field begins "
                                                       "with 'field NAME'",
                                                       line.name.text, equation->name.at.line)};
        equation = &line;
      });
    return found;
  }

  /// The equations before the first field hold in all fields that have none of their own.
  void fields() {
    const Equations shared = equations_of(file().shared_equations);
    if (file().fields.empty()) field({Token::Kind::name, "flow", 0.0, {}}, shared);
    for (const Block& block : file().fields)
      collect([&] {
        field_names_.add(block.name);
        Equations own = equations_of(block.lines);
        for (std::size_t k = 0; k < own.size(); ++k)
          if (own[k] == nullptr) own[k] = shared[k];
        own.resize(states_of(block));
        field(block.name, own);
      });
    for (const ModeStatement& mode : file().modes) collect([&] { field_names_.required(mode.field); });
  }

  /// How many states a field has: all, or those of its mode, which are the first ones.
  std::size_t states_of(const Block& field) const {
    const std::vector<std::string>& all = model_.names.states();
    const ModeStatement* const mode = mode_of(field.name);
    if (mode == nullptr) return all.size();
    for (std::size_t k = 0; k < mode->states.size(); ++k)
      if (state_of(mode->states[k]) != k)
        throw FormulaError{
            mode->states[k].at,
            fmt::format("the states of a mode are the first ones of all, in their order, which is that of "
                        "the equations: {}; write the equations of the largest field first",
                        fmt::join(all, ", "))};
    for (const Assignment& line : field.lines)
      if (state_of(line.name) >= mode->states.size())
        throw FormulaError{line.name.at, fmt::format("{} is no state of the mode {}", line.name.text, field.name.text)};
    return mode->states.size();
  }

  const ModeStatement* mode_of(const Token& field) const {
    const ModeStatement* found = nullptr;
    for (const ModeStatement& mode : file().modes) {
      if (mode.field.text != field.text) continue;
      if (found != nullptr) throw FormulaError{mode.field.at, fmt::format("there are two lines 'mode {}'", field.text)};
      found = &mode;
    }
    return found;
  }

  /// A state that an expression needs, itself or in a definition, of those behind the first ones; null: none. `seen`:
  /// definitions that have been looked at.
  const std::string* absent_state(const Expression& expression, std::size_t states, std::set<std::size_t>& seen) const {
    for (const Node& node : expression.nodes) {
      const Symbol* const symbol = node.kind == Node::Kind::name ? model_.names.find(node.text) : nullptr;
      if (symbol == nullptr) continue;
      if (symbol->kind == Symbol::Kind::state && symbol->index >= states) return &model_.names.states()[symbol->index];
      if (symbol->kind != Symbol::Kind::definition || !seen.insert(symbol->index).second) continue;
      const Expression& definition = file().definitions[symbol->index].value;
      if (const std::string* const inner = absent_state(definition, states, seen)) return inner;
    }
    return nullptr;
  }

  void field(const Token& name, const Equations& equations) {
    ProblemModel::Field made{name.text, {}};
    for (const Assignment* equation : equations) {
      std::set<std::size_t> seen;
      if (const std::string* const absent = equation ? absent_state(equation->value, equations.size(), seen) : nullptr)
        errors_.add(equation->name.at,
                    fmt::format("the equation for {} needs {}, which the mode {} has not; add it to 'mode {}'",
                                equation->name.text, *absent, name.text, name.text));
    }
    for (std::size_t k = 0; k < equations.size(); ++k)
      if (equations[k] != nullptr)
        made.rates.push_back(equations[k]->value);
      else
        errors_.add(name.at, fmt::format("the field {0} has no equation for {1}; write one below it, as {1}' = 0, or "
                                         "above the first field, where it holds in all",
                                         name.text, model_.names.states()[k]));
    model_.fields.push_back(std::move(made));
  }

  void events() {
    for (const Assignment& event : file().events)
      collect([&] {
        event_names_.add(event.name);
        model_.events.push_back({event.name.text, event.value});
      });
  }

  /// The fields and events that slide statements make, behind all others.
  void slides() {
    const std::size_t own_fields = field_names_.all().size(), own_events = event_names_.all().size();
    for (const SlideStatement& slide : file().slides)
      collect([&] {
        field_names_.add(slide.name);
        for (const auto& [event, field] : slide.ends) event_names_.add(event);
      });
    for (const SlideStatement& slide : file().slides)
      collect([&] {
        const int surface = own_part(event_names_.required(slide.surface), own_events, slide.surface);
        std::array<int, 2> sides{};
        for (std::size_t k = 0; k < 2; ++k)
          sides[k] =
              with_all_states(own_part(field_names_.required(slide.ends[k].second), own_fields, slide.ends[k].second),
                              slide.ends[k].second);
        if (sides[0] == sides[1])
          throw FormulaError{slide.ends[1].second.at,
                             fmt::format("on both sides of {} is the field {}; a surface to slide on has two fields",
                                         slide.surface.text, slide.ends[1].second.text)};
        model_.slides.push_back({slide.name.text,
                                 {slide.ends[0].first.text, slide.ends[1].first.text},
                                 field_names_.number(slide.name.text),
                                 sides[0],
                                 sides[1],
                                 surface,
                                 event_names_.number(slide.ends[0].first.text),
                                 event_names_.number(slide.ends[1].first.text)});
      });
  }

  int with_all_states(int field, const Token& name) const {
    if (model_.fields[static_cast<std::size_t>(field) - 1].rates.size() < model_.names.states().size())
      throw FormulaError{name.at,
                         fmt::format("the field {} has a mode of fewer states; fields beside a surface to slide "
                                     "on need all states",
                                     name.text)};
    return field;
  }

  /// What a sliding mode or contact is made of is not made by one itself.
  static int own_part(int number, std::size_t own, const Token& name) {
    if (static_cast<std::size_t>(number) > own)
      throw FormulaError{name.at,
                         fmt::format("'{}' is made by a slide or contact statement; surfaces, the fields beside them "
                                     "and impacts have formulas of their own",
                                     name.text)};
    return number;
  }

  /// A name of one more thing that a statement makes.
  static Token with_ending(Token name, const char* ending) {
    name.text += ending;
    return name;
  }
  /// The event function that says how far chatter is from being incomplete.
  static Token margin_of(const ContactStatement& contact) { return with_ending(contact.limit, "_margin"); }
  /// The event function that is the time which the impacts of the limit take.
  static Token time_of(const ContactStatement& contact) { return with_ending(contact.limit, "_time"); }
  /// The jump after contact.
  static Token end_of(const ContactStatement& contact) { return with_ending(contact.name, "_end"); }

  /// What contact statements make, behind all else.
  void contacts() {
    const std::size_t own_fields = model_.fields.size(), own_events = model_.events.size();
    const std::size_t own_jumps = model_.jumps.size();
    if (!file().contacts.empty() && file().fields.empty())
      field_names_.add({Token::Kind::name, model_.fields.front().name, 0.0, {}});
    for (const ContactStatement& contact : file().contacts)
      collect([&] {
        field_names_.add(contact.name);
        event_names_.add(contact.release);
        jump_names_.add(contact.limit);
        event_names_.add(margin_of(contact));
        event_names_.add(time_of(contact));
        jump_names_.add(end_of(contact));
      });
    for (const ContactStatement& contact : file().contacts)
      collect([&] {
        const int field = own_part(field_number(contact.field), own_fields, contact.field);
        const Token margin = margin_of(contact), time = time_of(contact), end = end_of(contact);
        model_.contacts.push_back({contact.name.text, contact.release.text, contact.limit.text, margin.text, end.text,
                                   time.text, with_all_states(field, contact.field),
                                   own_part(event_names_.required(contact.surface), own_events, contact.surface),
                                   own_part(jump_names_.required(contact.impact), own_jumps, contact.impact),
                                   field_names_.number(contact.name.text), event_names_.number(contact.release.text),
                                   jump_names_.number(contact.limit.text), event_names_.number(margin.text),
                                   jump_names_.number(end.text), event_names_.number(time.text)});
      });
  }

  void jumps() {
    for (const Block& block : file().jumps) collect([&] { jump(block); });
    if (jump_names_.number("identity") != 0) return;
    jump_names_.add({Token::Kind::name, "identity", 0.0, {}});
    model_.jumps.push_back({"identity", {}, model_.names.states().size()});
  }

  void jump(const Block& block) {
    jump_names_.add(block.name);
    if (event_names_.number(block.name.text) != 0)
      throw FormulaError{block.name.at,
                         fmt::format("'{}' is an event already; a jump needs another name, for 'after {}' "
                                     "would mean both",
                                     block.name.text, block.name.text)};
    ProblemModel::Jump made{block.name.text, {}, model_.names.states().size()};
    if (block.target) {
      const int field = field_names_.required(*block.target);
      if (static_cast<std::size_t>(field) <= model_.fields.size())
        made.states = model_.fields[static_cast<std::size_t>(field) - 1].rates.size();
    }
    std::set<std::size_t> seen;
    for (const Assignment& line : block.lines)
      collect([&] {
        made.values.emplace_back(state_of(line.name), line.value);
        if (made.values.back().first >= made.states)
          throw FormulaError{line.name.at, fmt::format("{} is no state of the mode {}, to which the jump {} leads",
                                                       line.name.text, block.target->text, block.name.text)};
        if (!seen.insert(made.values.back().first).second)
          throw FormulaError{line.name.at,
                             fmt::format("the jump {} gives {} two values", block.name.text, line.name.text)};
      });
    model_.jumps.push_back(std::move(made));
  }

  void user_values() {
    std::set<std::string> seen;
    for (const Assignment& value : file().user_values)
      collect([&] {
        if (!seen.insert(value.name.text).second)
          throw FormulaError{value.name.at, fmt::format("there are two values with the name '{}'", value.name.text)};
        model_.user_values.push_back({value.name.text, value.value});
      });
  }

  void successors() {
    if (file().successors.empty()) return;
    for (const SuccessorLine& line : file().successors) collect([&] { model_.successors.push_back(rule(line)); });
    if (errors_.empty()) require_complete();
    if (errors_.empty()) require_reachable_fields();
  }

  ProblemModel::SuccessorRule rule(const SuccessorLine& line) const {
    ProblemModel::SuccessorRule made;
    if (const std::string* const field = line.condition ? field_in(*line.condition) : nullptr)
      made.following = following(*field, line.condition->nodes.front().at);
    else
      made.condition = line.condition;
    for (const Token& name : line.from) add_condition(made, name, line.from.size() == 1);
    if (!line.field && field_count() > 1)
      throw FormulaError{line.ends.front().first.at,
                         fmt::format("which field is followed? write 'FIELD until {} -> {}'; there are {}",
                                     line.ends.front().first.text, line.ends.front().second.text,
                                     fmt::join(field_names_.all(), ", "))};
    const int field = line.field ? field_number(*line.field) : 1;
    for (std::size_t k = 0; k < model_.contacts.size(); ++k)
      if (made.from[2] == model_.contacts[k].limit && field != model_.contacts[k].contact)
        throw FormulaError{
            line.ends.front().first.at,
            fmt::format("after {} comes contact: write '{} until {} -> {}'", file().contacts[k].limit.text,
                        file().contacts[k].name.text, line.ends.front().first.text, line.ends.front().second.text)};
    for (const auto& [event, jump] : line.ends)
      made.next.push_back({field, event_names_.required(event), jump_names_.required(jump)});
    return made;
  }

  /// Without those of contact, to which the limits of chatter lead and no line needs to.
  std::size_t field_count() const { return model_.fields.size() + model_.slides.size(); }

  ProblemModel::Following following(const std::string& field, Position at) const {
    const int number = field_names_.number(field);
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < model_.slides.size(); ++k) {
      const ProblemModel::Slide& slide = model_.slides[k];
      if (number == slide.field || number == slide.minus || number == slide.plus) found.push_back(k);
    }
    if (found.size() != 1)
      throw FormulaError{at,
                         fmt::format("the field {} is a side of {} surfaces to slide on, so that 'if {}' does not say "
                                     "which is meant; write the lines for their sliding fields",
                                     field, found.size(), field)};
    return {found.front(), number};
  }

  int field_number(const Token& name) const {
    return file().fields.empty() && name.text == model_.fields.front().name ? 1 : field_names_.required(name);
  }

  void add_condition(ProblemModel::SuccessorRule& made, const Token& name, bool is_alone) const {
    if (name.text == "start" || name.text == "any") {
      if (!is_alone)
        throw FormulaError{name.at, fmt::format("'{}' stands alone, as 'after {}: ...'", name.text, name.text)};
      made.at_start = name.text == "start";
      return;
    }
    const std::array<const PartNames*, 3> parts = {&field_names_, &event_names_, &jump_names_};
    std::array<int, 3> found{};
    for (std::size_t k = 0; k < 3; ++k) found[k] = parts[k]->number(name.text);
    const long matches = 3 - std::count(found.begin(), found.end(), 0);
    if (matches == 0) refuse_unknown_part(name);
    for (std::size_t k = 0; k < 3; ++k) {
      if (found[k] == 0) continue;
      if (matches > 1)
        throw FormulaError{name.at,
                           fmt::format("'{}' is a field as well as an event or a jump; rename one", name.text)};
      if (made.from[k] != 0)
        throw FormulaError{name.at,
                           fmt::format("behind 'after' stand one field, one event and one jump at most; '{}' is "
                                       "one too many, write a line of its own for it",
                                       name.text)};
      made.from[k] = found[k];
    }
  }

  [[noreturn]] void refuse_unknown_part(const Token& name) const {
    std::vector<std::string> known = {"start", "any"};
    for (const PartNames* part : {&field_names_, &event_names_, &jump_names_})
      known.insert(known.end(), part->all().begin(), part->all().end());
    throw FormulaError{name.at, fmt::format("there is no field, event or jump '{}'{}; there are {}", name.text,
                                            did_you_mean(name.text, known), fmt::join(known, ", "))};
  }

  static bool matches(const ProblemModel::SuccessorRule& rule, const std::array<int, 3>& from) {
    if (rule.condition || rule.following || (rule.at_start && from[0] != 0)) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (rule.from[k] != 0 && rule.from[k] != from[k]) return false;
    return true;
  }

  /// Something must follow the start and everything that can happen, whatever the conditions say.
  void require_complete() {
    std::set<std::array<int, 3>> all = {{0, 0, 0}};
    for (const auto& rule : model_.successors) all.insert(rule.next.begin(), rule.next.end());
    for (const auto& contact : model_.contacts) all.insert({contact.contact, contact.release, contact.leave});
    for (const std::array<int, 3>& from : all) {
      const auto follows = [&](const ProblemModel::SuccessorRule& rule) { return matches(rule, from); };
      if (std::none_of(model_.successors.begin(), model_.successors.end(), follows))
        errors_.add(file().successors.back().at,
                    fmt::format("what follows {} is not said for every state; add a line '{}: ...' without 'if'",
                                in_words_of(from), after_words(from)));
    }
  }

  /// A field that nothing leads to has been forgotten in some line, and a simulation would go on in another one.
  void require_reachable_fields() {
    std::set<int> reached;
    for (const auto& rule : model_.successors)
      for (const std::array<int, 3>& next : rule.next) reached.insert(next[0]);
    for (std::size_t k = 0; k < field_count(); ++k)
      if (!reached.contains(static_cast<int>(k) + 1))
        errors_.add(
            file().successors.back().at,
            fmt::format("no 'after' line leads to field {0}; write one, as after EVENT: {0} until EVENT -> JUMP",
                        field_name(k)));
  }

  const std::string& field_name(std::size_t k) const {
    return k < model_.fields.size() ? model_.fields[k].name : model_.slides[k - model_.fields.size()].name;
  }

  std::string in_words_of(const std::array<int, 3>& from) const {
    if (from[0] == 0) return "the start";
    const auto at = [&](std::size_t k) { return static_cast<std::size_t>(from[k] - 1); };
    return fmt::format("{} -> {}{}", event_names_.all()[at(1)], jump_names_.all()[at(2)],
                       field_count() > 1 || at(0) > 0 ? " of field " + field_names_.all()[at(0)] : "");
  }

  std::string after_words(const std::array<int, 3>& from) const {
    return from[0] == 0 ? "after start" : "after " + event_names_.all()[static_cast<std::size_t>(from[1] - 1)];
  }

  /// Fields and events are differentiated along orbits: a jump in their values has no derivative that could be right.
  void smoothness(const DependenceTable& table) {
    for (const auto& field : model_.fields)
      for (const Expression& rate : field.rates) smooth(table.of(rate), "field " + field.name);
    for (const auto& event : model_.events) refuse_step(table.of(event.value), "event " + event.name);
  }

  void smooth(const StateDependence& dependence, const std::string& where) {
    refuse_step(dependence, where);
    if (!dependence.kink) return;
    const Roughness& kink = *dependence.kink;
    const auto is_same = [&](const FormulaError& remark) {
      return remark.at.line == kink.at.line && remark.at.column == kink.at.column;
    };
    if (std::any_of(model_.remarks.begin(), model_.remarks.end(), is_same)) return;
    model_.remarks.push_back(
        {kink.at, fmt::format("{}(...) has a kink, and {} uses it with something that moves: where an orbit passes the "
                              "kink, derivatives are one-sided and the mesh must be fine there; two fields with an "
                              "event between them are exact",
                              kink.function, where)});
  }

  void refuse_step(const StateDependence& dependence, const std::string& where) {
    if (!dependence.step) return;
    const Roughness& step = *dependence.step;
    if (!refused_.insert({step.at.line, step.at.column}).second) return;
    errors_.add(step.at, fmt::format("{}(...) jumps in value, and {} uses it with something that moves, where "
                                     "derivatives and multipliers would be wrong; write two fields and an event at "
                                     "which one ends",
                                     step.function, where));
  }

  ProblemModel& model_;
  FormulaErrors& errors_;
  std::optional<DependenceTable> dependences_;
  PartNames field_names_{"field"};
  PartNames event_names_{"event"};
  PartNames jump_names_{"jump"};
  std::set<std::pair<int, int>> refused_;
};

}  // namespace

ProblemModel check_formulas(FormulaFile file, FormulaErrors& errors) {
  NameTable names(file, errors);
  ProblemModel model{std::move(file), std::move(names), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  ModelCheck(model, errors).all();
  return model;
}

}  // namespace tchat::formulas
