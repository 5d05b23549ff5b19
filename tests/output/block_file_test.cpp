#include "output/block_file.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <utility>

#include "constants/user_error.hpp"
#include "output/file_size_limit.hpp"
#include "start/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;

TEST_CASE("Blocks are in the file as soon as they are written", "[output]") {
  const test_support::TemporaryFolder folder;
  BlockFile file(folder.file("p.x"), BlockFile::Mode::replace);
  file.write("one\n");
  CHECK(folder.read("p.x") == "one\n");
  BlockFile moved = std::move(file);
  moved.write("two\n");
  CHECK(folder.read("p.x") == "one\ntwo\n");
}

TEST_CASE("Replacing and appending", "[output]") {
  const test_support::TemporaryFolder folder;
  folder.write("p.x", "old\n");
  BlockFile(folder.file("p.x"), BlockFile::Mode::append).write("new\n");
  CHECK(folder.read("p.x") == "old\nnew\n");
  BlockFile(folder.file("p.x"), BlockFile::Mode::replace).write("newest\n");
  CHECK(folder.read("p.x") == "newest\n");
}

TEST_CASE("A full disk is an error that names the file", "[output]") {
  if (!std::filesystem::exists("/dev/full")) return;
  BlockFile file("/dev/full", BlockFile::Mode::append);
  const std::string message = message_of<ComputationError>([&] { file.write("block\n"); });
  CHECK_THAT(message, Contains("/dev/full") && Contains("No space left"));
}

TEST_CASE("The part of a block that still fitted is taken back", "[output]") {
  const test_support::TemporaryFolder folder;
  BlockFile file(folder.file("q.x"), BlockFile::Mode::replace);
  file.write(std::string(1000, 'a') + "\n");
  const test_support::FileSizeLimit limit(1500);
  const std::string message = message_of<ComputationError>([&] { file.write(std::string(1000, 'b') + "\n"); });
  CHECK_THAT(message, Contains("q.x") && Contains("last complete block"));
  CHECK(folder.read("q.x") == std::string(1000, 'a') + "\n");
  file.write("c\n");
  CHECK(folder.read("q.x") == std::string(1000, 'a') + "\nc\n");
}

TEST_CASE("A file that cannot be opened", "[output]") {
  const test_support::TemporaryFolder folder;
  const auto open = [&] { BlockFile(folder.file("none/p.x"), BlockFile::Mode::replace); };
  CHECK_THAT(message_of<ComputationError>(open), Contains("none/p.x") && Contains("No such file"));
}
