#include "benchmark/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void become(std::vector<char*>& arguments, const fs::path& folder, bool traced) {
  const int output = chdir(folder.c_str()) == 0 ? open("output", O_WRONLY | O_CREAT | O_TRUNC, 0644) : -1;
  if (output < 0) _exit(126);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  setenv("OMP_NUM_THREADS", "1", 1);
  if (traced) ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
  execvp(arguments.front(), arguments.data());
  _exit(127);
}

double peak_of(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  double kilobytes = 0.0;
  for (std::string key; status >> key && key != "VmHWM:";) std::getline(status, key);
  status >> kilobytes;
  return kilobytes / 1024.0;
}

/// Lets a traced child run to the end and looks at it just before.
double follow_to_end(pid_t child, int& status, rusage& usage) {
  double peak = 0.0;
  int signal = 0;
  bool begun = false;
  while (wait4(child, &status, 0, &usage) == child && WIFSTOPPED(status)) {
    signal = WSTOPSIG(status);
    if (!begun && signal == SIGTRAP) {
      ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACEEXIT);
      begun = true;
      signal = 0;
    } else if (status >> 8 == (SIGTRAP | (PTRACE_EVENT_EXIT << 8))) {
      peak = peak_of(child);
      signal = 0;
    }
    ptrace(PTRACE_CONT, child, nullptr, signal);
  }
  return peak;
}

}  // namespace

ChildTimes run_child(const std::vector<std::string>& command, const fs::path& folder, bool with_peak) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ChildTimes result;
  int status = 0;
  rusage usage{};
  result.wall = seconds([&] {
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process could be started");
    if (child == 0) become(arguments, folder, with_peak);
    if (with_peak)
      result.peak_mebibytes = follow_to_end(child, status, usage);
    else
      wait4(child, &status, 0, &usage);
  });
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("{} failed; what it wrote is in {}", command.front(), folder.string()));
  const auto in_seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  result.processor = in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
  return result;
}

ScratchFolder::ScratchFolder(const fs::path& parent) {
  std::string name = ((parent.empty() ? fs::temp_directory_path() : parent) / "tchat_benchmark_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder could be made: " + name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace tchat::benchmark
