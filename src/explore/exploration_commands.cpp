#include "explore/exploration_commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "orbit/quantity.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/problem_type.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

SweptRange read_swept_range(const std::string& option, const std::string& text, bool may_have_count) {
  const auto refuse = [&] {
    throw UserError(fmt::format("{} {}: a parameter with the range of its values is needed, as alpha=2.9:3.3{}", option,
                                in_quotes(text),
                                may_have_count ? ", or with the number of values, alpha=2.9:3.3:401" : ""));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse();
  SweptRange range{text.substr(0, equals)};
  std::vector<std::string> parts;
  for (std::size_t from = equals + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(':', from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  if (parts.size() < 2 || parts.size() > (may_have_count ? 3 : 2)) refuse();
  const std::optional<double> a = parse_real(parts[0]), b = parse_real(parts[1]);
  const std::optional<int> count = parts.size() == 3 ? parse_integer(parts[2]) : std::optional(range.count);
  if (!a || !b || !(*a < *b) || !count || *count < 2) refuse();
  range.from = *a, range.to = *b, range.count = *count;
  return range;
}

int find_parameter(const std::string& option, const HybridSystem& system, SweptRange& range) {
  range.parameter = bare_name(range.parameter);
  const int number = parameter_index(system, range.parameter, option);
  if (number > system.parameters())
    throw UserError(fmt::format("{} {}: a duration is no parameter of a simulation", option, range.parameter));
  if (const std::string name = system.parameter_name(number); system.parameter_index(name) == number)
    range.parameter = name;
  return number;
}

namespace {

namespace fs = std::filesystem;

const std::string both_directions = "--both";

/// "[1,2,3]"; "" for none.
std::string all_events(int count) {
  std::string text;
  for (int j = 1; j <= count; ++j) text += fmt::format("{}{}", text.empty() ? "[" : ",", j);
  return text.empty() ? "" : text + "]";
}

bool sets_step(const std::string& word) { return word.starts_with("DS="); }
bool sets_points(const std::string& word) { return word.starts_with("NMX="); }

/// The folder without slashes behind it.
std::string folder_of(const ExploreRequest& request) {
  if (!request.output) return request.name + ".diagram";
  std::string folder = *request.output;
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  return folder;
}

[[noreturn]] void refuse_folder(const std::string& folder, const std::string& why) {
  throw UserError(fmt::format("-o {}: {}", in_quotes(folder), why));
}

/// Commands, a Makefile and picture names are made with it: make has no quotes, and reads some characters as its own.
void check_name(const std::string& folder) {
  const std::string last = fs::path(folder).filename().string();
  if (last.empty() || last == "." || last == "..")
    refuse_folder(folder, "the diagram needs a folder with a name of its own, as -o osc");
  const std::size_t bad = folder.find_first_of(" \t\n\r:=;'\"$#%\\&|<>()*?[]{}!`~^,");
  if (bad != std::string::npos)
    refuse_folder(folder, fmt::format("a Makefile cannot name files in a folder with {} in its name; use letters, "
                                      "digits, '_', '-', '+', '.' and '/'",
                                      in_quotes(folder.substr(bad, 1))));
  if (folder.front() == '-')
    refuse_folder(folder, fmt::format("a command would take this for an option; write -o ./{}", folder));
}

void check_folder(const std::string& folder, const std::string& problem) {
  check_name(folder);
  if (fs::path(folder).lexically_normal() == fs::path(problem).lexically_normal())
    refuse_folder(folder, fmt::format("a folder of this name would be taken for the problem; give another name, as in "
                                      "-o {}.diagram",
                                      folder));
  std::error_code failed;
  if (fs::exists(folder, failed) && !fs::is_directory(folder, failed))
    refuse_folder(folder, "this is a file, and a folder is needed; remove it, or give another name");
  fs::create_directories(folder, failed);
  if (failed) refuse_folder(folder, fmt::format("the folder cannot be made: {}", failed.message()));
  const std::string beside = fs::path(folder).has_parent_path() ? fs::path(folder).parent_path().string() : ".";
  for (const std::string& place : {folder, beside})
    if (::access(place.c_str(), W_OK | X_OK) != 0)
      refuse_folder(folder, fmt::format("files cannot be written in {}; make it writable, or give a name in another "
                                        "folder",
                                        place == "." ? "this folder" : place));
}

}  // namespace

bool sets_parameter(const std::string& word) { return word.starts_with("PAR("); }

ExplorationCommands::ExplorationCommands(const ExploreRequest& request, const HybridSystem& system,
                                         bool has_added_section, GivenFiles given)
    : request_(request),
      range_(read_swept_range("--over", request.over)),
      folder_(folder_of(request)),
      problem_(request.problem.value_or(request.name)),
      given_(std::move(given)) {
  find_parameter("--over", system, range_);
  check_folder(folder_, problem_);
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

CommandJob ExplorationCommands::job(const std::string& name, Commands commands, std::vector<std::string> inputs) const {
  return {name, std::move(commands), std::move(inputs), files_of(name), given_.problem};
}

CommandJob ExplorationCommands::job_from(const std::string& source, const std::string& name, Commands commands) const {
  return job(name, std::move(commands), {file('q', source), file('r', source)});
}

/// The words of all runs: the range, steps that are fractions of it, then what the user says.
Command ExplorationCommands::run_words(bool rests) const {
  const double width = range_.to - range_.from;
  std::string free = range_.parameter;
  if (!rests)
    for (const std::string& name : monitors_) free += "," + name;
  Command words{fmt::format("ICP=[{}]", free),           fmt::format("RL0={}", range_.from),
                fmt::format("RL1={}", range_.to),        fmt::format("DS={:g}", width / 200.0),
                fmt::format("DSMAX={:g}", width / 20.0), fmt::format("NMX={}", usual_points)};
  if (!watched_.empty()) words.insert(words.end(), {"GRSTOP=0", "GCHGRZIND=" + watched_});
  if (!watched_.empty() && !rests) words.push_back("GCIPSI=" + watched_);
  words.insert(words.end(), constants_.begin(), constants_.end());
  return words;
}

Command ExplorationCommands::run_words_without_step() const {
  Command words = run_words();
  std::erase_if(words, sets_step);
  return words;
}

CommandJob ExplorationCommands::sweep_job(const std::string& name, const std::vector<std::string>& states,
                                          const Command& options) const {
  Command from;
  for (const std::string& state : states) from.insert(from.end(), {"--state", state});
  Command command =
      words_of({{"sweep"},
                problem_words(problem_),
                request_.constants ? Command{"-c", *request_.constants} : Command{},
                {"--over", fmt::format("{}={}:{}:{}", range_.parameter, range_.from, range_.to, range_.count)},
                from,
                parameters_,
                options,
                {"--max", "-o", path(name), "-j", std::to_string(request_.workers), "-q"}});
  CommandJob result = job(name, {std::move(command)}, {});
  result.outputs = {path(name + ".sweep")};
  result.given.insert(result.given.end(), given_.constants.begin(), given_.constants.end());
  return result;
}

CommandJob ExplorationCommands::sweep() const { return sweep_job("sweep", request_.states, {"--follow", "both"}); }

CommandJob ExplorationCommands::sweep_from(const std::vector<std::string>& states) const {
  return sweep_job("starts", states, {});
}

Command ExplorationCommands::show(double value, const Command& words) const {
  return words_of({{"simulate"},
                   problem_words(problem_),
                   request_.constants ? Command{"-c", *request_.constants} : Command{},
                   words,
                   parameters_,
                   {at_value(value)}});
}

CommandJob ExplorationCommands::start(const std::string& name, double value, const Command& words, bool rests) const {
  const std::string output = path(name);
  const Command simulated = words_of({show(value, words), {"--free", range_.parameter, "-o", output, "--dat", "-q"}});
  const Command run = words_of({{"run"},
                                problem_words(problem_),
                                {"-c", output, "-d", output, "-o", output, both_directions, "--clip"},
                                run_words(rests)});
  CommandJob result = job(name, {simulated, run}, {});
  result.given.insert(result.given.end(), given_.constants.begin(), given_.constants.end());
  return result;
}

CommandJob ExplorationCommands::switching(const std::string& name, const SwitchPoint& at) const {
  CommandJob result = job_from(at.branch, name, at.commands);
  const bool resegments = at.commands.size() > 1;
  if (resegments) result.commands.front().push_back("-q");
  Command& run = result.commands.back();
  if (at.type == "BP" || at.type == "BE") run.push_back(both_directions);
  // What begins with constants of its own has the sign of DS chosen.
  run = words_of({run, {"--clip"}, resegments || at.type == "HB" ? run_words_without_step() : constants_});
  return result;
}

CommandJob ExplorationCommands::one_direction(CommandJob both, std::optional<double> other_ds) {
  Command& run = both.commands.back();
  std::erase(run, both_directions);
  if (!other_ds) return both;
  std::erase_if(run, sets_step);
  run.push_back(fmt::format("DS={}", *other_ds));
  return both;
}

CommandJob ExplorationCommands::with_points(CommandJob job, int points) {
  Command& run = job.commands.back();
  std::erase_if(run, sets_points);
  run.push_back(fmt::format("NMX={}", points));
  return job;
}

bool ExplorationCommands::limits_points() const {
  return std::any_of(constants_.begin(), constants_.end(), sets_points);
}

bool ExplorationCommands::goes_in_both_directions(const CommandJob& job) {
  const Command& run = job.commands.back();
  return std::find(run.begin(), run.end(), both_directions) != run.end();
}

Command ExplorationCommands::in_other_field(const std::string& name, const std::string& branch, int label,
                                            int field) const {
  return words_of({{"run"},
                   problem_words(problem_),
                   {"-c", file('r', branch), "-s", path(branch), fmt::format("IRS={}", label),
                    fmt::format("GCFIND=[{}]", field), "-o", path(name)}});
}

CommandJob ExplorationCommands::correction(const OrbitComparison& at) const {
  const std::string name = fmt::format("{}_{}_like_{}_{}", at.branch, at.label, at.known, at.known_label);
  return job_from(
      at.known, name,
      {words_of({{"run"},
                 problem_words(problem_),
                 {"-c", file('r', at.known), "-s", path(at.known), "-o", path(name), both_directions, "--clip",
                  fmt::format("IRS={}", at.known_label), "ISW=1", "ISP=0", "ILP=0",
                  fmt::format("UZR={{{}: {}}}", range_.parameter, at.value), fmt::format("NMX={}", at.points)}})});
}

Commands ExplorationCommands::born_commands(const std::string& source, const std::string& label, int returns,
                                            const std::string& name) const {
  const std::string cut = path(name + "_start");
  return {{"resegment", file('q', source), label, "--to", "impacting", "--repeat", std::to_string(returns), "-o", cut,
           "-q", fmt::format("ICP=[{}]", range_.parameter)},
          words_of({{"run"},
                    problem_words(problem_),
                    {"-c", cut, "-s", cut, "-o", path(name), "--clip", "ILP=1", "ISP=2"},
                    run_words_without_step()})};
}

CommandJob ExplorationCommands::born(const std::string& name, const SwitchPoint& at, int returns) const {
  return job_from(at.branch, name, born_commands(at.branch, std::to_string(at.label), returns, name));
}

}  // namespace tchat
