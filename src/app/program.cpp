#include "app/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <new>
#include <string_view>

#include "app/commands.hpp"
#include "app/compiled_texts.hpp"
#include "app/help.hpp"
#include "app/plot_command.hpp"
#include "app/problem_commands.hpp"
#include "base/messages.hpp"

namespace tchat {

void occupy_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    const int wrong_way = descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    // The lowest free number is taken, and all below this one are in use.
    if (::open("/dev/null", wrong_way) != descriptor) return;  // without /dev/null there is nothing to put there
  }
}

std::string lost_output() {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::cout && std::ferror(stdout) == 0) return "";
  // An earlier write may have failed: its reason is gone then.
  const std::string reason = errno != 0 ? fmt::format(" ({})", std::strerror(errno)) : "";
  return fmt::format(
      "standard output cannot be written{}: what was printed is lost, wholly or in part; is the disk full, "
      "or is it closed?",
      reason);
}

namespace {

constexpr int computation_failed = 1;
constexpr int bad_input = 2;

int report(const std::string& message, int status) {
  std::cout << std::flush;
  print_failure(std::cerr, message);
  return status;
}

int run_command(const std::function<int()>& command) {
  try {
    return command();
  } catch (const UserError& error) {
    return report(error.what(), bad_input);
  } catch (const NothingBegins& error) {
    return report(error.what(), nothing_begins_status);
  } catch (const ComputationError& error) {
    return report(error.what(), computation_failed);
  } catch (const std::bad_alloc&) {
    return report(
        "out of memory; end other programs, raise the limit (ulimit -v), or use a smaller NTST, NCOL or number of "
        "segments",
        computation_failed);
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return computation_failed;  // printing failed, and main says so
    return report(fmt::format("internal error: {}", error.what()), computation_failed);
  }
}

using AddCommand = void (*)(CLI::App&, std::function<int()>&);

struct Subcommand {
  std::string_view name;
  AddCommand add;
};

/// In the order of the help.
constexpr std::array<Subcommand, 15> commands = {{{"run", add_run_command},
                                                  {"resegment", add_resegment_command},
                                                  {"simulate", add_simulate_command},
                                                  {"sweep", add_sweep_command},
                                                  {"explore", add_explore_command},
                                                  {"labels", add_labels_command},
                                                  {"orbit", add_orbit_command},
                                                  {"table", add_table_command},
                                                  {"verify", add_verify_command},
                                                  {"grazing", add_grazing_command},
                                                  {"plot", add_plot_command},
                                                  {"check", add_check_command},
                                                  {"dat", add_dat_command},
                                                  {"constants", add_constants_command},
                                                  {"new", add_new_command}}};

/// Adds the command that was asked for alone, as setting up the options of all takes longer than many commands run.
/// When none was, adds all of them and the manual page.
void add_commands(CLI::App& app, std::function<int()>& chosen, std::string_view asked) {
  for (const Subcommand& command : commands)
    if (command.name == asked) return command.add(app, chosen);
  for (const Subcommand& command : commands) command.add(app, chosen);
  add_manual_command(app, chosen);
}

int parse_and_run(int argc, char** argv) {
  occupy_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then an error of the write, reported like a full disk
  CLI::App app{"tchat: numerical continuation of periodic orbits of hybrid dynamical systems", "tchat"};
  set_help_format(app);
  app.set_version_flag("--version", version_text(), "show version, commit and libraries");
  app.require_subcommand(1);
  app.footer("tchat COMMAND --help explains a command.");
  std::function<int()> chosen;
  add_commands(app, chosen, argc > 1 ? argv[1] : "");
  if (argc > 1 && std::string_view(argv[1]) == "complete")
    return run_command([&] { return print_completions(app, {argv + 2, argv + argc}); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error, std::cout, std::cerr);  // --help, --version
    return report(usage_error(app, error), bad_input);
  }
  return run_command(chosen);
}

}  // namespace

int run_program(int argc, char** argv) {
  try {
    const int status = parse_and_run(argc, argv);
    const std::string lost = lost_output();
    if (lost.empty()) return status;
    std::cerr << "tchat: " << lost << '\n';
    return status == 0 ? computation_failed : status;
  } catch (const std::bad_alloc&) {
    std::fputs("tchat: out of memory before the command began; end other programs, or raise the limit (ulimit -v)\n",
               stderr);
    return computation_failed;
  } catch (...) {
    std::fputs("tchat: internal error before the command began\n", stderr);
    return computation_failed;
  }
}

}  // namespace tchat
