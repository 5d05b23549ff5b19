#include "explore/command_jobs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/replaced_file.hpp"
#include "plugin/build_stamp.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

std::string text_of(const std::string& path) { return read_text_if_there(path, "output of a command").value_or(""); }

/// Of places and contents.
std::string hash_of(const std::vector<std::string>& files) {
  std::vector<BuildInput> inputs;
  for (const std::string& file : files) inputs.push_back({BuildInput::Root::elsewhere, file});
  return hash_files(inputs, {});
}

/// What a job does and reads, and the program that does it.
std::string work_text(const CommandJob& job) {
  static const std::string program = hash_of({"/proc/self/exe"});
  std::string text = "program " + program + '\n';
  for (const Command& command : job.commands) text += shell_line(command) + '\n';
  return text + "reads " + hash_of(job.inputs) + ' ' + hash_of(job.given) + '\n';
}

std::string made_text(const CommandJob& job) { return "made " + hash_of(job.outputs) + '\n'; }

/// In the child: it becomes the program itself with other arguments, and ends when this program does.
[[noreturn]] void become(const Command& command, const std::string& log, const std::string& failure, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::setenv("TCHAT_FAILURE", failure.c_str(), 1);
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const int none = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::dup2(none, STDIN_FILENO);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  std::string program = "tchat";
  Command words = command;
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv("/proc/self/exe", arguments.data());
  ::_exit(127);
}

int status_of(int ended) { return WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended); }

}  // namespace

struct JobRunner::Process {
  std::size_t job = 0;
  std::size_t call = 0;
  pid_t id = 0;
  std::string work;  ///< of its stamp, as it was when the job began
};

bool JobRunner::has_made(const CommandJob& job) const { return text_of(path(job, ".done")).ends_with(made_text(job)); }

bool JobRunner::is_done(const CommandJob& job) const {
  const std::string stamp = text_of(path(job, ".done"));
  return !stamp.empty() && stamp == work_text(job) + made_text(job) &&
         std::all_of(job.outputs.begin(), job.outputs.end(), [](const std::string& file) { return fs::exists(file); });
}

void JobRunner::begin_call(const CommandJob& job, Process& process) const {
  const pid_t parent = ::getpid();
  const Command& command = job.commands[process.call];
  process.id = ::fork();
  if (process.id < 0) throw ComputationError(fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (process.id == 0) become(command, path(job, ".log"), path(job, ".failure"), parent);
}

std::vector<JobResult> JobRunner::run(const std::vector<CommandJob>& jobs) {
  std::vector<JobResult> results(jobs.size());
  std::vector<Process> running;
  std::size_t next = 0;
  const auto finish = [&](const Process& process, int status) {
    const CommandJob& job = jobs[process.job];
    results[process.job] = {true, status, text_of(path(job, ".failure"))};
    fs::remove(path(job, ".failure"));
    if (status != 0 && results[process.job].failure.empty())
      results[process.job].failure = fmt::format("exit status {}; {} has its output", status, path(job, ".log"));
    if (status == 0) write_whole_file(path(job, ".done"), process.work + made_text(job));
  };
  while (next < jobs.size() || !running.empty()) {
    while (next < jobs.size() && static_cast<int>(running.size()) < workers_) {
      const std::size_t number = next++;
      const CommandJob& job = jobs[number];
      if (is_done(job)) {
        results[number].was_run = true;
        continue;
      }
      if (is_over_()) continue;
      for (const char* const ending : {".log", ".done", ".failure"}) fs::remove(path(job, ending));
      Process process{number, 0, 0, work_text(job)};
      begin_call(job, process);
      running.push_back(process);
    }
    if (running.empty()) continue;
    int ended = 0;
    const pid_t id = ::waitpid(-1, &ended, 0);
    if (id < 0 && errno == EINTR) continue;
    const auto at = std::find_if(running.begin(), running.end(), [&](const Process& one) { return one.id == id; });
    if (at == running.end()) continue;
    if (status_of(ended) == 0 && ++at->call < jobs[at->job].commands.size()) {
      begin_call(jobs[at->job], *at);
      continue;
    }
    finish(*at, status_of(ended));
    running.erase(at);
  }
  return results;
}

namespace {

/// In a recipe.
std::string in_recipe(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '$' ? std::string("$$") : std::string(1, c);
  return result;
}

/// In a list of files.
std::string in_list(const std::string& file) {
  std::string result;
  for (const char c : file) {
    if (std::string_view(" #:%\\").find(c) != std::string_view::npos) result += '\\';
    result += c == '$' ? std::string("$$") : std::string(1, c);
  }
  return result;
}

std::string rule(const CommandJob& job) {
  std::string text;
  for (const std::string& file : job.outputs) text += in_list(file) + " ";
  text += "&:";
  for (const auto* const files : {&job.inputs, &job.given})
    for (const std::string& file : *files) text += " " + in_list(file);
  text += " | $(FOLDER)\n";
  for (const Command& command : job.commands) text += "\t$(TCHAT)" + in_recipe(shell_words(command)) + "\n";
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
  for (std::size_t i = 0; i < jobs.size(); ++i) files[tree[i]] += " " + in_list(jobs[i].outputs.front());
  std::vector<std::string> result;
  for (const auto& [number, list] : files) result.push_back(list);
  return result;
}

}  // namespace

std::string makefile_text(const std::vector<CommandJob>& jobs, const std::vector<CommandJob>& last,
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
  for (const CommandJob& job : last) pictures += " " + in_list(job.outputs.front());
  text += fmt::format("all: branches{}\n\nbranches:{}\n\n", pictures, branches);
  text += fmt::format("PART = 1\nPARTS = 1\npart: $(foreach tree,$(shell seq $(PART) $(PARTS) {}),$(TREE$(tree)))\n\n",
                      parts.size());
  text += ".PHONY: all branches part\n\n$(FOLDER):\n\tmkdir -p $@\n\n";
  for (const CommandJob& job : jobs) text += rule(job);
  for (const CommandJob& job : last) text += rule(job);
  return text;
}

}  // namespace tchat
