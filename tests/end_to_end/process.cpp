#include "end_to_end/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace test_support {

namespace {

constexpr int cannot_start = 127;

std::string contents(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void redirect(const std::string& path, int flags, int descriptor) {
  const int file = ::open(path.c_str(), flags, 0600);
  if (file < 0 || ::dup2(file, descriptor) < 0) ::_exit(cannot_start);
}

}  // namespace

bool all_tests() { return std::getenv("TCHAT_ALL_TESTS") != nullptr; }

Process::Process(const std::vector<std::string>& words, const std::string& folder, const std::string& log) : log_(log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  child_ = ::fork();
  if (child_ < 0) throw std::runtime_error("no further process can be made");
  if (child_ > 0) return;
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(log + ".out", O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  redirect(log + ".err", O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  if (::chdir(folder.c_str()) == 0) ::execv(arguments[0], arguments.data());
  ::_exit(cannot_start);
}

Process::~Process() {
  if (ended()) return;
  send(SIGKILL);
  ::waitpid(child_, &raw_status_, 0);
}

void Process::send(int signal) const {
  if (child_ > 0) ::kill(child_, signal);
}

bool Process::ended() {
  if (child_ > 0 && ::waitpid(child_, &raw_status_, WNOHANG) == child_) child_ = 0;
  return child_ == 0;
}

Outcome Process::wait(std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  Outcome outcome;
  while (!ended()) {
    if (std::chrono::steady_clock::now() > deadline) {
      outcome.timed_out = true;
      send(SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (WIFEXITED(raw_status_)) outcome.status = WEXITSTATUS(raw_status_);
  if (WIFSIGNALED(raw_status_)) outcome.signal = WTERMSIG(raw_status_);
  outcome.out = contents(log_ + ".out");
  outcome.err = contents(log_ + ".err");
  return outcome;
}

}  // namespace test_support
