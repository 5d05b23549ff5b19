// Malformed starting data, q-files and plugins.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

const std::string run = "run linosc -c impacting -o none ";

struct BadText {
  std::string text;
  std::vector<std::string> expected;
};

/// The oscillator's source with `old` replaced by `text`.
std::string variant(const Workspace& workspace, const std::string& old, const std::string& text) {
  std::string source = workspace.read("linosc.cpp");
  const auto at = source.find(old);
  REQUIRE(at != std::string::npos);
  return source.replace(at, old.size(), text);
}

}  // namespace

TEST_CASE("malformed starting data") {
  const Workspace workspace;
  const std::vector<BadText> table{
      {"", {"bad.dat", "2"}},
      {"# nothing but words\n", {"bad.dat", "2"}},
      {"0 1 2 3 4\n", {"bad.dat", "2"}},
      {"0 1 2 3\n1 1 2 3\n", {"bad.dat:1", "4 numbers", "5"}},
      {"0 1 2 3 4\n1 1 2 3 4 5\n", {"bad.dat:2", "6 numbers", "5"}},
      {"0 1 2 3 4\n0 1 2 3 4\n1 1 2 3 4\n", {"bad.dat:2", "repeats"}},
      {"0 1 2 3 4\n1 1 2 3 4\n0.5 1 2 3 4\n", {"bad.dat:3", "rise"}},
      {"0 1 2 3 4\n0.5 1 nan 3 4\n1 1 2 3 4\n", {"bad.dat:2", "'nan'"}},
      {"0 1 2 3 4\n0.5 1 inf 3 4\n1 1 2 3 4\n", {"bad.dat:2", "'inf'"}},
      {"0 1 2 3 4\n0.5 1 1e400 3 4\n1 1 2 3 4\n", {"bad.dat:2", "1e400"}},
      {"0 1 2 3 4\n0.5 1 two 3 4\n1 1 2 3 4\n", {"bad.dat:2", "'two'"}},
      {"# PAR(2) = fast\n0 1 2 3 4\n1 1 2 3 4\n", {"bad.dat:1", "PAR(2)", "'fast'"}},
      {"# PAR(0) = 1\n0 1 2 3 4\n1 1 2 3 4\n", {"bad.dat:1", "PAR(0)"}},
      {"# PAR(999) = 1\n0 1 2 3 4\n1 1 2 3 4\n", {"bad.dat:1", "PAR(999)"}},
      {"# PAR(speed) = 1\n0 1 2 3 4\n1 1 2 3 4\n", {"bad.dat", "speed", "omega"}},
      {"0 1 2 3 4 5 6 7 8\n1 1 2 3 4 5 6 7 8\n", {"bad.dat:1", "9 numbers", "2 segments"}},
      {std::string("\0\1\2\n", 4), {"bad.dat"}},
  };
  for (const BadText& bad : table) {
    INFO(bad.text);
    workspace.write("bad.dat", bad.text);
    check_refused(workspace.tchat(run + "-d bad"), bad.expected);
    CHECK_FALSE(workspace.has("p.none"));
  }
  check_refused(workspace.tchat("dat linosc -c impacting -d bad"), {"bad.dat"});
}

TEST_CASE("a word of a file does not reach the terminal as a command") {
  const Workspace workspace;
  workspace.write("bad.dat", "# PAR(\x1b[31mspeed) = 1\n0 1 2 3 4\n1 1 2 3 4\n");
  const Outcome result = workspace.tchat(run + "-d bad");
  CHECK(result.status == 2);
  CHECK(result.err.find("?[31mspeed") != std::string::npos);
  CHECK(result.err.find('\x1b') == std::string::npos);
}

TEST_CASE("malformed q-files") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o good NMX=2 NTST=10 NPR=0");
  const std::string good = workspace.read("q.good");
  const std::string first = good.substr(0, good.find('\n'));
  const auto with = [&](const std::string& line) { return line + good.substr(first.size()); };
  // Integer `k` (from 1) of the first line replaced.
  const auto with_integer = [&](std::size_t k, const std::string& value) {
    std::string line;
    auto words = words_of(first);
    words.at(k - 1) = value;
    for (const std::string& word : words) line += std::string(word.size() < 8 ? 8 - word.size() : 1, ' ') + word;
    return with(line);
  };
  const std::vector<BadText> table{
      {"", {"q.bad"}},
      {"these are words\n", {"q.bad:1"}},
      {"1 2 3\n", {"q.bad:1"}},
      {with_integer(4, "-3"), {"q.bad:1", "label"}},
      {with_integer(5, "-1"), {"q.bad:1", "NFPR"}},
      {with_integer(7, "0"), {"q.bad:1", "NTPL"}},
      {with_integer(7, "999999999"), {"q.bad:1", "NTPL"}},
      {with_integer(8, "1"), {"q.bad:1", "NAR"}},
      {with_integer(8, "2000000000"), {"q.bad:1"}},
      {with_integer(9, "0"), {"q.bad:1", "NROWPR"}},
      {with_integer(9, "5"), {"q.bad"}},
      {with_integer(10, "-10"), {"q.bad:1", "NTST"}},
      {with_integer(11, "5"), {"q.bad:1", "NCOL"}},
      {with_integer(12, "-5"), {"q.bad:1", "NPAR"}},
      {with_integer(13, "500"), {"q.bad:1", "NPARI"}},
      {with_integer(14, "3"), {"q.bad:1"}},
      {with_integer(3, "x"), {"q.bad:1"}},
      {with_integer(1, "1.5"), {"q.bad:1"}},
      {with_line(good, 2, "    zero 1 2 3 4"), {"q.bad:2", "zero"}},
      {with_line(good, 2, "    0.1 1 2 3 4"), {"q.bad", "t"}},
      {with_line(good, 3, "    0.5 1 2 3"), {"q.bad"}},
      {with_line(good, 3, "    nan 1 2 3 4"), {"q.bad:3", "nan"}},
  };
  for (const BadText& bad : table) {
    INFO(bad.text.substr(0, 120));
    workspace.write("q.bad", bad.text);
    check_refused(workspace.tchat(run + "-s bad IRS=1 NTST=10"), bad.expected);
    const Outcome labels = workspace.tchat("labels q.bad");
    CHECK(labels.signal == 0);
    CHECK((labels.status == 2 || bad.text.empty()));
    CHECK_FALSE(workspace.has("p.none"));
  }
}

TEST_CASE("a label that does not fit the constants") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o good NMX=2 NTST=10 NPR=0");
  check_refused(
      workspace.tchat({"run", "linosc", "-c", "impacting", "-s", "good", "IRS=1", "-o", "none", "GCNOSEG=2",
                       "GCSEGTYP=[1,1]", "GCFIND=[1,1]", "GCHIND=[1,1]", "GCGIND=[1,1]", "GCHGRZIND=[[1],[1]]"}),
      {"q.good", "label 1", "2 segments"});
}

TEST_CASE("labels of a problem whose parameters have other places now") {
  const Workspace workspace;
  const auto formulas = [](const std::string& parameters, const std::string& omega = "omega") {
    return "par " + parameters +
           "\ninit y2=1\ngrowth = 1 - y1^2 - y2^2\nx' = v\nv' = alpha*y2 - 0.1*v - x\n"
           "y1' = growth*y1 + " +
           omega + "*y2\ny2' = growth*y2 - " + omega + "*y1\nevent top = v\nafter any: top -> identity\n";
  };
  workspace.write("osc.tch", formulas("alpha=2, omega=2"));
  REQUIRE(workspace.tchat("simulate osc --dat s").status == 0);
  REQUIRE(workspace.tchat("run osc -c s -d s -o a ICP=[alpha] NMX=4").status == 0);
  workspace.write("osc.tch", formulas("alpha=2, m=1, omega=2"));
  for (const char* const command : {"run osc -c r.a -s a IRS=EP1 -o b", "simulate osc -s a IRS=EP1", "verify a",
                                    "resegment a EP1 --to double -o b"})
    check_refused(workspace.tchat(command),
                  {"q.a: PAR(2) was omega when the file was written, and is m in problem Osc"});
  workspace.write("osc.tch", formulas("alpha=2, frequency=2", "frequency"));
  check_refused(workspace.tchat("verify a"), {"PAR(2) was omega"});
  workspace.write("osc.tch", formulas("alpha=2, omega=2, m=1"));  // behind the others
  CHECK(workspace.tchat("verify a").status == 0);
}

TEST_CASE("plugins that are no plugins") {
  const Workspace workspace;
  std::ofstream(workspace.file("empty.so")).close();
  workspace.write("text.so", "this is no library\n");
  const std::string library = workspace.read("linosc.so");
  workspace.write("half.so", library.substr(0, library.size() / 3));
  std::filesystem::create_directory(workspace.file("folder.so"));
  for (const char* name : {"empty", "text", "half", "folder"}) {
    INFO(name);
    check_refused(workspace.tchat(run + "-d impacting -p " + name), {name});
  }
}

TEST_CASE("plugin sources that do not compile or compile to something else") {
  const Workspace workspace(Workspace::Plugin::source);
  const std::vector<BadText> table{
      {"int main( { return 0; }\n", {"bad.cpp:1: ", "All that the compiler says"}},
      {variant(workspace, "TCHAT_PROBLEM(LinearOscillator)", ""), {"bad", "TCHAT_PROBLEM"}},
      {variant(workspace, "fields = 1", "fields = 0"), {"bad.cpp", "vector field"}},
      {variant(workspace, "dimension = 4,", "dimension = 0,"), {"bad.cpp", "dimension"}},
      {variant(workspace, "#include <tchat/problem.hpp>", "#include <tchat/nosuch.hpp>"), {"bad.cpp", "nosuch.hpp"}},
      {"#include <tchat/problem.h>\nextern \"C\" __attribute__((visibility(\"default\"))) const tchat_problem* "
       "tchat_problem_table() { static tchat_problem "
       "table{}; table.abi_version = 99; table.struct_size = sizeof table; return &table; }\n",
       {"bad", "99"}},
      {"#include <tchat/problem.h>\nextern \"C\" __attribute__((visibility(\"default\"))) const tchat_problem* "
       "tchat_problem_table() { return nullptr; }\n",
       {"bad"}},
      {variant(workspace, "struct LinearOscillator {",
               "struct LinearOscillator {\n  LinearOscillator() { std::exit(0); }\n"),
       {"bad", "ended the process"}},
      {variant(workspace, "const T radius2", "if (x[0] < 0.0) std::exit(3);\n    const T radius2"),
       {"bad", "ended the process"}},
  };
  for (const BadText& bad : table) {
    INFO(bad.text.substr(0, 200));
    std::string text = bad.text;
    if (contains(text, "std::exit")) text = "#include <cstdlib>\n" + text;
    workspace.write("bad.cpp", text);
    std::filesystem::remove(workspace.file("bad.so"));
    check_refused(workspace.tchat(run + "-d impacting -p bad"), bad.expected);
    CHECK_FALSE(workspace.has("p.none"));
  }
}

TEST_CASE("files whose device fails while they are read: a sentence, status 1") {
  const Workspace workspace;
  // The first page of a process cannot be read: input/output error.
  for (const char* name : {"q.fails", "p.fails", "d.fails", "fails.so", "gc.fails", "fails.dat", "fails.trajectory",
                           "table", "source.cpp", "fortran.f", "p.output", "d.output", "r.fails"})
    std::filesystem::create_symlink("/proc/self/mem", workspace.file(name));
  for (const char* arguments : {"labels q.fails",
                                "orbit q.fails 1",
                                "plot p.fails -o a.png",
                                "plot --multipliers q.fails -o a.png",
                                "plot fails.trajectory -o a.png",
                                "plot table -o a.png",
                                "run linosc -c impacting -s fails IRS=1",
                                "run linosc -c impacting -d fails",
                                "run linosc -c fails -d impacting",
                                "run linosc -c impacting -d impacting -o output",
                                "run linosc -c impacting -d impacting -p fails.so",
                                "run linosc -c impacting -d impacting -p source",
                                "run linosc -c impacting -d impacting -p fortran",
                                "check fails",
                                "check source",
                                "check fortran",
                                "constants fails",
                                "dat linosc -c fails -d impacting",
                                "verify q.fails -p linosc",
                                "simulate linosc -d fails",
                                "resegment q.fails 1 --to rotate -o a -p linosc"}) {
    const Outcome outcome = workspace.tchat(arguments);
    INFO(arguments << "\n" << outcome.text());
    CHECK(outcome.status == 1);
    CHECK(outcome.err.find("internal error") == std::string::npos);
    CHECK(outcome.err.find("reading fails") != std::string::npos);
    CHECK(outcome.err.find("Input/output error") != std::string::npos);
  }
}
