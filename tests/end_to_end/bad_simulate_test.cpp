// tchat simulate refuses what it cannot use: exit status 2, one message with what is wrong and the cure.
#include <filesystem>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

TEST_CASE("simulate: bad options") {
  const Workspace workspace;
  for (const char* arguments : {"",
                                "linosc --nosuch",
                                "linosc --time 0",
                                "linosc --time -3",
                                "linosc --time nan",
                                "linosc --time inf",
                                "linosc --time x",
                                "linosc --events 0",
                                "linosc --events 2.5",
                                "linosc --events 1e30",
                                "linosc --events -1",
                                "linosc --transient-time -1",
                                "linosc --transient-events -1",
                                "linosc --wait 0",
                                "linosc --tolerance 0",
                                "linosc --tolerance 1",
                                "linosc --tolerance nan",
                                "linosc --max-period 0",
                                "linosc --recognition 0",
                                "linosc --contact -1",
                                "linosc --rows -1",
                                "linosc --state",
                                "linosc --mode"}) {
    INFO("tchat simulate " << arguments);
    check_refused(workspace.tchat(std::string("simulate ") + arguments), {"--help"});
  }
  check_refused(workspace.tchat("simulate linosc --time nan"), {"--time", "'nan'", "a finite number > 0"});
  check_refused(workspace.tchat("simulate linosc --events 2.5"), {"--events", "'2.5'", "a whole number"});
  CHECK_FALSE(workspace.has("linosc.events"));
  const Outcome help = workspace.tchat("simulate --help");
  CHECK(help.status == 0);
  CHECK(contains(help.out, "tchat simulate linosc"));
}

TEST_CASE("simulate: starts, modes, parameters and files that do not exist or make no sense are named") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=2 NTST=10");
  workspace.write("nan.dat", "0 nan 0 0 1\n1 0 0 0 1\n");
  workspace.write("q.foreign", "no solution\n");
  std::filesystem::create_directory(workspace.file("taken.events"));
  std::filesystem::create_directory(workspace.file("gc.taken"));
  struct BadInput {
    std::vector<std::string> words;
    std::vector<std::string> expected;
  };
  for (const BadInput& bad : {
           BadInput{{"nosuch"}, {"nosuch.cpp", "nosuch.so"}},
           BadInput{{"linosc", "PAR(nosuch)=3"}, {"nosuch", "alpha, omega"}},
           BadInput{{"linosc", "PAR(alpha)=nan"}, {"'nan'", "finite"}},
           BadInput{{"linosc", "PAR(alpha)=1e999"}, {"finite"}},
           BadInput{{"linosc", "nonsense"}, {"'nonsense'", "KEY = value"}},
           BadInput{{"linosc", "--state", "nan,0,0,1"}, {"--state", "'nan'", "finite"}},
           BadInput{{"linosc", "--state", "1,2"}, {"2 values", "4 states"}},
           BadInput{{"linosc", "--state", ""}, {"--state"}},
           BadInput{{"linosc", "--state", "1,2,3,4,5"}, {"5 values"}},
           BadInput{{"linosc", "--state", "x9=1"}, {"'x9'", "x1, x2, y1, y2"}},
           BadInput{{"linosc", "--state", "x1=1,x1=2"}, {"'x1'", "twice"}},
           BadInput{{"linosc", "--state", "x1=1,2"}, {"'2'", "NAME=VALUE"}},
           BadInput{{"linosc", "--state", "x1=one"}, {"'one'"}},
           BadInput{{"linosc", "--mode", "9,1,1"}, {"field 9", "1..1"}},
           BadInput{{"linosc", "--mode", "1,7,1"}, {"event function 7", "1..3"}},
           BadInput{{"linosc", "--mode", "1,1,-2"}, {"jump -2"}},
           BadInput{{"linosc", "--mode", "1,1"}, {"'1,1'", "field,event,jump"}},
           BadInput{{"linosc", "--mode", "x"}, {"'x'", "1,2,1"}},
           BadInput{{"linosc", "--mode", ""}, {"--mode"}},
           BadInput{{"linosc", "--signature", "1,9,1"}, {"--signature", "event function 9"}},
           BadInput{{"linosc", "--signature", "x"}, {"--signature", "'x'"}},
           BadInput{{"linosc", "--signature", "1,2,2", "--mode", "1,1,1"}, {"--mode", "{(1,2,2)}"}},
           BadInput{{"linosc", "--follow-signature"}, {"--follow-signature", "--signature", "-c"}},
           BadInput{{"linosc", "-c", "nosuch"}, {"gc.nosuch", "-c"}},
           BadInput{{"linosc", "-d", "nosuch"}, {"nosuch.dat", "-d"}},
           BadInput{{"linosc", "-d", "nan"}, {"nan.dat"}},
           BadInput{{"linosc", "-s", "nosuch", "IRS=1"}, {"q.nosuch", "-s"}},
           BadInput{{"linosc", "-s", "branch"}, {"IRS="}},
           BadInput{{"linosc", "-s", "branch", "IRS=99"}, {"99", "1 (EP)"}},
           BadInput{{"linosc", "-s", "branch", "-d", "impacting", "IRS=1"}, {"-d", "-s"}},
           BadInput{{"linosc", "-s", "foreign", "IRS=1"}, {"q.foreign"}},
           BadInput{{"linosc", "-o", "nowhere/x"}, {"nowhere"}},
           BadInput{{"linosc", "-o", ""}, {"-o ''"}},
           BadInput{{"linosc", "-o", "."}, {"-o '.'"}},
           BadInput{{"linosc", "-o", "x/"}, {"-o 'x/'"}},
           BadInput{{"linosc", "-o", "taken"}, {"taken.events", "directory"}},
           BadInput{{"linosc", "--dat", "nowhere/x"}, {"nowhere"}},
           BadInput{{"linosc", "--dat", "taken"}, {"gc.taken", "directory"}},
           BadInput{{"linosc", "--dat", "x", "--free", "nosuch"}, {"--free", "alpha"}},
           BadInput{{"linosc", "--dat", "x", "--free", "99"}, {"--free"}},
           BadInput{{"linosc", "-c", "impacting", "-d", "impacting", "-o", "impacting", "--dat"},
                    {"impacting.dat", "--dat"}},
           BadInput{{"linosc", "-c", "impacting", "-o", "impacting", "--dat"}, {"gc.impacting", "--dat"}},
       }) {
    std::vector<std::string> words{"simulate"};
    words.insert(words.end(), bad.words.begin(), bad.words.end());
    std::string all;
    for (const std::string& word : words) all += " '" + word + "'";
    INFO("tchat" << all);
    check_refused(workspace.tchat(words), bad.expected);
  }
  CHECK_FALSE(workspace.has("linosc.events"));
}

TEST_CASE("simulate: a full disk is told, and what was there stays") {
  const Workspace workspace;
  REQUIRE(workspace.tchat("simulate linosc --events 3 -o o").status == 0);
  const std::string old = workspace.read("o.trajectory");
  const Outcome outcome = workspace.tchat_on_small_disk(64, "simulate linosc --events 100 -o o");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  CHECK(contains(outcome.err, "o.trajectory"));
  CHECK(workspace.read("o.trajectory") == old);
  CHECK_FALSE(workspace.has_unfinished());
}

TEST_CASE("a function without a value: the last state that it was asked for, and what to do") {
  const Workspace workspace;
  workspace.write(
      "root.tch",
      "par a=1\ninit x=1, v=-1\nx' = v\nv' = -a*sqrt(x)\nevent top = v\njump same: x -> x\nafter any: top -> same\n");
  for (const char* method : {"", " --stiff"}) {
    const Outcome outcome = workspace.tchat("simulate root" + std::string(method));
    INFO(outcome.text());
    CHECK(outcome.status == 1);
    const std::size_t at = outcome.err.find("no finite value at x = ");
    REQUIRE(at != std::string::npos);
    CHECK(std::stod(outcome.err.substr(at + 23)) < 0.0);  // the root of a negative number
    CHECK(contains(outcome.err, "v = -"));
    CHECK(contains(outcome.err, "event"));
  }
  workspace.write("gc.root", "NDIM = 2, IPS = 180, ICP = [a]\nGCFIND = [1], GCHIND = [1], GCGIND = [1]\n");
  workspace.write("root.dat", "# PAR(61) = 1\n0 -1 1\n1 -1 1\n");
  const Outcome run = workspace.tchat("run root");
  INFO(run.text());
  CHECK(run.status == 1);
  CHECK(contains(run.err, "x = -1"));
  CHECK(contains(run.err, "give the function a value there"));
}
