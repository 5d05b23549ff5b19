#include "plot/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/messages.hpp"
#include "base/words.hpp"

namespace tchat {

namespace {

/// A file without a name, for what a child process reads or prints: no pipe that could fill up.
class UnnamedFile {
 public:
  UnnamedFile() : file_(std::tmpfile()) {
    if (file_ == nullptr)
      throw ComputationError(fmt::format("no temporary file can be made for gnuplot ({})", std::strerror(errno)));
  }
  ~UnnamedFile() { std::fclose(file_); }
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  int descriptor() const { return fileno(file_); }

  void write(const std::string& text) const {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() || std::fflush(file_) != 0)
      throw ComputationError(fmt::format("a temporary file for gnuplot cannot be written ({})", std::strerror(errno)));
    std::rewind(file_);
  }

  std::string contents() const {
    std::rewind(file_);
    std::string text;
    std::array<char, 4096> buffer;
    for (std::size_t count = 0; (count = std::fread(buffer.data(), 1, buffer.size(), file_)) > 0;)
      text.append(buffer.data(), count);
    return text;
  }

 private:
  std::FILE* file_;
};

struct Ending {
  int status = 0;
  std::string output;
};

[[noreturn]] void refuse_missing_gnuplot(int error) {
  throw UserError(
      fmt::format("pictures are drawn by the program gnuplot, which cannot be started ({}).\n"
                  "  Install it (Debian: apt install gnuplot-nox; with windows: gnuplot-qt or gnuplot-x11), or put its "
                  "folder on PATH.",
                  std::strerror(error)));
}

Ending run(const std::string& script, bool stay) {
  const UnnamedFile input;
  const UnnamedFile output;
  input.write(script);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output.descriptor(), STDERR_FILENO);
  // -d: neither the user's nor the system's initialisation file has a say in a picture.
  std::string program = "gnuplot", defaults = "-d", option = "--persist", from_input = "-";
  std::array<char*, 5> words = {program.data(), defaults.data(), stay ? option.data() : from_input.data(),
                                stay ? from_input.data() : nullptr, nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) refuse_missing_gnuplot(error);
  Ending ending;
  while (waitpid(child, &ending.status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == 127) refuse_missing_gnuplot(ENOENT);
  ending.output = output.contents();
  return ending;
}

}  // namespace

std::vector<std::string> gnuplot_terminals() {
  std::vector<std::string> terminals;
  const std::string output = gnuplot_output("print GPVAL_TERMINALS\n");
  for (const std::string_view word : split_words(output)) terminals.emplace_back(word);
  return terminals;
}

std::string gnuplot_output(const std::string& script) { return run(script, false).output; }

void run_gnuplot(const std::string& script, bool stay) {
  const Ending ending = run(script, stay);
  if (WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == 0) return;
  const std::string how = WIFSIGNALED(ending.status) ? fmt::format("was ended by signal {}", WTERMSIG(ending.status))
                                                     : fmt::format("failed with status {}", WEXITSTATUS(ending.status));
  throw ComputationError(fmt::format("gnuplot {}. It says:\n\n{}\n  --script FILE keeps the script for a closer look.",
                                     how, ending.output));
}

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* const value = std::getenv(name); value != nullptr && *value != '\0') return true;
  return false;
}

}  // namespace tchat
