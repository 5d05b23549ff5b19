// The command line itself.
#include "end_to_end/bad_input.hpp"

using namespace test_support;

TEST_CASE("commands and options that do not exist or lack something") {
  const Workspace workspace;
  for (const char* arguments :
       {"", "nosuch", "run", "run linosc --nosuch", "run linosc -c", "run linosc -x 3", "labels", "orbit",
        "orbit q.branch", "check", "dat", "labels q.a q.b q.c", "orbit q.branch 1 --dimension -3",
        "orbit q.branch 1 --dimension x", "check linosc --random -5", "new", "new a b", "constants linosc -e -k"}) {
    INFO("tchat " << arguments);
    const Outcome outcome = workspace.tchat(arguments);
    check_refused(outcome, {"--help"});
  }
}

TEST_CASE("unknown commands and options come with near ones") {
  const Workspace workspace;
  check_refused(workspace.tchat("rum"), {"'rum' is no command", "did you mean run?", "simulate, "});
  check_refused(workspace.tchat("xyzzyx linosc"), {"'xyzzyx' is no command; there are: run, "});
  check_refused(workspace.tchat("run linosc --bth"), {"tchat: run: '--bth' is no option", "did you mean --both?"});
  check_refused(workspace.tchat("simulate linosc --evnts=3"), {"simulate: '--evnts' is no option", "--events"});
  check_refused(workspace.tchat("labels q.a q.b"), {"labels: 'q.b' is one argument too many"});
  check_refused(workspace.tchat("orbit q.a"), {"orbit: LABEL is required"});
}

TEST_CASE("options --help and --version") {
  const Workspace workspace;
  for (const char* arguments : {"--help", "run --help", "simulate --help", "labels --help", "orbit --help",
                                "check --help", "dat --help", "new --help", "constants --help"}) {
    const Outcome outcome = workspace.tchat(arguments);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.empty());
    CHECK(contains(outcome.out, "tchat"));
    CHECK_FALSE(contains(outcome.out, " PAR(omega)="));  // unquoted parentheses are refused by the shell
  }
  const Outcome version = workspace.tchat("--version");
  CHECK(version.status == 0);
  CHECK(version.out.compare(0, 6, "tchat ") == 0);
}

TEST_CASE("files that are missing or of another kind are named") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=2 NTST=10");
  workspace.write("gc.seventh", with_line(workspace.read("gc.impacting"), 1, "4 180 7 1"));
  struct BadName {
    std::string arguments;
    std::vector<std::string> expected;
  };
  for (const BadName& bad : {
           BadName{"run nosuch -c impacting -d impacting", {"nosuch.cpp", "nosuch.so"}},
           BadName{"run linosc -c impacting -d nosuch", {"nosuch.dat", "-d"}},
           BadName{"run linosc -c impacting -s nosuch IRS=1", {"q.nosuch", "-s"}},
           BadName{"run linosc -c impacting -d impacting -p nosuch", {"nosuch.cpp"}},
           BadName{"run linosc -c impacting -d .", {"."}},
           BadName{"run linosc -c . -d impacting", {"gc."}},
           BadName{"run linosc -c impacting", {"linosc.dat", "-d"}},
           BadName{"run linosc -d impacting", {"gc.linosc", "-c"}},
           BadName{"run linosc -c gc.unwritten -d impacting",
                   {"no constants file gc.unwritten;", "simulate unwritten --dat unwritten"}},
           BadName{"run linosc -c impacting -d impacting -o nowhere/x", {"nowhere", "-o"}},
           BadName{"run linosc -c impacting -d impacting -o x/", {"-o"}},
           BadName{"labels q.nosuch", {"q.nosuch"}},
           BadName{"labels .", {"directory"}},
           BadName{"labels impacting.dat", {"impacting.dat:1", "starting data", "q.impacting"}},
           BadName{"labels p.branch", {"p.branch:1", "this is a p-file", "give q.branch"}},
           BadName{"labels d.branch", {"d.branch:1", "this is a d-file", "give q.branch"}},
           BadName{"orbit r.branch 1", {"r.branch:1", "constants file", "give q.branch"}},
           BadName{"run linosc -c impacting -s p.branch IRS=1", {"p.branch:1", "this is a p-file", "give q.branch"}},
           BadName{"run linosc -c seventh -s branch", {"q.branch", "no label 7", "IRS = 7 is from gc.seventh"}},
           BadName{"run linosc -c seventh -s branch PAR(nosuch)=1", {"PAR(nosuch)"}},
           BadName{"orbit q.branch 99", {"q.branch", "99", "1 (EP)"}},
           BadName{"orbit q.branch PD1", {"q.branch", "PD1", "1 (EP)"}},
           BadName{"orbit q.branch first", {"'first'", "PD1"}},
           BadName{"check nosuch", {"nosuch.cpp"}},
           BadName{"check linosc --state 1,2", {"4"}},
           BadName{"check linosc --state 1,2,x,4", {"'x'", "number"}},
           BadName{"check linosc PAR(nosuch)=2", {"nosuch", "alpha"}},
           BadName{"dat linosc -c impacting -d nosuch", {"nosuch.dat"}},
       }) {
    INFO("tchat " << bad.arguments);
    check_refused(workspace.tchat(bad.arguments), bad.expected);
  }
  const Outcome asked = workspace.tchat("run linosc -c seventh -s branch IRS=8");
  check_refused(asked, {"no label 8"});
  CHECK_FALSE(contains(asked.err, "is from"));
}
