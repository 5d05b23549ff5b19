// What `cmake --install` puts in place is enough: a problem from `tchat new`, the Fortran example with TC-HAT's
// commands, a plugin and a program that computes, built by other projects
// through find_package(tchat).
#include <catch2/catch.hpp>
#include <filesystem>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

class Installation {
 public:
  Installation() {
    shell("'" CMAKE_PROGRAM "' --install '" BUILD_FOLDER "' --prefix \"$PWD/first\" && mv first prefix");
  }

  /// Commands with the installed program first in PATH and none of this build's; they must succeed.
  Outcome shell(const std::string& commands) const {
    const std::string script = "set -e\nPATH=\"" + workspace_.file("prefix/bin") + ":$PATH\"\nunset TCHAT\n" + commands;
    Outcome outcome =
        Process({"/bin/sh", "-c", script}, workspace_.file(""), logs_.file("shell")).wait(std::chrono::seconds(240));
    INFO(commands << '\n' << outcome.text());
    REQUIRE(outcome.status == 0);
    return outcome;
  }
  const Workspace& workspace() const { return workspace_; }

 private:
  Workspace workspace_;
  TemporaryFolder logs_;
};

const char* const ball = R"(#include <tchat/problem.hpp>
struct Ball {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  static constexpr double initial_parameters[] = {9.81, 0.8};
  template <class T> void field(int, const T* x, const T* par, T* f) const { f[0] = x[1]; f[1] = -par[0]; }
  template <class T> T event(int, const T* x, const T*) const { return x[0]; }
  template <class T> void jump(int, const T* x, const T* par, T* g) const { g[0] = x[0]; g[1] = -par[1] * x[1]; }
};
TCHAT_PROBLEM(Ball)
)";

const char* const project = R"(cmake_minimum_required(VERSION 3.25)
project(balls LANGUAGES CXX)
find_package(tchat 1 REQUIRED)
add_library(ball MODULE ball.cpp)
target_link_libraries(ball PRIVATE tchat::plugin)
set_target_properties(ball PROPERTIES PREFIX "")
)";

}  // namespace

TEST_CASE("installed, and moved elsewhere: everything works outside the source tree") {
  const Installation installation;
  const Workspace& workspace = installation.workspace();
  for (const char* file :
       {"bin/tchat", "libexec/tchat/@gc", "libexec/tchat/@sv", "libexec/tchat/tc-hat", "share/man/man1/tchat.1",
        "share/man/man1/tchat-run.1", "share/bash-completion/completions/tchat", "include/tchat/problem.hpp",
        "include/tchat/problem.h", "include/tchat/gccont.h", "share/tchat/problems/mems/mems.cpp",
        "share/tchat/constants/linosc/gc.impacting", "share/doc/tchat/README.md",
        "share/tchat/python/tchat/__init__.py", "share/doc/tchat/src/docs/tutorial.md",
        "share/doc/tchat/problems/linosc/README.md"}) {
    INFO(file);
    CHECK(workspace.has(std::string("prefix/") + file));
  }

  SECTION("a new problem") {
    installation.shell("tchat new mine && make -C mine q.impacting");
    CHECK(workspace.has("mine/q.impacting"));
  }
  SECTION("an example's Makefile wants a folder for its results") {
    const Outcome refused = installation.shell(
        "! make -C prefix/share/tchat/problems/linosc 2>&1 && make -n -C prefix/share/tchat/problems/mems "
        "OUT=\"$PWD/out\"");
    CHECK(refused.out.find("make OUT=/some/folder") != std::string::npos);
    CHECK(refused.out.find("/out/q.impacting") != std::string::npos);
    CHECK_FALSE(workspace.has("prefix/share/tchat/build"));
    installation.shell("make -C prefix/share/tchat/problems/linosc OUT=\"$PWD/out\" \"$PWD/out/q.grazing\"");
    CHECK(workspace.has("out/q.grazing"));
  }
  SECTION("Fortran, by the Makefile in TC-HAT's manner") {
    installation.shell(
        "cp -rL prefix/share/tchat/problems/mems_fortran . && PATH=\"$PWD/prefix/libexec/tchat:$PATH\" make -C "
        "mems_fortran 1 2");
    CHECK(workspace.has("mems_fortran/q.mems.2"));
  }
  SECTION("another project") {
    workspace.write("ball.cpp", ball);
    workspace.write("CMakeLists.txt", project);
    const Outcome outcome =
        installation.shell("'" CMAKE_PROGRAM
                           "' -S . -B build -DCMAKE_PREFIX_PATH=\"$PWD/prefix\" -DCMAKE_BUILD_TYPE=Release\n"
                           "'" CMAKE_PROGRAM
                           "' --build build\n"
                           "cp build/ball.so . && tchat check ball");
    CHECK(outcome.out.find("Ball") != std::string::npos);
  }
  SECTION("a program that computes with the library, as on the page library.md") {
    const Outcome outcome =
        installation.shell("cp -r prefix/share/doc/tchat/src/docs/library example\n'" CMAKE_PROGRAM
                           "' -S example -B build -DCMAKE_PREFIX_PATH=\"$PWD/prefix\" "
                           "-DCMAKE_BUILD_TYPE=Debug\n'" CMAKE_PROGRAM "' --build build\nbuild/clock");
    CHECK(outcome.out.find("it is 0.4") != std::string::npos);
    CHECK(outcome.out.find("Largest difference from the closed form: ") != std::string::npos);
  }
}
