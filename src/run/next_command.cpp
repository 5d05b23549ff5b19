#include "run/next_command.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "constants/settings_type.hpp"
#include "files/run_files.hpp"
#include "hybrid/parameter_vector.hpp"
#include "problem_type/family.hpp"
#include "problem_type/problem_type.hpp"

namespace tchat {

namespace {

/// A word as the shell takes it.
std::string shell_word(const std::string& text) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-+=./:,").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// ICP(1), where it is a parameter of the problem; else 0.
int principal_parameter(const RunSettings& settings) {
  const int k = settings.free_parameters.empty() ? 0 : settings.free_parameters.front();
  return k < first_duration ? k : 0;
}

/// A parameter to vary beside ICP(1): one that ICP has, else the first of the problem; 0 where there is no other.
int second_parameter(const RunSettings& settings, const HybridSystem& system) {
  const int first = principal_parameter(settings);
  for (const int k : settings.free_parameters)
    if (k != first && k <= system.parameters()) return k;
  for (int k = 1; k <= system.parameters(); ++k)
    if (k != first) return k;
  return 0;
}

/// The type of branch that is born at a label, preferably with the same IPS; null where there is none.
const ProblemType* born_branch(int label_type, int number) {
  const ProblemType* found = nullptr;
  for (const ProblemType* type : problem_types())
    if (type->facts().switches_branch && type->begins_at(label_type) &&
        (found == nullptr || (found->facts().number != number && type->facts().number == number)))
      found = type;
  return found;
}

/// The curve in two parameters of the points of a label; null where there is none.
const ProblemType* curve_of(int label_type, int number) {
  for (const ProblemType* type : problem_types_of(number, 2))
    if (type->facts().curve == label_type) return type;
  return nullptr;
}

/// Words of `tchat run` that follow the branch or curve at a label; "" where there is none.
std::string run_words(const NextStart& start, const RunSettings& settings, const HybridSystem& system) {
  const int principal = principal_parameter(settings);
  if (principal == 0) return "";
  const std::string first = system.parameter_name(principal);
  if (const ProblemType* type = born_branch(start.type, settings.problem_type)) {
    const ProblemFacts& facts = type->facts();
    const std::string number = facts.number == settings.problem_type ? "" : fmt::format(" IPS={}", facts.number);
    const std::string further =
        *facts.start_words == '\0' ? "" : " " + fmt::format(fmt::runtime(facts.start_words), first);
    return fmt::format("{} ISW={}{}", number, facts.branch_mode, further);
  }
  const int second = second_parameter(settings, system);
  if (second == 0 || curve_of(start.type, settings.problem_type) == nullptr) return "";
  return fmt::format(" ISW=2 {}", shell_word(fmt::format("ICP=[{},{}]", first, system.parameter_name(second))));
}

}  // namespace

std::string next_command(const NextStart& start, const RunSettings& settings, const HybridSystem& system,
                         const RunRequest& request, const std::string& output) {
  const ProblemType& type = problem_type(settings);
  if (type.facts().in_two_parameters || type.facts().curve != 0) return "";
  const std::string problem = request.problem ? " -p " + shell_word(*request.problem) : "";
  const std::string name = shell_word(fmt::format("{}_{}{}", output, type_name(start.type, start.kind), start.label));
  const std::string solutions = shell_word(output_path('q', output));
  if (start.kind.kind == UserPointKind::contact) {
    if (!type.family().why_not(Analysis::resegmentation, "").empty()) return "";
    return fmt::format("tchat resegment {} {} --to impacting -o {} -p {} && tchat run {}{} -c {} -s {} -o {}_branch",
                       solutions, start.label, name, shell_word(request.problem.value_or(request.name)),
                       shell_word(request.name), problem, name, name, name);
  }
  if (start.kind.kind != UserPointKind::none) return "";
  const std::string words = run_words(start, settings, system);
  if (words.empty()) return "";
  return fmt::format("tchat run {}{} -c {} -s {} IRS={}{} -o {}", shell_word(request.name), problem,
                     shell_word(output_path('r', output)), shell_word(output), start.label, words, name);
}

}  // namespace tchat
