#include <catch2/catch.hpp>

#include "settings/constants_file.hpp"
#include "settings/sample_files.hpp"

using namespace tchat;
using Ints = std::vector<int>;

namespace {

RunSettings read(const std::string& text) { return read_constants_text(text, "gc.test"); }

}  // namespace

TEST_CASE("The keyword form says the same as Appendix B", "[constants]") {
  const std::string text = R"(# MEMS oscillator, impacting orbit
NDIM = 5, IPS = 180, IRS = 1, ILP = 1
icp = [1, 61, 62]      # frame voltage and durations
NTST=50, NCOL=2, IAD=3, ISP=2, ISW=1
NMX = 1000, RL0 = 0.0, RL1 = 1.0, A0 = 0.0, A1 = 100.0
NPR = 1, MXBF = 0, IID = 2, ITMX = 10, ITNW = 8, NWTN = 3, JAC = 0
EPSL = 1.e-10, EPSU = 1D-10, EPSS = 1d-10
DS = 0.0001, DSMIN = 0, DSMAX = .005, IADS = 1
THL = {61: 0.0,
       62: 0.0}
UZR = {}
GCIDIFF = 1, GCIPSI = 1, 2, 3
GCNOSEG = 2
GCSEGTYP = [1, 0]
GCFIND = [1, 2], GCHIND = [1, 2]
GCGIND = 1 2
GCHGRZIND = [[1], [2, 1]])";
  CHECK(testing::same_constants(read(text), read(testing::appendix_b())));
}

TEST_CASE("What a keyword file leaves out has its default", "[constants]") {
  const RunSettings s = read("ICP = 1");
  RunSettings expected;
  expected.free_parameters = {1};
  expected.segments.resize(1);
  CHECK(testing::same_constants(s, expected));
  REQUIRE(s.segments.size() == 1);
  CHECK(s.segments[0].index == IndexVector{1, 1, 1});
}

TEST_CASE("Monitored events come as lists of segments or as one list with its lengths", "[constants]") {
  const std::string two = "ICP=1\nGCFIND=[1,1]\nGCHIND=[1,2]\nGCGIND=[1,2]\n";
  const RunSettings nested = read(two + "GCHGRZIND=[[], [3, 4]]");
  CHECK(nested.segments[0].monitor.empty());
  CHECK(nested.segments[1].monitor == Ints{3, 4});
  const RunSettings flat = read(two + "GCHNO=[1, 2]\nGCHGRZIND=[5, 3, 4]");
  CHECK(flat.segments[0].monitor == Ints{5});
  CHECK(flat.segments[1].monitor == Ints{3, 4});
  CHECK(read("ICP=1, GCHGRZIND=[2, 1]").segments[0].monitor == Ints{2, 1});
}

TEST_CASE("Pairs hold one value or several", "[constants]") {
  const RunSettings s = read("ICP = [2]\nUZR = {1: [2.5, 3.0], -2: 4, 61: [7]}\nNUZR = 4");
  REQUIRE(s.user_values.size() == 4);
  CHECK(s.user_values[0].parameter == 1);
  CHECK(s.user_values[0].value == 2.5);
  CHECK(s.user_values[1].value == 3.0);
  CHECK(s.user_values[2].parameter == 2);
  CHECK(s.user_values[2].stop);
  CHECK(s.user_values[3].parameter == 61);
}

TEST_CASE("The start and the stop rules take quotes", "[constants]") {
  const RunSettings s = read("IRS = 'UZ3', ICP = [1], STOP = [\"LP1\"]\r\n");
  CHECK(s.start.type == "UZ");
  CHECK(s.start.number == 3);
  REQUIRE(s.stop_rules.size() == 1);
  CHECK(s.stop_rules[0].type == "LP");
}

TEST_CASE("An empty value removes a name", "[constants]") {
  CHECK(read("ICP = period\nCONSERVED = energy").conserved == "energy");
  const RunSettings s = read("ICP = 1\nCONSERVED =   # none\nNTST = 7");
  CHECK(s.conserved.empty());
  CHECK(s.mesh_intervals == 7);
}
