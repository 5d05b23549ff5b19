// Malformed constants, in files and on the command line.
#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

struct BadLine {
  int line;                           // of gc.impacting
  std::string text;                   // that replaces it
  std::vector<std::string> expected;  // in the message, besides the file and the line
  int found_at = 0;                   // line of the fault, when it is another one
};

}  // namespace

TEST_CASE("a malformed line of a constants file is refused by file, line and constant") {
  const Workspace workspace;
  const std::string good = workspace.read("gc.impacting");
  const std::vector<BadLine> table{
      {1, "four 180 0 1", {"'four 180 0 1'", "KEY = value", "example"}},
      {1, "4 four 0 1", {"IPS", "'four'", "allowed", "example"}},
      {1, "4.5 180 0 1", {"NDIM", "'4.5'", "allowed"}},
      {1, "0 180 0 1", {"NDIM", "'0'", "allowed"}},
      {1, "-4 180 0 1", {"NDIM", "'-4'", "allowed"}},
      {1, "99999999999 180 0 1", {"NDIM", "99999999999", "allowed"}},
      {1, "4 2 0 1", {"IPS", "'2'", "180", "150"}},
      {1, "4 180 XX1 1", {"IRS", "'XX1'", "PD1"}},
      {1, "4 180 -1 1", {"IRS", "'-1'", "allowed"}},
      {1, "4 180 0 7", {"ILP", "'7'", "allowed"}},
      {1, "4 180 0,,1", {"null value", "allowed"}},
      {1, "4 180 /", {"'/'", "allowed"}},
      {1, "9*4", {"allowed"}},
      {2, "0", {"NICP", "'0'", "allowed"}},
      {2, "2 1 1", {"ICP", "once"}},
      {2, "2 0 61", {"ICP(1)", "'0'", "allowed"}},
      {2, "2 1 99", {"ICP(2)", "'99'", "allowed"}},
      {2, "1 61", {"ICP", "allowed"}},
      {3, "0 4 3 2 1 0 0 0", {"NTST", "'0'", "allowed"}},
      {3, "5001 4 3 2 1 0 0 0", {"NTST", "'5001'", "allowed"}},
      {3, "50 1 3 2 1 0 0 0", {"NCOL", "'1'", "allowed"}},
      {3, "50 8 3 2 1 0 0 0", {"NCOL", "'8'", "allowed"}},
      {3, "50 4 -1 2 1 0 0 0", {"IAD", "'-1'", "allowed"}},
      {3, "50 4 3 9 1 0 0 0", {"ISP", "'9'", "allowed"}},
      {3, "50 4 3 2 7 0 0 0", {"ISW", "'7'", "allowed"}},
      {4, "-1 2.5 3.4 0 100", {"NMX", "'-1'", "allowed"}},
      {4, "60 3.4 2.5 0 100", {"RL1", "2.5", "RL0"}},
      {4, "60 nan 3.4 0 100", {"RL0", "'nan'", "allowed"}},
      {4, "60 2.5 1e999 0 100", {"RL1", "1e999", "allowed"}},
      {4, "60 2.5 3.4 5 5", {"A1", "A0"}},
      {5, "-10 0 2 10 8 3 0", {"NPR", "'-10'", "allowed"}},
      {5, "10 0 2 10 0 3 0", {"ITNW", "'0'", "allowed"}},
      {6, "0 1e-10 1e-9", {"EPSL", "'0'", "allowed"}},
      {6, "1e-10 -1e-10 1e-9", {"EPSU", "allowed"}},
      {7, "0 0 0.5 1", {"DS", "'0'", "allowed"}},
      {7, "0.02 -1 0.5 1", {"DSMIN", "'-1'", "allowed"}},
      {7, "0.02 0 0 1", {"DSMAX", "'0'", "IADS"}},
      {8, "2", {"ITHL", "allowed"}, 10},
      {9, "99 0.0", {"ITHL", "'99'", "allowed"}},
      {9, "61 -1", {"THL", "'-1'", "allowed"}},
      {10, "1\n9 1.0", {"ITHU", "'9'", "allowed"}, 11},
      {12, "99 3.2", {"IUZR", "'99'", "allowed"}},
      {16, "0", {"GCNOSEG", "'0'", "allowed"}},
      {16, "1 5", {"GCSEGTYP", "'5'", "allowed"}},
      {17, "0", {"GCFIND", "'0'", "allowed"}},
      {20, "-1", {"GCHNO", "'-1'", "allowed"}},
      {20, "1 1\nSTOP = [XX1]", {"STOP", "'XX1'", "allowed"}, 21},
      {20, "1 1\nGRSTOP = 2", {"GRSTOP", "allowed"}, 21},
      {20, "1 1\nNTST = 20", {"NTST"}, 21},
      {20, "1 1\n1 1", {"GCHNO"}, 21},
      {20, "1 1\nNOSUCH = 3", {"NOSUCH"}, 21},
  };
  for (const BadLine& bad : table) {
    INFO("line " << bad.line << " is: " << bad.text);
    workspace.write("gc.impacting", with_line(good, bad.line, bad.text));
    const Outcome outcome = workspace.tchat("run linosc -c impacting -d impacting -o none");
    check_refused(outcome, bad.expected);
    const int line = bad.found_at > 0 ? bad.found_at : bad.line;
    CHECK(contains(outcome.err, "gc.impacting:" + std::to_string(line) + ":"));
    CHECK_FALSE(workspace.has("p.none"));
  }
}

TEST_CASE("a constants file that ends early, is empty, binary or missing") {
  const Workspace workspace;
  const std::string good = workspace.read("gc.impacting");
  const auto refused = [&](const std::string& text, const std::vector<std::string>& expected) {
    workspace.write("gc.impacting", text);
    check_refused(workspace.tchat("run linosc -c impacting -d impacting -o none"), expected);
  };
  refused("", {"gc.impacting", "empty", "NDIM"});
  refused("\n  \n", {"gc.impacting", "empty"});
  refused(good.substr(0, good.find("0 2   ")), {"gc.impacting:", "end of the file", "GCISTART"});
  refused(good.substr(0, good.rfind("1 1   ")), {"gc.impacting:", "end of the file", "GCHNO"});
  refused(std::string("\x7f"
                      "ELF\0\1\2\3",
                      8),
          {"gc.impacting"});
  refused("no constants at all\n", {"gc.impacting:1"});
  refused("NDIM = 4\nNDIM = 4\n", {"gc.impacting:2", "NDIM", "line 1"});
  refused("NDIM = 4\nUZR = {1: [3.1\n", {"gc.impacting:"});
  check_refused(workspace.tchat("run linosc -c nothing -d impacting -o none"), {"gc.nothing", "-c"});
  CHECK_FALSE(workspace.has("p.none"));
}

TEST_CASE("constants that do not fit the problem") {
  const Workspace workspace;
  const std::string good = workspace.read("gc.impacting");
  const auto refused = [&](int line, const std::string& text, const std::vector<std::string>& expected) {
    INFO("line " << line << " is: " << text);
    workspace.write("gc.impacting", with_line(good, line, text));
    check_refused(workspace.tchat("run linosc -c impacting -d impacting -o none"), expected);
  };
  refused(1, "5 180 0 1", {"gc.impacting", "NDIM", "4"});
  refused(17, "2", {"gc.impacting", "GCFIND", "1..1"});
  refused(18, "4", {"gc.impacting", "GCHIND", "1..3"});
  refused(19, "3", {"gc.impacting", "GCGIND", "1..2"});
  refused(20, "1 7", {"gc.impacting", "GCHGRZIND", "1..3"});
  refused(3, "50 4 3 2 2 0 0 0", {"gc.impacting", "ISW"});
  refused(2, "2 5 61", {"gc.impacting", "ICP", "PAR(5)", "alpha, omega, zeta, r"});
  refused(12, "5 3.2", {"gc.impacting", "UZR", "PAR(5)"});
  workspace.write("gc.named", "NDIM = 4\nICP = [omega]\nUZR = {nosuch: 3}\n");
  check_refused(workspace.tchat("run linosc -c named -d impacting -o none"),
                {"gc.named:3: UZR (", "nosuch is no parameter"});
}

TEST_CASE("parameters beyond the problem's own that do no harm are warned of") {
  const Workspace workspace;
  const Outcome outcome = workspace.run(
      {"-c", "impacting", "-d", "impacting", "-o", "some", "NMX=1", "ICP=[1,61,7]", "THL={11: 0, 61: 0}"});
  CHECK(contains(outcome.err, "warning: command line: ICP: PAR(7)"));
  CHECK(contains(outcome.err, "warning: command line: THL: PAR(11)"));
}

TEST_CASE("overrides that cannot be") {
  const Workspace workspace;
  struct BadOverride {
    std::string text;
    std::vector<std::string> expected;
  };
  const std::vector<BadOverride> table{
      {"NTST=abc", {"NTST", "'abc'", "allowed"}},
      {"NTST=", {"NTST"}},
      {"NTSTT=5", {"NTSTT", "NTST"}},
      {"=5", {"=5"}},
      {"5", {"5"}},
      {"DS=0", {"DS", "'0'"}},
      {"DS=0.1.2", {"DS", "0.1.2"}},
      {"PAR(2)=x", {"PAR(2)", "'x'"}},
      {"PAR(nosuch)=1", {"nosuch", "alpha, omega, zeta, r"}},
      {"PAR(0)=1", {"PAR(0)"}},
      {"PAR(5)=1", {"PAR(5)", "PAR(1) to PAR(4): alpha, omega, zeta, r"}},
      {"PAR(62)=1", {"PAR(62)", "61"}},
      {"alpha=3", {"'alpha'", "'PAR(alpha)=3'"}},
      {"ICP=[nosuch]", {"ICP (", "nosuch is no parameter", "alpha, omega, zeta, r"}},
      {"UZR={nosuch: 3}", {"UZR (", "nosuch is no parameter"}},
      {"THL={nosuch: 3}", {"THL (", "nosuch is no parameter"}},
      {"GCFIND=[1,1]", {"GCFIND has 2", "GCHIND has 1"}},
      {"PAR(77)=1", {"PAR(77)"}},
      {"PAR(2=1", {"(2=1", "parenthesis"}},
      {"UZR={1: [}", {"UZR"}},
      {"UZR={0: 1}", {"IUZR"}},
      {"ICP=[]", {"ICP"}},
      {"ICP=[61]", {"ICP"}},
      {"STOP=PD", {"STOP"}},
      {"GCNOSEG=2", {"GC"}},
      {"IPS=1", {"GCHIND", "IPS = 1"}},
      {"RL0=5 RL1=4", {"RL1", "RL0"}},
  };
  for (const BadOverride& bad : table) {
    INFO(bad.text);
    std::vector<std::string> words{"run", "linosc", "-c", "impacting", "-d", "impacting", "-o", "none"};
    if (bad.text.find("RL0") == 0)
      for (const std::string& word : words_of(bad.text)) words.push_back(word);
    else
      words.push_back(bad.text);
    const Outcome outcome = workspace.tchat(words);
    check_refused(outcome, bad.expected);
    CHECK(contains(outcome.err, "command line"));
  }
}

TEST_CASE("constants that no run can use are refused with what is allowed") {
  const Workspace workspace;
  struct Refused {
    std::string constant;
    std::vector<std::string> expected;
  };
  // The oscillator has 4 states, 2 jumps; gc.impacting has DSMAX = 0.5.
  const std::vector<Refused> table{{"UZR={multiplier(9):3}", {"multiplier(9)", "multiplier(1) to multiplier(4)"}},
                                   {"ICP=[alpha,61,multiplier(5)]", {"multiplier(5)", "multiplier(4)"}},
                                   {"DSMIN=1", {"DSMIN", "'1'", "0 to DSMAX = 0.5"}},
                                   {"IPLT=13", {"IPLT", "'13'", "-4 to 12"}},
                                   {"IPLT=-5", {"IPLT", "'-5'", "-4 to 12"}},
                                   {"GRJUMP=9", {"GRJUMP", "9", "1..2"}},
                                   {"THL={1:1e300}", {"THL", "1e300", "from 0 to 1e+60"}},
                                   {"THU={1:1e300}", {"THU", "1e300", "from 0 to 1e+60"}}};
  for (const Refused& refused : table) {
    INFO(refused.constant);
    check_refused(workspace.tchat(
                      {"run", "linosc", "-c", "impacting", "-d", "impacting", "-o", "none", "NMX=2", refused.constant}),
                  refused.expected);
    CHECK_FALSE(workspace.has("p.none"));
  }
  for (const char* const allowed : {"IPLT=12", "IPLT=-4", "DSMIN=0.5", "GRJUMP=2", "UZR={multiplier(4):3}"}) {
    INFO(allowed);
    CHECK(workspace
              .tchat({"run", "linosc", "-c", "impacting", "-d", "impacting", "-o", "some", "NMX=2", "NTST=10", "A0=-10",
                      allowed})
              .status == 0);
  }
}
