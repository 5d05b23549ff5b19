// tchat sweep refuses what it cannot use: exit status 2, one message with what is wrong and the cure.
#include "end_to_end/bad_input.hpp"

using namespace test_support;

TEST_CASE("sweep: bad options") {
  const Workspace workspace;
  for (const char* arguments : {"", "linosc --nosuch", "linosc --over alpha=1:2:3 -j 0",
                                "linosc --over alpha=1:2:3 -j x", "linosc --over alpha=1:2:3 --events 0",
                                "linosc --over alpha=1:2:3 --tolerance 1", "linosc --over alpha=1:2:3 --lyapunov -1"}) {
    INFO("tchat sweep " << arguments);
    check_refused(workspace.tchat(std::string("sweep ") + arguments), {"--help"});
  }
  const Outcome help = workspace.tchat("sweep --help");
  CHECK(help.status == 0);
  CHECK(contains(help.out, "tchat sweep linosc --over"));
}

TEST_CASE("sweep: what is swept") {
  const Workspace workspace;
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    INFO("tchat sweep linosc " << arguments);
    check_refused(workspace.tchat("sweep linosc " + arguments), parts);
    CHECK_FALSE(workspace.has("linosc.sweep"));
    CHECK_FALSE(workspace.has("linosc.sweep.journal"));
  };
  refused("", {"nothing to sweep over", "--over mu=-0.82:-0.79:301"});
  refused("--over alpha", {"--over alpha", "NAME=FROM:TO:COUNT"});
  refused("--over alpha=1:2", {"NAME=FROM:TO:COUNT"});
  refused("--over =1:2:3", {"NAME=FROM:TO:COUNT"});
  refused("--over alpha=1:2:x", {"COUNT 'x'", "whole number"});
  refused("--over alpha=1:2:0", {"COUNT '0'"});
  refused("--over alpha=1:2:3.5", {"COUNT '3.5'"});
  refused("--over alpha=nan:2:3", {"FROM 'nan'", "finite"});
  refused("--over alpha=1:inf:3", {"TO 'inf'", "finite"});
  refused("--over alpha=1:2:1", {"COUNT at least 2"});
  refused("--over alpha=1:1:2", {"FROM and TO are the same"});
  refused("--over gamma=1:2:3", {"PAR(gamma) is no parameter", "alpha, omega, zeta, r", "x1, x2, y1, y2"});
  refused("--over PAR(9)=1:2:3", {"PAR(9) is no parameter"});
  refused("--over PAR(61)=1:2:3", {"duration"});
  refused("--over alpha=1:2:3 --over alpha=1:3:4", {"the same quantity twice"});
  refused("--over alpha=1:2:3 --over PAR(1)=1:3:4", {"the same quantity twice"});
  refused("--over alpha=1:2:3 --over omega=1:2:3 --over r=0:1:3", {"3 times", "one or two"});
  refused("--over alpha=1:2:100000 --over omega=1:2:100000", {"1e+10 values", "1e+07"});
  refused("--over alpha=1:2:3 --follow sideways", {"--follow sideways", "up, down, both"});
  refused("--over x1=0:1:3 --follow up", {"x1 is an initial state", "along a parameter"});
  refused("--over alpha=1:2:3 --section 7", {"--section 7", "no such event function", "1 (wall)"});
  refused("--over alpha=1:2:3 --penetration floor", {"--penetration floor", "1 (wall)"});
  refused("--over alpha=1:2:3 --lyapunov 5", {"--lyapunov 5", "4 states"});
  refused("--over alpha=1:2:3 --state x1=0,q=1", {"no state 'q'"});
  refused("--over alpha=1:2:3 --state 0,0", {"2 values", "4 states"});
  refused("--over alpha=1:2:3 --mode 9,1,1", {"--mode 9,1,1"});
  refused("--over alpha=1:2:3 PAR(gamma)=1", {"gamma"});
  refused("--over alpha=1:2:3 --part 0/3", {"--part 0/3", "1 <= I <= N"});
  refused("--over alpha=1:2:3 --part 4/3", {"--part 4/3"});
  refused("--over alpha=1:2:3 --part 2", {"--part 2", "--part 3/7"});
  refused("--over alpha=1:2:3 --part 1/2 --gather", {"--part and --gather"});
  refused("--over alpha=1:2:3 --gather", {"no part linosc.sweep.1", "--part 1/N"});
  refused("--over alpha=1:2:3 -o nosuch/found", {"nosuch"});
  refused("--over alpha=1:2:3 -o ..", {"no name for output files"});
}

TEST_CASE("sweep: files in the way that are none of a sweep") {
  const Workspace workspace;
  workspace.write("taken.sweep.journal", "a diary\n");
  check_refused(workspace.tchat("sweep linosc --over alpha=1:2:3 -o taken"), {"taken.sweep.journal", "no journal"});
  CHECK(workspace.read("taken.sweep.journal") == "a diary\n");
  workspace.write("cut.sweep.1", "nothing\n");
  check_refused(workspace.tchat("sweep linosc --over alpha=1:2:3 -o cut --gather"), {"cut.sweep.1", "no journal"});
}
