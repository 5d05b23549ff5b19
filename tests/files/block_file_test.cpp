#include "files/replaced_file.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <utility>

#include "base/messages.hpp"
#include "files/file_size_limit.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;

TEST_CASE("Blocks are in the file as soon as they are written", "[output]") {
  const test_support::TemporaryFolder folder;
  BlockFile file(folder.file("p.x"));
  file.write("one\n");
  CHECK(folder.read("p.x") == "one\n");
  BlockFile moved = std::move(file);
  moved.write("two\n");
  CHECK(folder.read("p.x") == "one\ntwo\n");
}

TEST_CASE("A file that is there is added to", "[output]") {
  const test_support::TemporaryFolder folder;
  folder.write("p.x", "old\n");
  BlockFile(folder.file("p.x")).write("new\n");
  CHECK(folder.read("p.x") == "old\nnew\n");
}

TEST_CASE("Blocks of all sizes, within a page of memory and across many") {
  const test_support::TemporaryFolder folder;
  BlockFile file(folder.file("q.x"));
  std::string expected;
  for (const std::size_t size : {1u, 4094u, 1u, 1u, 4096u, 50000u, 0u, 8191u, 300u}) {
    const std::string block(size, static_cast<char>('a' + expected.size() % 26));
    file.write(block);
    expected += block;
    CHECK(folder.read("q.x") == expected);
  }
}

TEST_CASE("A full disk is an error that names the file", "[output]") {
  if (!std::filesystem::exists("/dev/full")) return;
  BlockFile file("/dev/full");
  const std::string message = message_of<ComputationError>([&] { file.write("block\n"); });
  CHECK_THAT(message, Contains("/dev/full") && Contains("No space left"));
}

TEST_CASE("The part of a block that still fitted is taken back", "[output]") {
  const test_support::TemporaryFolder folder;
  BlockFile file(folder.file("q.x"));
  file.write(std::string(1000, 'a') + "\n");
  const test_support::FileSizeLimit limit(1500);
  const std::string message = message_of<ComputationError>([&] { file.write(std::string(1000, 'b') + "\n"); });
  CHECK_THAT(message, Contains("q.x") && Contains("last complete block"));
  CHECK(folder.read("q.x") == std::string(1000, 'a') + "\n");
  file.write("c\n");
  CHECK(folder.read("q.x") == std::string(1000, 'a') + "\nc\n");
}

TEST_CASE("A file that is to replace another one, on a full disk: the other one stays, and is said to", "[output]") {
  const test_support::TemporaryFolder folder;
  folder.write("x.trajectory", "old\n");
  ReplacedFile file(folder.file("x.trajectory"));
  const test_support::FileSizeLimit limit(1500);
  const std::string message = message_of<ComputationError>([&] { file.write(std::string(2000, 'b')); });
  CHECK_THAT(message, Contains("x.trajectory") && Contains("had this name before stays"));
  CHECK(folder.read("x.trajectory") == "old\n");
}

TEST_CASE("A file that cannot be opened", "[output]") {
  const test_support::TemporaryFolder folder;
  const auto open = [&] { BlockFile(folder.file("none/p.x")); };
  CHECK_THAT(message_of<ComputationError>(open), Contains("none/p.x") && Contains("No such file"));
}
