#include "app/command_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/TypeTools.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <exception>
#include <iostream>
#include <limits>

#include "plugin/exit_guard.hpp"
#include "plugin/plugin_build.hpp"

namespace tchat {

namespace {

constexpr int shortest_patience = 5;  // seconds
constexpr double longest_patience = 3600.0;

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t caught_signal = 0;
volatile std::sig_atomic_t patience = shortest_patience;

[[noreturn]] void leave_at_once(const char* why) {
  SignalText text;
  text << "tchat: ended at once, " << why << "; the files hold what was complete before.\n";
  text.print_to_standard_error();
  leave_process(128 + static_cast<int>(caught_signal));
}

void install(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART | SA_ONSTACK;
  ::sigaction(signal, &action, nullptr);
}

void end_of_patience(int) { leave_at_once("the work at hand would not end"); }

void on_signal(int signal) {
  const bool second = caught_signal != 0;
  caught_signal = signal;
  if (second) leave_at_once("by a second signal");
  install(SIGALRM, &end_of_patience);
  ::alarm(static_cast<unsigned>(patience));
}

/// Has a signal come? Learns on the way how long the work goes between two questions.
class Question {
 public:
  bool operator()() {
    const Clock::time_point now = Clock::now();
    const double seconds = last_ ? 3.0 * std::chrono::duration<double>(now - *last_).count() : 0.0;
    last_ = now;
    if (seconds > static_cast<double>(patience))
      patience = static_cast<int>(std::ceil(std::min(seconds, longest_patience)));
    return caught_signal != 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> last_;
};

}  // namespace

int run_interruptibly(const std::function<int(const std::function<bool()>&)>& work) {
  install(SIGINT, &on_signal);
  install(SIGTERM, &on_signal);
  int status = 0;
  try {
    status = work(Question());
  } catch (const std::exception& error) {
    if (caught_signal == 0) throw;
    // The failure may be the signal's doing, such as that of a compiler that it ended too.
    std::cerr << "tchat: interrupted: " << error.what() << '\n';
  }
  if (caught_signal == 0) return status;
  return 128 + static_cast<int>(caught_signal);
}

void take_source_as_problem(std::string& name, std::optional<std::string>& plugin) {
  const NamedProblem named = named_problem(name);
  name = named.name;
  if (!plugin) plugin = named.plugin;
}

/// Refuses what is no finite number with these bounds, and says what is `allowed`.
CLI::Validator number_within(double least, double most, const std::string& allowed) {
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        double value = 0.0;
        const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        if (is_number && value >= least && value <= most) return "";
        return fmt::format("found '{}'; allowed: {}", text, allowed);
      },
      "");
}

CLI::Validator whole_number(long least, long most) {
  const std::string allowed = fmt::format("a whole number from {} to {}", least, most);
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        long value = 0;
        const bool is_allowed = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
        return is_allowed ? "" : fmt::format("found '{}'; allowed: {}", text, allowed);
      },
      "");
}

CLI::Validator positive_time() {
  return number_within(std::numeric_limits<double>::min(), 1e300, "a finite number > 0");
}

void add_problem_options(CLI::App& command, SimulationRequest& request) {
  command.add_option("NAME", request.name, "problem NAME.cpp or NAME.tch; reads gc.NAME if it exists")->required();
  command.add_option("-c,--constants", request.constants, "signature, monitored events and other constants from gc.C")
      ->type_name("C");
  command.add_option("-p,--problem", request.problem, "problem P.cpp, P.tch, P.f or P.so")->type_name("P");
}

void add_exponent_count(CLI::App& command, std::string& text, const std::string& help, const char* group) {
  command.add_option("--lyapunov", text, help)
      ->expected(0, 1)
      ->type_name("[K]")
      ->check([count = whole_number(1, 1000)](const std::string& given) {
        return given.find('=') != std::string::npos ? std::string() : count(given);
      })
      ->group(group);
}

std::optional<int> exponent_count(const CLI::App& command, const std::string& text,
                                  std::vector<std::string>& overrides) {
  if (command.count("--lyapunov") == 0) return std::nullopt;
  if (text.find('=') == std::string::npos) return text.empty() ? 0 : std::stoi(text);
  overrides.push_back(text);
  return 0;
}

namespace {

CLI::Option* add_side_option(CLI::App& command, SimulationRequest& request, const char* name, StartSide::Given side,
                             const char* help, const char* group) {
  return command
      .add_flag_callback(
          name, [&request, side] { request.side.given = side; }, help)
      ->group(group);
}

}  // namespace

void add_start_options(CLI::App& command, SimulationRequest& request) {
  const char* const group = "Start";
  command.add_option("-d,--data", request.data, "start from the first row of D.dat, with its parameters")
      ->type_name("D")
      ->group(group);
  command.add_option("-s,--start", request.start, "start from the label IRS of q.S, with its parameters")
      ->type_name("S")
      ->group(group);
  CLI::Option* const after =
      add_side_option(command, request, "--after-event", StartSide::Given::after,
                      "a start on an event surface is after the event [as its jump suggests]", group);
  add_side_option(command, request, "--before-event", StartSide::Given::before,
                  "a start on an event surface is before the event", group)
      ->excludes(after);
  command
      .add_option("--mode", request.modes,
                  "index vectors watched first, as 1,2,1 or '1,2,1;1,3,2' [the problem's, else the first of gc.C]")
      ->group(group);
  command.add_option("--signature", request.signature, "follow these index vectors in turn, as '1,1,1;2,2,2'")
      ->group(group);
  command
      .add_flag("--follow-signature", request.follow_signature,
                "follow the signature of gc.C, even if the problem has an index jump function")
      ->group(group);
}

void add_length_options(CLI::App& command, SimulationRequest& request, const char* group) {
  SimulationPlan& plan = request.plan;
  command.add_option("--time", plan.time, "time to simulate after the transient")
      ->type_name("T")
      ->check(positive_time())
      ->group(group);
  command.add_option("--events", plan.events, "number of events after the transient")
      ->type_name("N")
      ->check(whole_number(1, 1000000000))
      ->group(group);
  command.add_option("--transient-time", plan.transient_time, "discard what starts before this time")
      ->type_name("T")
      ->check(number_within(0.0, 1e300, "a finite number >= 0"))
      ->group(group);
  command.add_option("--transient-events", plan.transient_events, "number of segments to discard first")
      ->type_name("N")
      ->check(whole_number(0, 1000000000))
      ->group(group);
  command
      .add_option("--wait", request.wait,
                  fmt::format("stop after this time without an event; if not given, also after {} steps",
                              request.steps_without_event))
      ->type_name("T")
      ->each([&request](const std::string&) { request.steps_without_event = no_limit; })
      ->check(positive_time())
      ->capture_default_str()
      ->group(group);
}

void add_detail_options(CLI::App& command, SimulationRequest& request) {
  const char* const group = "Details";
  command.add_option("--tolerance", request.tolerance, "relative error of an integration step")
      ->type_name("E")
      ->check(number_within(1e-15, 1e-2, "a number from 1e-15 to 0.01"))
      ->capture_default_str()
      ->group(group);
  command.add_flag("--stiff", request.stiff, "backward differentiation formulas, for stiff problems")->group(group);
  command.add_option("--max-period", request.plan.max_period, "longest periodic orbit, in events")
      ->type_name("N")
      ->check(whole_number(1, 10000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--recognition", request.plan.recognition,
                  "difference of equal states, relative to the orbit's range")
      ->type_name("E")
      ->check(number_within(1e-12, 1e-1, "a number from 1e-12 to 0.1"))
      ->capture_default_str()
      ->group(group);
}

}  // namespace tchat
