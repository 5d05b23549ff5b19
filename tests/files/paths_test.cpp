// Which files the words of a command line name.
#include <catch2/catch.hpp>
#include <filesystem>

#include "base/messages.hpp"
#include "files/run_files.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using test_support::TemporaryFolder;

TEST_CASE("gc.C comes before C, and a folder C has its own") {
  const TemporaryFolder folder;
  folder.write("a", "");
  CHECK(constants_path(folder.file("a")) == folder.file("a"));
  folder.write("gc.a", "");
  CHECK(constants_path(folder.file("a")) == folder.file("gc.a"));
  std::filesystem::create_directory(folder.file("b"));
  folder.write("b/gc.b", "");
  CHECK(std::filesystem::equivalent(constants_path(folder.file("b")), folder.file("b/gc.b")));
  CHECK_THROWS_AS(constants_path(folder.file("c")), UserError);
  CHECK(own_constants_path(folder.file("c")).empty());
}

TEST_CASE("q.S comes before S") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(solution_path(folder.file("s")), UserError);
  folder.write("s", "");
  CHECK(solution_path(folder.file("s")) == folder.file("s"));
  folder.write("q.s", "");
  CHECK(solution_path(folder.file("s")) == folder.file("q.s"));
}

TEST_CASE("the constants of a run are those it has written, else those of tchat resegment") {
  const TemporaryFolder folder;
  const std::string solutions = folder.write("q.s", "");
  CHECK_THROWS_AS(constants_of_run(std::nullopt, solutions), UserError);
  folder.write("gc.s", "");
  CHECK(constants_of_run(std::nullopt, solutions) == folder.file("gc.s"));
  folder.write("r.s", "");
  CHECK(constants_of_run(std::nullopt, solutions) == folder.file("r.s"));
  CHECK(constants_of_run(folder.file("s"), solutions) == folder.file("gc.s"));
}

TEST_CASE("one file has many paths") {
  const TemporaryFolder folder;
  folder.write("a", "");
  folder.write("b", "");
  CHECK(same_file(folder.file("a"), folder.file("./a")));
  CHECK_FALSE(same_file(folder.file("a"), folder.file("b")));
  CHECK_FALSE(same_file(folder.file("c"), folder.file("c")));  // none is there
}
