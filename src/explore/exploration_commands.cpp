#include "explore/exploration_commands.hpp"

#include <fmt/format.h>

#include <cassert>
#include <filesystem>
#include <string_view>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "orbit/quantity.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/problem_type.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

namespace {

constexpr const char* both_directions = " --both";

/// "[1,2,3]"; "" for none.
std::string all_events(int count) {
  std::string text;
  for (int j = 1; j <= count; ++j) text += fmt::format("{}{}", text.empty() ? "[" : ",", j);
  return text.empty() ? "" : text + "]";
}

/// `what` is in the text.
void replace_first(std::string_view what, std::string_view by, std::string& text) {
  const std::size_t at = text.find(what);
  assert(at != std::string::npos);
  text.replace(at, what.size(), by);
}

/// Takes a word that begins so out of a command line, if there is one.
void remove_word(std::string_view beginning, std::string& line) {
  const std::size_t at = line.find(fmt::format(" {}", beginning));
  if (at != std::string::npos) line.erase(at, line.find(' ', at + 1) - at);
}

}  // namespace

std::string shell_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + quoted_for_shell(word);
  return text;
}

bool sets_parameter(const std::string& word) { return word.starts_with("PAR("); }

ExplorationCommands::ExplorationCommands(const ExploreRequest& request, const HybridSystem& system,
                                         bool has_added_section)
    : request_(request),
      range_(read_swept_range("--over", request.over)),
      folder_(request.output.value_or(request.name + ".diagram")),
      problem_(request.problem.value_or(request.name)),
      constants_option_(request.constants ? " -c " + quoted_for_shell(*request.constants) : "") {
  if (std::filesystem::path(folder_).lexically_normal() == std::filesystem::path(problem_).lexically_normal())
    throw UserError(fmt::format(
        "-o {0}: a folder of this name would be taken for the problem; give another name, as in -o {0}.diagram",
        folder_));
  find_parameter("--over", system, range_);
  for (const std::string& word : request.overrides) (sets_parameter(word) ? parameters_ : constants_).push_back(word);
  if (has_added_section) watched_ = all_events(system.count(FunctionKind::event) - 1);
  for (int k = 1; k <= system.dimension() && monitors_.size() + 2 <= max_monitors; ++k) {
    const std::string state = state_in_monitor(system, k);
    monitors_.push_back("mean(" + state + ")");
    monitors_.push_back(largest_value_column(state));  // as the sweep has it
  }
}

std::string ExplorationCommands::at_value(double value) const {
  return fmt::format("PAR({})={}", range_.parameter, value);
}

std::vector<std::string> ExplorationCommands::files_of(const std::string& name) const {
  return {file('p', name), file('q', name), file('d', name), file('r', name)};
}

/// The words of all runs: the range, steps that are fractions of it, then what the user says.
std::vector<std::string> ExplorationCommands::run_words(bool rests) const {
  const double width = range_.to - range_.from;
  std::string free = range_.parameter;
  if (!rests)
    for (const std::string& name : monitors_) free += "," + name;
  std::vector<std::string> words{fmt::format("ICP=[{}]", free),           fmt::format("RL0={}", range_.from),
                                 fmt::format("RL1={}", range_.to),        fmt::format("DS={:g}", width / 200.0),
                                 fmt::format("DSMAX={:g}", width / 20.0), "NMX=400"};
  if (!watched_.empty()) words.insert(words.end(), {"GRSTOP=0", "GCHGRZIND=[" + watched_ + "]"});
  if (!watched_.empty() && !rests) words.push_back("GCIPSI=" + watched_);
  words.insert(words.end(), constants_.begin(), constants_.end());
  return words;
}

CommandJob ExplorationCommands::sweep_job(const std::string& name, const std::vector<std::string>& states,
                                          const char* options) const {
  std::string words = shell_words({fmt::format("{}={}:{}:{}", range_.parameter, range_.from, range_.to, range_.count)});
  for (const std::string& state : states) words += " --state " + quoted_for_shell(state);
  CommandJob job{name, {}, {}, {path(name + ".sweep")}};
  job.lines = {fmt::format("tchat sweep {}{} --over{}{}{} --max -o {} -j {} -q", problem_arguments(problem_),
                           constants_option_, words, shell_words(parameters_), options, quoted_for_shell(path(name)),
                           request_.workers)};
  return job;
}

CommandJob ExplorationCommands::sweep() const { return sweep_job("sweep", request_.states, " --follow both"); }

CommandJob ExplorationCommands::sweep_from(const std::vector<std::string>& states) const {
  return sweep_job("starts", states, "");
}

CommandJob ExplorationCommands::start(const std::string& name, double value, const std::string& words,
                                      bool rests) const {
  std::vector<std::string> simulated = parameters_;
  simulated.push_back(at_value(value));
  const std::string arguments = problem_arguments(problem_);
  const std::string output = quoted_for_shell(path(name));
  return {name,
          {fmt::format("tchat simulate {}{} {}{} --free {} -o {} --dat -q", arguments, constants_option_, words,
                       shell_words(simulated), quoted_for_shell(range_.parameter), output),
           fmt::format("tchat run {} -c {} -d {} -o {} --both --clip{}", arguments, output, output, output,
                       shell_words(run_words(rests)))},
          {},
          files_of(name)};
}

CommandJob ExplorationCommands::switching(const SwitchPoint& at) const {
  const std::size_t both = at.command.find(" && ");
  const bool resegments = both != std::string::npos;
  const std::string name = fmt::format("{}_{}{}{}", at.branch, at.type, at.label, resegments ? "_branch" : "");
  CommandJob job{name, {}, {file('q', at.branch), file('r', at.branch)}, files_of(name)};
  if (resegments) job.lines.push_back(at.command.substr(0, both) + " -q");
  std::string run = resegments ? at.command.substr(both + 4) : at.command;
  run += std::string(at.type == "BP" || at.type == "BE" ? both_directions : "") + " --clip";
  std::vector<std::string> words = constants_;
  if (resegments || at.type == "HB") {  // begins with constants of its own; the sign of DS has been chosen
    words = run_words();
    std::erase_if(words, [](const std::string& word) { return word.starts_with("DS="); });
  }
  job.lines.push_back(run + shell_words(words));
  return job;
}

CommandJob ExplorationCommands::one_direction(const CommandJob& both, std::optional<double> other_ds) const {
  const std::string name = both.name + (other_ds ? "_backward" : "_forward");
  CommandJob job{name, both.lines, both.inputs, files_of(name)};
  std::string& run = job.lines.back();
  replace_first(" -o " + quoted_for_shell(path(both.name)), " -o " + quoted_for_shell(path(name)), run);
  replace_first(both_directions, "", run);
  if (other_ds) {
    remove_word("DS=", run);
    run += fmt::format(" DS={}", *other_ds);
  }
  return job;
}

bool ExplorationCommands::goes_in_both_directions(const CommandJob& job) {
  return job.lines.back().find(both_directions) != std::string::npos;
}

std::string ExplorationCommands::in_other_field(const std::string& branch, int label, int field) const {
  const std::string from = quoted_for_shell(path(branch));
  return fmt::format("tchat run {} -c {} -s {} IRS={} GCFIND=[{}] -o {}", problem_arguments(problem_),
                     quoted_for_shell(file('r', branch)), from, label, field,
                     quoted_for_shell(fmt::format("{}_BE{}", path(branch), label)));
}

CommandJob ExplorationCommands::correction(const OrbitComparison& at) const {
  const std::string name = fmt::format("{}_{}_like_{}_{}", at.branch, at.label, at.known, at.known_label);
  const std::string words =
      shell_words({fmt::format("IRS={}", at.known_label), "ISW=1", "ISP=0", "ILP=0",
                   fmt::format("UZR={{{}: {}}}", range_.parameter, at.value), fmt::format("NMX={}", at.points)});
  return {name,
          {fmt::format("tchat run {} -c {} -s {} -o {} --both --clip{}", problem_arguments(problem_),
                       quoted_for_shell(file('r', at.known)), quoted_for_shell(path(at.known)),
                       quoted_for_shell(path(name)), words)},
          {file('q', at.known), file('r', at.known)},
          files_of(name)};
}

std::vector<std::string> ExplorationCommands::born_lines(const std::string& source, const std::string& label,
                                                         int returns, const std::string& name) const {
  std::vector<std::string> words = run_words();
  std::erase_if(words, [](const std::string& word) { return word.starts_with("DS="); });  // the sign is chosen
  words.insert(words.begin(), {"ILP=1", "ISP=2"});
  const std::string cut = quoted_for_shell(path(name + "_start"));
  return {
      fmt::format("tchat resegment {} {} --to impacting --repeat {} -o {} -q{}", quoted_for_shell(file('q', source)),
                  label, returns, cut, shell_words({fmt::format("ICP=[{}]", range_.parameter)})),
      fmt::format("tchat run {} -c {} -s {} -o {} --clip{}", problem_arguments(problem_), cut, cut,
                  quoted_for_shell(path(name)), shell_words(words))};
}

CommandJob ExplorationCommands::born(const SwitchPoint& at, int returns) const {
  const std::string name = fmt::format("{}_{}{}_in{}", at.branch, at.type, at.label, returns);
  return {name,
          born_lines(at.branch, std::to_string(at.label), returns, name),
          {file('q', at.branch), file('r', at.branch)},
          files_of(name)};
}

std::string ExplorationCommands::show(double value, const std::string& words) const {
  std::vector<std::string> parameters = parameters_;
  parameters.push_back(at_value(value));
  return fmt::format("tchat simulate {}{} {}{}", problem_arguments(problem_), constants_option_, words,
                     shell_words(parameters));
}

}  // namespace tchat
