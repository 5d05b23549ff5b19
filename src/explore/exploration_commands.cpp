#include "explore/exploration_commands.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>
#include <string_view>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/replaced_file.hpp"
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

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

std::string text_of(const std::string& path) { return read_text_if_there(path, "output of a command").value_or(""); }

/// Has it been done, by the same commands, and are its files there?
bool is_done(const CommandJob& job, const std::string& stamp) {
  return fs::exists(stamp) && text_of(stamp) == joined(job.lines) &&
         std::all_of(job.outputs.begin(), job.outputs.end(), [](const std::string& file) { return fs::exists(file); });
}

/// The folders of commands, that of this program first: a command is to be of the same tchat.
std::string search_path() {
  const char* const known = std::getenv("PATH");
  return fs::read_symlink("/proc/self/exe").parent_path().string() + ":" + (known != nullptr ? known : "/usr/bin:/bin");
}

/// In the child: the shell becomes the command, which ends when this program does.
[[noreturn]] void become(const std::string& line, const std::string& log, const std::string& path, pid_t parent) {
  ::setenv("PATH", path.c_str(), 1);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const int none = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::dup2(none, STDIN_FILENO);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  const std::string command = "exec " + line;
  ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
  ::_exit(127);
}

}  // namespace

struct JobRunner::Process {
  std::size_t job = 0;
  std::size_t line = 0;
  pid_t id = 0;
};

void JobRunner::begin_line(const CommandJob& job, Process& process) const {
  const pid_t parent = ::getpid();
  const std::string commands = search_path();
  process.id = ::fork();
  if (process.id < 0) throw ComputationError(fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (process.id == 0) become(job.lines[process.line], path(job, ".log"), commands, parent);
}

std::vector<JobResult> JobRunner::run(const std::vector<CommandJob>& jobs) {
  std::vector<JobResult> results(jobs.size());
  std::vector<Process> running;
  std::size_t next = 0;
  const auto finish = [&](std::size_t number, bool succeeded) {
    const CommandJob& job = jobs[number];
    results[number] = {true, succeeded, text_of(path(job, ".log"))};
    if (!succeeded) return;
    ReplacedFile stamp(path(job, ".done"));
    stamp.write(joined(job.lines));
    stamp.finish();
  };
  while (next < jobs.size() || !running.empty()) {
    while (next < jobs.size() && static_cast<int>(running.size()) < workers_) {
      const std::size_t number = next++;
      const CommandJob& job = jobs[number];
      if (is_done(job, path(job, ".done"))) {
        results[number] = {true, true, text_of(path(job, ".log"))};
        continue;
      }
      if (is_over_()) continue;
      fs::remove(path(job, ".log"));
      fs::remove(path(job, ".done"));
      Process process{number};
      begin_line(job, process);
      running.push_back(process);
    }
    if (running.empty()) continue;
    int status = 0;
    const pid_t ended = ::waitpid(-1, &status, 0);
    if (ended < 0 && errno == EINTR) continue;
    const auto at = std::find_if(running.begin(), running.end(), [&](const Process& one) { return one.id == ended; });
    if (at == running.end()) continue;
    const CommandJob& job = jobs[at->job];
    const bool succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (succeeded && ++at->line < job.lines.size()) {
      begin_line(job, *at);
      continue;
    }
    finish(at->job, succeeded);
    running.erase(at);
  }
  return results;
}

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

namespace {

/// A word in a rule.
std::string in_rule(const std::string& word) {
  std::string text;
  for (const char c : word) {
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

std::string rule(const CommandJob& job) {
  std::string text;
  for (const std::string& file : job.outputs) text += file + " ";
  text += "&:";
  for (const std::string& file : job.inputs) text += " " + file;
  text += " | $(FOLDER)\n";
  for (const std::string& line : job.lines)
    text += "\t" + (line.starts_with("tchat ") ? "$(TCHAT)" + in_rule(line.substr(5)) : in_rule(line)) + "\n";
  return text + "\n";
}

/// The first files of the jobs that are joined by what they make and need: those of different trees share no file.
std::vector<std::string> trees(const std::vector<CommandJob>& jobs) {
  std::map<std::string, std::size_t> maker;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const std::string& output : jobs[i].outputs) maker[output] = i;
  std::vector<std::size_t> tree(jobs.size());
  std::iota(tree.begin(), tree.end(), std::size_t{0});
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const std::string& input : jobs[i].inputs)
      if (const auto made = maker.find(input); made != maker.end())
        std::replace(tree.begin(), tree.end(), std::size_t{tree[i]}, std::size_t{tree[made->second]});
  std::map<std::size_t, std::string> files;
  for (std::size_t i = 0; i < jobs.size(); ++i) files[tree[i]] += " " + jobs[i].outputs.front();
  std::vector<std::string> result;
  for (const auto& [number, list] : files) result.push_back(list);
  return result;
}

}  // namespace

std::string exploration_makefile(const std::vector<CommandJob>& jobs, const std::vector<CommandJob>& last,
                                 const std::string& folder) {
  const std::vector<std::string> parts = trees(jobs);
  std::string text =
      fmt::format("# Makes the files of {0} with make -f, also with -j.\nTCHAT = tchat\nFOLDER = {0}\n\n", folder);
  std::string branches, numbered, pictures;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    branches += fmt::format(" $(TREE{})", i + 1);
    numbered += fmt::format("TREE{} ={}\n", i + 1, parts[i]);
  }
  text +=
      fmt::format("# What has no file in common. Part PART of PARTS: make -f ... part PART=2 PARTS=8\n{}\n", numbered);
  for (const CommandJob& job : last) pictures += " " + job.outputs.front();
  text += fmt::format("all: branches{}\n\nbranches:{}\n\n", pictures, branches);
  text += fmt::format("PART = 1\nPARTS = 1\npart: $(foreach tree,$(shell seq $(PART) $(PARTS) {}),$(TREE$(tree)))\n\n",
                      parts.size());
  text += ".PHONY: all branches part\n\n$(FOLDER):\n\tmkdir -p $@\n\n";
  for (const CommandJob& job : jobs) text += rule(job);
  for (const CommandJob& job : last) text += rule(job);
  return text;
}

}  // namespace tchat
