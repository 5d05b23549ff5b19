#include "explore/command_job.hpp"

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
#include <optional>

#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "files/replaced_file.hpp"

namespace tchat {

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

}  // namespace tchat
