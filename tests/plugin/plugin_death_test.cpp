// A plugin that ends the process, in any way that can be seen from inside: it is named, with where it was, status 2.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <cstdlib>

#include "fortran_sources.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/problem_library.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

extern "C" void __asan_init() __attribute__((weak));

namespace {

struct Ended {
  int status = -1;
  int signal = 0;
  std::string error_output;
};

/// Runs `action` in a process of its own, without Catch's handlers, that then ends with status 0.
template <class Action>
Ended in_process(const PluginFolder& folder, const Action& action) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGSEGV, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT}) std::signal(signal, SIG_DFL);
    const int file = open((folder / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, STDERR_FILENO) < 0) _exit(99);
    action();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  Ended ended;
  if (WIFEXITED(status)) ended.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
  ended.error_output = folder.read("stderr");
  return ended;
}

/// Dies in the way, and at the place, that the environment says.
const char* const dying_source = R"(#include <tchat/problem.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <exception>
#include <stdexcept>

static volatile int zero = 0;
static volatile char* volatile nowhere = nullptr;

static __attribute__((noinline)) double recursion(volatile double* above) {
  volatile double local[512];
  local[0] = above == nullptr ? 1.0 : above[0];
  return recursion(local) + local[0];
}
static void promises() noexcept { throw std::runtime_error("broken promise"); }

struct How {
  const char* text;
  bool operator==(const char* other) const { return strcmp(text, other) == 0; }
};
template <class Action>
static void in_thread(Action action) {
  pthread_t thread;
  pthread_create(&thread, nullptr, +action, nullptr);
  pthread_join(thread, nullptr);
}
static void free_middle() {
  alignas(16) char local[64] = {};  // where the allocator looks for a chunk's size it finds 0, which it refuses
  char* volatile middle = local + 16;
  free(middle);
}

static void die(How how) {
  if (how == "segfault") *nowhere = 1;
  if (how == "wild pointer") *reinterpret_cast<volatile char*>(uintptr_t(0xdeadbeef0000beefull)) = 1;
  if (how == "strlen of nothing") zero = int(strlen(const_cast<const char*>(nowhere)));
  if (how == "recursion") zero = int(recursion(nullptr));
  if (how == "division") zero = 7 / zero;
  if (how == "abort") abort();
  if (how == "trap") __builtin_trap();
  if (how == "bad free") free_middle();
  if (how == "noexcept") promises();
  if (how == "terminate") std::terminate();
  if (how == "raise") raise(SIGUSR1);
  if (how == "alarm") alarm(1), pause();
  if (how == "exit") exit(0);
  if (how == "quick_exit") quick_exit(0);
  if (how == "_exit") _exit(0);
  if (how == "_Exit") _Exit(0);
  if (how == "pthread_exit") pthread_exit(nullptr);
  if (how == "thread throws") in_thread([](void*) -> void* { throw std::runtime_error("in a thread"); });
  if (how == "thread segfaults") in_thread([](void*) -> void* { return *nowhere = 1, nullptr; });
  if (how == "thread exits") in_thread([](void*) -> void* { exit(0); });
  if (how == "throw") throw std::runtime_error("thrown");
}
static void die_at(const char* place) {
  const char* const wanted = getenv("DIE_AT");
  if (wanted != nullptr && strcmp(wanted, place) == 0) die({getenv("DIE_BY")});
}

static struct AtLoading {
  AtLoading() { die_at("loading"); }
  ~AtLoading() { die_at("unloading"); }
} at_loading;

static void value(const void*, int32_t kind, int32_t, const double* x, const double* par, double* out) {
  if (kind == TCHAT_EVENT) die_at("event");
  out[0] = par[0] * x[0];
}
static void user_value(const void*, const double*, const double*, double* out) {
  die_at("user value");
  out[0] = 1.0;
}
static tchat_problem table;
extern "C" __attribute__((visibility("default"))) const tchat_problem* tchat_problem_table(void) {
  die_at("entry");
  table.abi_version = TCHAT_PROBLEM_ABI;
  table.struct_size = sizeof(tchat_problem);
  table.dimension = table.parameters = 1;
  table.fields = table.events = table.jumps = 2;
  table.user_values = 1;
  table.name = "dying";
  table.value = value;
  table.user_value = user_value;
  return &table;
}
)";

void choose(const char* place, const char* how) {
  setenv("DIE_AT", place, 1);
  setenv("DIE_BY", how, 1);
}

void use(const std::string& path) {
  const ProblemLibrary library(path);
  const double x[] = {0.5}, par[TCHAT_PAR_LENGTH] = {};
  double out[1];
  library.system().event(2, x, par);
  library.system().table().user_value(library.system().table().self, x, par, out);
}

struct Way {
  const char* how;
  const char* told;
};

}  // namespace

TEST_CASE("a plugin dies: it is named, with where it was, status 2") {
  const PluginFolder folder;
  const std::string library =
      resolve_plugin(folder.write("dying.cpp", dying_source), {"c++ -pthread", TCHAT_TEST_INCLUDE});
  REQUIRE(in_process(folder, [&] { use(library); }).status == 0);

  for (const Way& way : {Way{"segfault", "SIGSEGV"},
                         {"wild pointer", "SIGSEGV"},
                         {"strlen of nothing", "SIGSEGV"},
                         {"recursion", "stack is full"},
                         {"division", "divided by zero"},
                         {"abort", "SIGABRT"},
                         {"trap", "SIGILL"},
                         {"bad free", "SIGABRT"},
                         {"noexcept", "broken promise"},
                         {"terminate", "SIGABRT"},
                         {"raise", "SIGUSR1"},
                         {"alarm", "SIGALRM"},
                         {"exit", "by exit"},
                         {"quick_exit", "by exit"},
                         {"_exit", "by _exit"},
                         {"_Exit", "by _exit"},
                         {"pthread_exit", "SIGABRT"},
                         {"thread throws", "in a thread of its own"},
                         {"thread segfaults", "in a thread of its own"},
                         {"thread exits", "in a thread of its own"}}) {
    if (__asan_init != nullptr && way.how == std::string("bad free")) continue;  // ASan ends it, with its own report
    const Ended ended = in_process(folder, [&] {
      choose("event", way.how);
      use(library);
    });
    INFO(way.how << " ended with status " << ended.status << ", signal " << ended.signal << "\n" << ended.error_output);
    CHECK(ended.status == 2);
    CHECK_THAT(ended.error_output, Contains("tchat: the plugin " + library) && Contains(way.told));
    if (std::string(way.told) != "in a thread of its own")
      CHECK_THAT(ended.error_output, Contains("in event function 2"));
  }
}

TEST_CASE("a plugin dies while it is loaded, asked for its table or unloaded") {
  const PluginFolder folder;
  const std::string library =
      resolve_plugin(folder.write("dying.cpp", dying_source), {"c++ -pthread", TCHAT_TEST_INCLUDE});
  for (const Way& place : {Way{"loading", "while it was loaded"},
                           {"entry", "in the problem class's constructor"},
                           {"unloading", "while it was unloaded"}})
    for (const char* how : {"segfault", "throw", "abort", "recursion", "exit", "_exit"}) {
      const bool refused = std::string(place.how) == "entry" && std::string(how) == "throw";
      if (refused) continue;  // an exception that can be caught is
      const Ended ended = in_process(folder, [&] {
        choose(place.how, how);
        use(library);
      });
      INFO(how << " ended with status " << ended.status << ", signal " << ended.signal << "\n" << ended.error_output);
      CHECK(ended.status == 2);
      CHECK_THAT(ended.error_output, Contains("tchat: the plugin " + library) && Contains(place.told));
    }
}

TEST_CASE("exceptions of a plugin's functions are NaN, those of user functions are kept") {
  const PluginFolder folder;
  const std::string path =
      resolve_plugin(folder.write("dying.cpp", dying_source), {"c++ -pthread", TCHAT_TEST_INCLUDE});
  const ProblemLibrary library(path);
  const double x[] = {0.5}, par[TCHAT_PAR_LENGTH] = {};
  double out[1] = {0.0};
  choose("event", "throw");
  CHECK(std::isnan(library.system().event(1, x, par)));
  CHECK(library.complaint().empty());
  choose("user value", "throw");
  library.system().table().user_value(library.system().table().self, x, par, out);
  unsetenv("DIE_AT");
  CHECK(std::isnan(out[0]));
  CHECK_THAT(library.complaint(), Contains(path) && Contains("user_value: thrown"));
}

TEST_CASE("what is not the plugin's doing is not laid at its door") {
  const PluginFolder folder;
  const std::string library =
      resolve_plugin(folder.write("dying.cpp", dying_source), {"c++ -pthread", TCHAT_TEST_INCLUDE});
  const Ended own = in_process(folder, [&] {
    const ProblemLibrary loaded(library);
    abort();
  });
  CHECK(own.signal == SIGABRT);
  CHECK_THAT(own.error_output, Contains("internal error") && Contains("outside"));
  const Ended sent = in_process(folder, [&] {
    const ProblemLibrary loaded(library);
    const pid_t self = getpid();
    if (fork() == 0) kill(self, SIGUSR1), _exit(0);
    pause();
  });
  CHECK(sent.signal == SIGUSR1);
  CHECK(sent.error_output.empty());
  const Ended left = in_process(folder, [&] {
    { const ProblemLibrary loaded(library); }
    _exit(7);
  });
  CHECK(left.status == 7);
  const Ended forked = in_process(folder, [&] {
    const ProblemLibrary loaded(library);
    const PluginCall call("someone", "somewhere");
    if (fork() == 0) _exit(5);  // a plugin's own child
    int status = 0;
    wait(&status);
    leave_process(WEXITSTATUS(status));
  });
  CHECK(forked.status == 5);
}

TEST_CASE("a Fortran plugin dies: it is named, with where it was, status 2") {
  const PluginFolder folder;
  const std::string source = spoilt("      IF (SEGNO.EQ.1) THEN\n        H=X(1)-PAR(1)\n",
                                    "      CHARACTER*20 HOW\n"
                                    "      CHARACTER*4 WORD\n"
                                    "      CALL GET_ENVIRONMENT_VARIABLE('DIE_BY',HOW)\n"
                                    "      IF (HOW.EQ.'stop') STOP\n"
                                    "      IF (HOW.EQ.'stop 0') STOP 0\n"
                                    "      IF (HOW.EQ.'stop 3') STOP 3\n"
                                    "      IF (HOW.EQ.'error stop') ERROR STOP 'here'\n"
                                    "      IF (HOW.EQ.'abort') CALL ABORT\n"
                                    "      IF (HOW.EQ.'exit') CALL EXIT(0)\n"
                                    "      IF (HOW.EQ.'division') H=7/(SEGNO-1)\n"
                                    "      IF (HOW.EQ.'bounds') H=X(SEGNO+7)\n"
                                    "      WORD='none'\n"
                                    "      IF (HOW.EQ.'number') READ(WORD,*) H\n"
                                    "      IF (HOW.EQ.'end of file') READ(99,*) H\n"
                                    "      IF (SEGNO.EQ.1) THEN\n"
                                    "        H=X(1)-PAR(1)\n");
  const std::string library =
      resolve_plugin(folder.write("dying.f", source), {"", TCHAT_TEST_INCLUDE, "gfortran -fcheck=bounds"});
  for (const Way& way : {Way{"nothing", ""},
                         {"stop", "STOP in Fortran"},
                         {"stop 0", "STOP in Fortran"},
                         {"stop 3", "STOP in Fortran"},
                         {"error stop", "STOP in Fortran"},
                         {"abort", "SIGABRT"},
                         {"exit", "by exit"},
                         {"division", "divided by zero"},
                         {"bounds", "by exit"},
                         {"number", "by exit"},
                         {"end of file", "by exit"}}) {
    const Ended ended = in_process(folder, [&] {
      choose("anywhere", way.how);
      const ProblemLibrary loaded(library, [] { return fortran_sizes(1); });
    });
    INFO(way.how << " ended with status " << ended.status << ", signal " << ended.signal << "\n" << ended.error_output);
    const bool dies = way.told[0] != '\0';
    CHECK(ended.status == (dies ? 2 : 0));
    if (dies) CHECK_THAT(ended.error_output, Contains("tchat: the plugin " + library) && Contains(way.told));
  }
}

TEST_CASE("an exit while no guard lives is left alone, guards nest") {
  const PluginFolder folder;
  const Ended free = in_process(folder, [] {
    { const ExitGuard guard("plugin.so"); }
    std::quick_exit(5);
  });
  CHECK(free.status == 5);
  CHECK(free.error_output.empty());
  const Ended nested = in_process(folder, [] {
    const ExitGuard outer("outer.so");
    { const ExitGuard inner("inner.so"); }
    std::quick_exit(5);
  });
  CHECK(nested.status == 2);
  CHECK_THAT(nested.error_output, Contains("outer.so"));
}
