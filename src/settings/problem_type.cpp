#include "settings/problem_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "base/messages.hpp"
#include "settings/point_type.hpp"

namespace tchat {

namespace {

constexpr int in_two_parameters = 2;     // ISW, of AUTO too
constexpr int auto_periodic[] = {2, 7};  // AUTO's IPS of periodic orbits
constexpr int shared[] = {boundary_value.number, equilibrium.number};

template <class Value>
std::vector<int> each_once(Value value) {
  std::vector<int> list;
  for (const ProblemType* type : problem_types())
    if (const int v = value(type->facts()); std::find(list.begin(), list.end(), v) == list.end()) list.push_back(v);
  return list;
}

}  // namespace

std::vector<const ProblemType*> problem_types_of(int number, int branch_mode) {
  std::vector<const ProblemType*> found;
  for (const ProblemType* type : problem_types())
    if (type->facts().number == number && type->facts().branch_mode == standard_branch_mode(branch_mode))
      found.push_back(type);
  return found;
}

const ProblemType* nearest_problem_type(int number, int branch_mode) {
  if (const auto exact = problem_types_of(number, branch_mode); !exact.empty()) return exact.front();
  for (const ProblemType* type : problem_types())
    if (type->facts().number == number) return type;
  return nullptr;
}

const ProblemType& problem_type(int number, int branch_mode) {
  if (const auto found = problem_types_of(number, branch_mode); !found.empty()) return *found.front();
  std::string list;
  const ProblemFacts* before = nullptr;
  for (const ProblemType* type : problem_types()) {
    const ProblemFacts& facts = type->facts();
    const bool again = before != nullptr && before->number == facts.number && before->branch_mode == facts.branch_mode;
    list += again ? fmt::format("; {}", facts.title)
                  : fmt::format("\n  IPS = {}, ISW = {}: {}", facts.number, facts.branch_mode, facts.title);
    before = &facts;
  }
  throw UserError(fmt::format("IPS = {} with ISW = {} is not a problem that tchat solves; there are:{}", number,
                              branch_mode, list));
}

bool may_double_segments(int branch_mode) {
  const auto doubles = [branch_mode](const ProblemType* type) {
    return type->facts().branch_mode == branch_mode && type->facts().may_double;
  };
  return std::any_of(problem_types().begin(), problem_types().end(), doubles);
}

int standard_branch_mode(int branch_mode) { return branch_mode == 0 ? 1 : branch_mode; }

std::vector<int> problem_type_numbers() {
  return each_once([](const ProblemFacts& facts) { return facts.number; });
}

std::vector<int> branch_modes() {
  return each_once([](const ProblemFacts& facts) { return facts.branch_mode; });
}

std::string problem_families() {
  std::string text;
  for (const int number : problem_type_numbers())
    text += fmt::format("{}{} ({})", text.empty() ? "" : " or ", number,
                        nearest_problem_type(number, 1)->facts().solutions);
  return text;
}

bool is_own_problem_type(int number) { return nearest_problem_type(number, 1) != nullptr; }

bool is_shared_problem_type(int number) {
  return is_own_problem_type(number) && std::find(std::begin(shared), std::end(shared), number) != std::end(shared);
}

const SolutionFamily& family_of(int number) {
  const ProblemType* type = nearest_problem_type(number, 1);
  return (type != nullptr ? *type : problem_type(periodic_orbit.number, 1)).family();
}

bool records_problem_type(int number) { return number != 0; }

bool is_same_problem_type(int number, int other) {
  return !records_problem_type(number) || !records_problem_type(other) || number == other;
}

bool keeps_contact(int number) {
  const ProblemType* type = nearest_problem_type(number, 1);
  return type != nullptr && type->facts().keeps_contact;
}

bool is_two_parameter_curve(int number, int branch_mode) {
  const ProblemType* type = nearest_problem_type(number, branch_mode);
  return std::abs(branch_mode) == in_two_parameters || (type != nullptr && type->facts().in_two_parameters);
}

std::string curve_name(int number, int curve_type) {
  if (curve_type != -static_cast<int>(PointType::user)) return type_name(curve_type);
  const bool is_at_rest = number == equilibrium.number;
  return type_name(-curve_type, {is_at_rest ? UserPointKind::boundary_equilibrium : UserPointKind::contact});
}

bool has_two_parameter_curves(int number) { return !problem_types_of(number, in_two_parameters).empty(); }

const ProblemType* birth_type(int label_type, int number, bool in_two_parameters) {
  const auto is_born = [&](const ProblemType* type) {
    const ProblemFacts& facts = type->facts();
    return facts.switches_branch && facts.in_two_parameters == in_two_parameters && type->begins_at(label_type) &&
           number == (facts.starts_from == 0 ? facts.number : facts.starts_from);
  };
  const auto all = problem_types();
  const auto found = std::find_if(all.begin(), all.end(), is_born);
  return found == all.end() ? nullptr : *found;
}

Command birth_words(int label_type, int number, bool in_two_parameters, const std::string& principal) {
  const ProblemType* const type = birth_type(label_type, number, in_two_parameters);
  if (type == nullptr) return {};
  const ProblemFacts& facts = type->facts();
  Command words;
  if (facts.number != number) words.push_back(fmt::format("IPS={}", facts.number));
  words.push_back(fmt::format("ISW={}", facts.branch_mode));
  if (*facts.start_word != '\0') words.push_back(fmt::format(fmt::runtime(facts.start_word), principal));
  return words;
}

bool has_multipliers(int number) {
  const ProblemType* type = nearest_problem_type(number, 1);
  return type == nullptr || type->facts().stability != StabilityMeaning::none;
}

bool has_critical_multiplier(int number, int branch_mode) {
  const auto types = problem_types_of(number, std::abs(branch_mode));
  if (types.empty()) return std::abs(branch_mode) == in_two_parameters;
  return types.front()->facts().stability == StabilityMeaning::critical;
}

std::optional<int> auto_period(int number) {
  constexpr int parameter = 11;
  const bool periodic =
      std::find(std::begin(auto_periodic), std::end(auto_periodic), number) != std::end(auto_periodic);
  return periodic ? std::optional(parameter) : std::nullopt;
}

}  // namespace tchat
