#include "files/dat_file.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "support/temporary_folder.hpp"

using namespace tchat;

TEST_CASE("Rows of one segment, t rescaled to [0,1]", "[start]") {
  const DatFile file = parse_dat_file("2.0 1.0 -1.0\n3.0 0.5 -0.5\n6.0 0.25 -0.25\n", "x.dat", 2, 1);
  CHECK(file.span == 4.0);
  REQUIRE(file.tau.size() == 3);
  CHECK(file.tau[0] == 0.0);
  CHECK(file.tau[1] == 0.25);
  CHECK(file.tau[2] == 1.0);
  REQUIRE(file.states.rows() == 2);
  REQUIRE(file.states.cols() == 3);
  CHECK(file.states(0, 1) == 0.5);
  CHECK(file.states(1, 2) == -0.25);
  CHECK(file.parameters.empty());
}

TEST_CASE("Segments stand side by side", "[start]") {
  const DatFile file = parse_dat_file("0 1 2 3 4\n1 5 6 7 8\n", "x.dat", 2, 2);
  REQUIRE(file.states.rows() == 4);
  CHECK(file.states(0, 0) == 1.0);
  CHECK(file.states(2, 0) == 3.0);
  CHECK(file.states(3, 1) == 8.0);
}

TEST_CASE("The dissertation's layout: heading with trailing dots, tabs", "[start]") {
  const DatFile file = parse_dat_file(
      "t\tX1\tX2\tX3\t.\n"
      "0.0000000000000000\t0.0000000000000000\t0.5000000000000000\t-0.0000000000000001\n"
      "0.0111679249845897\t0.0000000000000000\t0.4999688308510247\t-0.0055817549964804\n"
      "1.0000000000000000\t0.0000000000000000\t0.4954553713008992\t-0.0667235154828182\n",
      "x.dat", 3, 1);
  REQUIRE(file.tau.size() == 3);
  CHECK(file.tau[1] == 0.0111679249845897);
  CHECK(file.states(2, 1) == -0.0055817549964804);
}

TEST_CASE("Comments, blank lines, CRLF, D exponents, commas, no final newline, byte order mark", "[start]") {
  const DatFile file = parse_dat_file(
      "\xEF\xBB\xBF# an orbit\r\n\r\n  t , x\r\n0.0D0, 1.5D-1 # first\r\n   \r\n1.0d+00\t2.5-101", "x.dat", 1, 1);
  REQUIRE(file.tau.size() == 2);
  CHECK(file.states(0, 0) == 0.15);
  CHECK(file.states(0, 1) == 2.5e-101);
}

TEST_CASE("Parameter values in comments, by index and by name", "[start]") {
  const DatFile file = parse_dat_file(
      "# PAR(1) = 3.0\n#PAR( 61 )=1.5D0, PAR(62) = 0.25\n0 1\n# PAR(omega) = -2.5E-1  forcing frequency\n"
      "# par(2)=7\n# values of PAR(3) = 9 are in the text\n# PAR(4) is the mass\n1 2\n",
      "x.dat", 1, 1);
  REQUIRE(file.parameters.size() == 4);
  CHECK(file.parameters[0] == std::pair<int, double>(1, 3.0));
  CHECK(file.parameters[1] == std::pair<int, double>(61, 1.5));
  CHECK(file.parameters[2] == std::pair<int, double>(62, 0.25));
  CHECK(file.parameters[3] == std::pair<int, double>(2, 7.0));
  REQUIRE(file.named_parameters.size() == 1);
  CHECK(file.named_parameters[0].first == "omega");
  CHECK(file.named_parameters[0].second == -0.25);
}

TEST_CASE("A file on disk gives the same", "[start]") {
  const test_support::TemporaryFolder folder;
  const DatFile file = read_dat_file(folder.write("x.dat", "0 1\n2 3\n"), 1, 1);
  CHECK(file.span == 2.0);
  CHECK(file.states(0, 1) == 3.0);
}
