#include "files/auto_format.hpp"

#include <catch2/catch.hpp>

using namespace tchat;

TEST_CASE("Names of files of one run") {
  CHECK(sibling_path("results/p.mems", 'q') == "results/q.mems");
  CHECK(sibling_path("q.mems", 'd') == "d.mems");
  CHECK(sibling_path("fort.7", 'q') == "fort.8");
  CHECK(sibling_path("fort.8", 'r') == "fort.2");
  CHECK(sibling_path("q.mems", 'r') == "r.mems");
  CHECK(sibling_path("b.ab", 'q') == "s.ab");
  CHECK(sibling_path("mems", 'q').empty());
  CHECK(run_name("results/p.mems") == "mems");
  CHECK(run_name("fort.7") == "fort.7");
  CHECK(constants_file_of("models/mems") == "models/gc.mems");
  CHECK(constants_file_of("mems") == "gc.mems");
}
