#include "files/replaced_file.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "base/messages.hpp"
#include "files/file_size_limit.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::TemporaryFolder;

namespace fs = std::filesystem;

namespace {

std::size_t files_in(const TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.file(".")), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("A file is replaced whole, the old one is kept") {
  const TemporaryFolder folder;
  for (const std::string text : {"one", "two", "three"}) write_whole_file(folder.file("q.x"), text);
  CHECK(folder.read("q.x") == "three");
  CHECK(folder.read("q.x~") == "two");
  CHECK(files_in(folder) == 2);
}

TEST_CASE("A file that cannot be kept is not replaced") {
  const TemporaryFolder folder;
  folder.write("q.x", "old");
  fs::create_directory(folder.file("q.x~"));
  CHECK_THAT(message_of<UserError>([&] { write_whole_file(folder.file("q.x"), "new"); }),
             Contains("q.x~") && Contains("is a directory"));
  CHECK(folder.read("q.x") == "old");
  // The directory may come later.
  fs::remove(folder.file("q.x~"));
  ReplacedFile file(folder.file("q.x"));
  file.write("new");
  fs::create_directory(folder.file("q.x~"));
  CHECK_THROWS_AS(file.finish(), ComputationError);
  CHECK(folder.read("q.x") == "old");
}

TEST_CASE("A full disk leaves the old file and nothing else") {
  const TemporaryFolder folder;
  folder.write("q.x", "old");
  const test_support::FileSizeLimit limit(100);
  CHECK_THROWS_AS(write_whole_file(folder.file("q.x"), std::string(1000, 'a')), ComputationError);
  CHECK(folder.read("q.x") == "old");
  CHECK(files_in(folder) == 1);
}

TEST_CASE("A temporary file is not opened through a link that lies there") {
  const TemporaryFolder folder;
  folder.write("precious", "untouched");
  for (const char* name : {"q.x.new", "q.x~", ".q.x.new"})
    fs::create_symlink(folder.file("precious"), folder.file(name));
  folder.write("q.x", "old");
  write_whole_file(folder.file("q.x"), "new");
  CHECK(folder.read("q.x") == "new");
  CHECK(folder.read("precious") == "untouched");
  const TemporaryFile one(folder.file("q.x")), two(folder.file("q.x"));
  CHECK(one.name() != two.name());
}

TEST_CASE("A file keeps its first name when it gets a second one") {
  const TemporaryFolder folder;
  folder.write("q.x", "text");
  for (int k = 0; k < 2; ++k) {
    keep_as(folder.file("q.x"), folder.file("q.x~"));
    CHECK(folder.read("q.x") == "text");
    CHECK(folder.read("q.x~") == "text");
    CHECK(files_in(folder) == 2);
  }
  separate(folder.file("q.x"), folder.file("q.x~"));
  folder.write("q.x", "more");
  CHECK(folder.read("q.x~") == "text");
}

TEST_CASE("What a killed process left is removed with the next file of the name, what another one is writing is not") {
  const TemporaryFolder folder;
  folder.write(".a.png.aB3dE6.new", "abandoned");
  folder.write(".b.png.aB3dE6.new", "another name's");
  const TemporaryFile first(folder.file("a.png"));
  CHECK_FALSE(folder.has(".a.png.aB3dE6.new"));
  CHECK(folder.has(".b.png.aB3dE6.new"));
  TemporaryFile closed(folder.file("a.png"));  // as one that another program writes into
  closed.close();
  const TemporaryFile third(folder.file("a.png"));
  CHECK(fs::exists(first.name()));
  CHECK(fs::exists(closed.name()));
  closed.put_in_place();
  CHECK(folder.has("a.png"));

  folder.write(".q.x~.aB3dE6.new", "abandoned");
  write_whole_file(folder.file("q.x"), "new");
  CHECK_FALSE(folder.has(".q.x~.aB3dE6.new"));
}
