// Plugins that end the process, never return or throw in the middle of a run; standard streams that are closed.
#include <signal.h>
#include <stdlib.h>

#include <catch2/catch.hpp>
#include <thread>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// x' = 1 until x = p, then x -> 0: the orbit x = t, T = p. Its user function misbehaves at the fourth point, in the
/// way that the environment says; files tell how far it is.
const char* const source = R"(#include <tchat/problem.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void mark(const char* name) { fclose(fopen(name, "w")); }
static void misbehave(const char* how) {
  if (strcmp(how, "segfault") == 0) *(volatile char*)8 = 1;
  if (strcmp(how, "_exit") == 0) _exit(0);
  if (strcmp(how, "throw") == 0) throw 1;
  if (strcmp(how, "loop") == 0) {
    // A signal between the mark and the wait would be waited for in vain: it is held back until the wait takes it.
    sigset_t held, none;
    sigemptyset(&none);
    sigfillset(&held);
    sigprocmask(SIG_SETMASK, &held, nullptr);
    mark("looping");
    sigsuspend(&none);
    mark("signalled");
    sigprocmask(SIG_SETMASK, &none, nullptr);
    while (true) pause();
  }
}
static void value(const void*, int32_t kind, int32_t, const double* x, const double* par, double* out) {
  out[0] = kind == TCHAT_FIELD ? 1.0 : kind == TCHAT_EVENT ? par[0] - x[0] : 0.0;
}
static void user_value(const void*, const double*, const double* par, double* out) {
  static int calls = 0;
  if (++calls == 4 && getenv("MISBEHAVE")) misbehave(getenv("MISBEHAVE"));
  out[0] = 2.0 * par[0];
}
static tchat_problem table;
extern "C" __attribute__((visibility("default"))) const tchat_problem* tchat_problem_table(void) {
  table.abi_version = TCHAT_PROBLEM_ABI;
  table.struct_size = sizeof(tchat_problem);
  table.dimension = table.parameters = table.fields = table.events = table.jumps = table.user_values = 1;
  table.name = "ramp";
  table.value = value;
  table.user_value = user_value;
  return &table;
}
)";

class RampWorkspace : public Workspace {
 public:
  RampWorkspace() {
    write("ramp.cpp", source);
    write("ramp.dat", "# PAR(1) = 1\n# PAR(61) = 1\n0 0\n1 1\n");
    write("gc.ramp", "NDIM = 1\nICP = [1]\nNTST = 5\nNMX = 10\nNPR = 1\nDS = 0.1\n");
  }
  ~RampWorkspace() { unsetenv("MISBEHAVE"); }
  RampWorkspace(const RampWorkspace&) = delete;
  RampWorkspace& operator=(const RampWorkspace&) = delete;

  std::unique_ptr<Process> start(const char* how) const {
    setenv("MISBEHAVE", how, 1);
    return start_tchat("run ramp");
  }

  /// The three points before the fourth are in both files, whole.
  void check_files() const {
    const auto sections = points("ramp");
    REQUIRE(sections.size() == 1);
    CHECK(sections.front().rows.size() == 3);
    CHECK(labels_of(sections) == std::vector<int>{1, 2, 3});
    CHECK(labels_of(solutions("ramp")) == std::vector<int>{1, 2, 3});
    CHECK(read("d.ramp").find("end of run") == std::string::npos);
  }
};

void wait_for_file(const Workspace& workspace, Process& process, const char* name) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!workspace.has(name)) {
    REQUIRE_FALSE(process.ended());
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

constexpr std::chrono::seconds long_enough{60};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a plugin that dies in the middle of a run is named, status 2, files are whole up to the last point") {
  for (const char* how : {"segfault", "_exit"}) {
    const RampWorkspace workspace;
    const Outcome outcome = workspace.start(how)->wait(long_enough);
    INFO(how << "\n" << outcome.text());
    CHECK(outcome.signal == 0);
    CHECK(outcome.status == 2);
    CHECK(contains(outcome.err, "tchat: the plugin ./ramp.so "));
    CHECK(contains(outcome.err, "in the user functions"));
    workspace.check_files();
  }
}

TEST_CASE("a plugin that dies between two labels: the points before are in the files") {
  setenv("MISBEHAVE", "segfault", 1);
  const RampWorkspace workspace;
  CHECK(workspace.tchat("run ramp NPR=0").status == 2);
  CHECK(workspace.points("ramp").front().rows.size() == 3);
  CHECK(labels_of(workspace.solutions("ramp")) == std::vector<int>{1});
}

TEST_CASE("a user function that throws: the branch is computed, and what is missing is told") {
  const RampWorkspace workspace;
  const Outcome outcome = workspace.start("throw")->wait(long_enough);
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "User function PVLS(1) has no finite value here"));
  CHECK(contains(outcome.err, "an exception of user_value"));
  const std::string diagnostics = workspace.read("d.ramp");
  CHECK(contains(diagnostics, "User function PVLS(1) has no finite value here"));
  const auto rows = workspace.points("ramp").front().rows;
  REQUIRE(rows.size() == 10);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double parameter = rows[k].values.front();
    const double user = rows[k].values[3];
    CHECK(user == Approx(k == 3 ? 1e99 : 2.0 * parameter));
  }
}

TEST_CASE("a plugin that never returns: the second signal ends the run at once") {
  struct Stop {
    int signal, status;
  };
  for (const Stop& stop : {Stop{SIGINT, 130}, Stop{SIGTERM, 143}}) {
    const RampWorkspace workspace;
    const auto process = workspace.start("loop");
    wait_for_file(workspace, *process, "looping");
    process->send(stop.signal);
    wait_for_file(workspace, *process, "signalled");
    process->send(stop.signal);
    const Outcome outcome = process->wait(long_enough);
    INFO(outcome.text());
    CHECK(outcome.signal == 0);
    CHECK(outcome.status == stop.status);
    CHECK(contains(outcome.err, "ended at once, by a second signal"));
    workspace.check_files();
  }
}

TEST_CASE("a plugin that never returns: some seconds after a signal the run is ended") {
  const RampWorkspace workspace;
  const auto process = workspace.start("loop");
  wait_for_file(workspace, *process, "looping");
  process->send(SIGINT);
  const Outcome outcome = process->wait(long_enough);
  INFO(outcome.text());
  CHECK(outcome.signal == 0);
  CHECK(outcome.status == 130);
  CHECK(contains(outcome.err, "would not end"));
  workspace.check_files();
}

TEST_CASE("standard streams that are closed: what is printed goes into no file") {
  const RampWorkspace workspace;
  const std::string plain = workspace.tchat("run ramp -o plain").err;
  CHECK(plain.empty());
  int number = 0;
  for (const char* closed : {">&-", "<&- >&-", "<&- >&- 2>&-"}) {
    const std::string name = "closed" + std::to_string(++number);
    const Outcome outcome = workspace.tchat_redirected("run ramp -o " + name, closed);
    INFO(closed << "\n" << outcome.text());
    CHECK(outcome.signal == 0);
    for (const char* letter : {"p.", "q.", "d."})
      CHECK(workspace.read(letter + name) == workspace.read(letter + std::string("plain")));
  }
}
