// tchat plot through the binary: pictures that are there and of the right size, what the script says, refusals.
#include <stdlib.h>

#include <filesystem>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

/// A variable of the environment with another value, or none, for the programs that this one starts.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* const old = ::getenv(name)) before_ = old, there_ = true;
    value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Environment() { there_ ? ::setenv(name_, before_.c_str(), 1) : ::unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
  bool there_ = false;
};

/// Impacting orbits through the period doubling, at alpha = 3.03619, with labels and multipliers.
Workspace& impacting() {
  static Workspace workspace;
  static const bool made = [] {
    workspace.run("-c impacting -d impacting -o branch NMX=60 NTST=20 DS=-0.02 GRSTOP=0 -q");
    return true;
  }();
  static_cast<void>(made);
  return workspace;
}

unsigned big_endian(const std::string& bytes, std::size_t at) {
  unsigned value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = 256 * value + static_cast<unsigned char>(bytes.at(at + k));
  return value;
}

/// Width and height in a PNG's header.
std::pair<unsigned, unsigned> png_size(const std::string& bytes) {
  REQUIRE(bytes.size() > 1000);
  CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  return {big_endian(bytes, 16), big_endian(bytes, 20)};
}

std::string script_of(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("plot " + arguments + " -o picture.svg --script picture.gp");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return workspace.read("picture.gp");
}

}  // namespace

TEST_CASE("a branch as PNG of the size asked for, SVG and PDF") {
  const Workspace& workspace = impacting();
  CHECK(workspace.tchat("plot p.branch -o a.png").status == 0);
  CHECK(png_size(workspace.read("a.png")) == std::pair(1200U, 900U));
  CHECK(workspace.tchat("plot p.branch -o b.png --size 640x400").status == 0);
  CHECK(png_size(workspace.read("b.png")) == std::pair(640U, 400U));
  CHECK(workspace.tchat("plot p.branch -o c.svg").status == 0);
  CHECK(contains(workspace.read("c.svg"), "<svg"));
  CHECK(workspace.tchat("plot p.branch -o d.pdf").status == 0);
  CHECK(workspace.read("d.pdf").substr(0, 5) == "%PDF-");
}

TEST_CASE("equal commands make equal files") {
  const Workspace& workspace = impacting();
  for (const std::string name : {"same.png", "same.svg", "same.pdf"}) {
    CHECK(workspace.tchat("plot p.branch -o " + name + " --script same.gp").status == 0);
    const std::string picture = workspace.read(name), script = workspace.read("same.gp");
    CHECK(workspace.tchat("plot p.branch -o " + name + " --script same.gp").status == 0);
    CHECK(workspace.read(name) == picture);
    CHECK(workspace.read("same.gp") == script);
  }
}

TEST_CASE("the script of a branch: names on the axes, solid and dashed, letters of points") {
  const Workspace& workspace = impacting();
  const std::string script = script_of(workspace, "p.branch");
  CHECK(contains(script, "set xlabel 'α'"));
  CHECK(contains(script, "set ylabel 'L_2 norm'"));
  CHECK(contains(script, "dt solid"));
  CHECK(contains(script, "dt (14,8)"));
  CHECK(contains(script, "set label 'PD'"));
  CHECK(contains(script, "set label 'GR'"));
  CHECK_FALSE(contains(script, "set label 'EP'"));
  CHECK(contains(script, "set label 'stable'"));
  CHECK(contains(script, "set label 'unstable'"));
  CHECK(contains(script, "set label 'inadmissible'"));
  CHECK(contains(script_of(workspace, "p.branch --labels EP --numbers"), "set label 'EP 1'"));
  for (const std::string letters : {"PD", "GR", "LP"})
    CHECK_FALSE(contains(script_of(workspace, "p.branch --no-labels"), "set label '" + letters + "'"));
}

TEST_CASE("a kept script draws the picture again") {
  const Workspace& workspace = impacting();
  REQUIRE(workspace.tchat("plot p.branch -o again.png --script again.gp").status == 0);
  const std::string picture = workspace.read("again.png");
  std::filesystem::remove(workspace.file("again.png"));
  const Outcome outcome = Process({"/bin/sh", "-c", "gnuplot again.gp"}, workspace.file(""), workspace.file("log"))
                              .wait(std::chrono::seconds(60));
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(workspace.read("again.png") == picture);
}

TEST_CASE("taste: columns, ranges, texts, logarithmic axes") {
  const Workspace& workspace = impacting();
  const Outcome outcome = workspace.tchat({"plot", "p.branch", "-y", "MAX x2", "--xrange", "3:3.1", "--yrange", ":5",
                                           "--title", "it's `date`", "--xlabel", "forcing_1", "--legend", "one branch",
                                           "--logy", "-o", "taste.png", "--script", "taste.gp"});
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string script = workspace.read("taste.gp");
  CHECK(contains(script, "set xrange [3:3.1]"));
  CHECK(contains(script, ":5]"));
  CHECK(contains(script, "set logscale y"));
  CHECK(contains(script, R"("it\047s \140date\140" noenhanced)"));
  CHECK(contains(script, "set xlabel 'forcing_1' noenhanced"));
  CHECK(contains(script, "set ylabel 'max x_{2}'"));
  CHECK(contains(script, "set label 'one branch'"));
}

TEST_CASE("orbits: names and wall from the plugin, jumps thin, unstable ones dashed") {
  const Workspace& workspace = impacting();
  const std::string portrait = script_of(workspace, "q.branch PD1 EP1 -p linosc");
  CHECK(contains(portrait, "set xlabel 'x_{1}'"));
  CHECK(contains(portrait, "set ylabel 'x_{2}'"));
  CHECK(contains(portrait, "set label 'wall'"));
  CHECK(contains(portrait, "PD1: α = 3.0362"));
  CHECK(contains(portrait, "dt solid lw 1.3"));
  CHECK_FALSE(contains(script_of(workspace, "q.branch PD1 -p linosc --surfaces none"), "wall"));
  const std::string unstable = script_of(workspace, "q.branch PD1 GR1");
  CHECK(contains(unstable, "unstable"));
  CHECK(contains(unstable, "dt (14,8) lw 1.88 lc rgb '#0060a8'"));
  CHECK_FALSE(contains(portrait, "dt (14,8)"));
  const std::string space = script_of(workspace, "q.branch PD1 -x x1 -y x2 -z y1 -p linosc --view 50,120");
  CHECK(contains(space, "splot $curve1_1"));
  CHECK(contains(space, "set zlabel 'y_{1}'"));
  CHECK(contains(space, "set view 50,120"));
  CHECK(contains(space, "set label 'wall'"));
  const std::string series = script_of(workspace, "--time q.branch PD1 -y x1,y1,y2 -p linosc");
  CHECK(contains(series, "set multiplot"));
  CHECK(contains(series, "set xlabel 'time'"));
  CHECK(contains(series, "set ylabel 'y_{2}'"));
  CHECK(contains(series, "set label 'wall'"));
}

TEST_CASE("expressions and states at events: values of the orbits in the script, the velocity of impact too") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o all NMX=8 NTST=20 DS=-0.02 NPR=1 -q");
  const std::string script = script_of(workspace, "p.all -x alpha/omega -y x2@wall");
  CHECK(contains(script, "set xlabel 'α/ω'"));
  CHECK(contains(script, "set ylabel 'x_{2} at wall'"));
  const std::string block = script.substr(script.find("$curve1_1 << END\n") + 17);
  const SolutionEntry first = workspace.solutions("all").front();
  const std::vector<std::string> words = words_of(block.substr(0, block.find('\n')));
  REQUIRE(words.size() == 2);
  CHECK(std::stod(words[0]) == Approx(first.parameter(1) / first.parameter(2)).epsilon(1e-9));
  CHECK(std::stod(words[1]) == Approx(first.states.back().at(1)).epsilon(1e-9));
  // The impact law, which brings the orbit back: r times as fast away from the wall.
  const std::string law = script_of(workspace, "p.all -y 0-x2@after:impact/r");
  CHECK(law.substr(law.find("$curve1_1"), 2000).find("nan") == std::string::npos);
  const std::string same = law.substr(law.find("$curve1_1 << END\n") + 17);
  CHECK(std::stod(words_of(same.substr(0, same.find('\n'))).at(1)) == Approx(std::stod(words[1])).epsilon(1e-6));
}

TEST_CASE("orbits without -p: names from the run, no plugin is compiled or loaded") {
  const Workspace& workspace = impacting();
  workspace.write("branch.cpp", "#error this is compiled\n");
  workspace.write("branch.f", "      this is compiled\n");
  const std::string portrait = script_of(workspace, "q.branch PD1");  // the folder's only plugin is linosc.so
  CHECK(contains(portrait, "set xlabel 'x_{1}'"));
  CHECK(contains(portrait, "PD1: α = 3.0362"));
  CHECK_FALSE(contains(portrait, "wall"));
  CHECK_FALSE(contains(script_of(workspace, "--time q.branch PD1 -y x1"), "wall"));
  workspace.write("branch.cpp",
                  "#include <stdio.h>\nstatic FILE* ran = fopen(\"ran\", \"w\");\n"
                  "extern \"C\" void* tchat_problem_table() { return ran; }\n");
  script_of(workspace, "q.branch PD1");
  CHECK_FALSE(workspace.has("ran"));
  CHECK_FALSE(workspace.has("branch.so"));
  for (const char* name : {"branch.cpp", "branch.f"}) std::filesystem::remove(workspace.file(name));
}

TEST_CASE("after a q-file a label is a label, whatever files there are") {
  const Workspace& workspace = impacting();
  workspace.write("q.PD1", "another file");
  workspace.write("PD1", "one more");
  CHECK(contains(script_of(workspace, "q.branch PD1 EP1 -p linosc"), "PD1: α = 3.0362"));
  std::filesystem::remove(workspace.file("q.PD1"));
  std::filesystem::remove(workspace.file("PD1"));
}

TEST_CASE("multipliers along the branch and at labels") {
  const Workspace& workspace = impacting();
  const std::string all = script_of(workspace, "--multipliers q.branch");
  CHECK(contains(all, "real part"));
  CHECK(contains(all, "set label 'PD'"));
  CHECK(contains(script_of(workspace, "--multipliers p.branch PD1 EP1"), "set label 'EP1'"));
}

TEST_CASE("without -o and without a display the picture has the branch's name") {
  const Workspace& workspace = impacting();
  const Environment no_display("DISPLAY", nullptr), no_wayland("WAYLAND_DISPLAY", nullptr);
  const Outcome outcome = workspace.tchat("plot branch");
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "branch.png"));
  CHECK(png_size(workspace.read("branch.png")) == std::pair(1200U, 900U));
}

TEST_CASE("without gnuplot the message says how to get it") {
  const Workspace& workspace = impacting();
  const Environment no_path("PATH", "/nowhere");
  check_refused(workspace.tchat("plot p.branch -o none.png"), {"gnuplot", "apt install gnuplot-nox"});
  CHECK_FALSE(workspace.has("none.png"));
}

TEST_CASE("a table of numbers lies as dots beneath a branch") {
  const Workspace& workspace = impacting();
  workspace.write("brute.txt", "# alpha v\n2.9 0.125\n3.25 0.5\n");
  const Outcome outcome =
      workspace.tchat("plot p.branch brute.txt --legend branch --legend dots --script s.gp -o d.png");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(workspace.has("d.png"));
  const std::string script = workspace.read("s.gp");
  CHECK(contains(script, "$cloud1_1 << END\n2.9 0.125 0\n3.25 0.5 0\nEND\n"));
  CHECK(contains(script, "plot $cloud1_1 with points "));
  CHECK(contains(script, "dots"));
}

TEST_CASE("texts are drawn as they are written, whatever characters they have") {
  const Workspace& workspace = impacting();
  const std::vector<std::string> texts{"x''",    "'quoted'", "'",         "''",     "it's",
                                       "a\\nb'", "{}^_@~",   "`touch y`", "'`id`'", "\"two\" $HOME",
                                       "@term",  "a#b' ; c", "%d '%s'",   "\\"};
  for (const std::string& text : texts) {
    const Outcome outcome =
        workspace.tchat({"plot", "p.branch", "--title", text, "--xlabel", text, "--legend", text, "-o", "text.svg"});
    INFO(text << '\n' << outcome.text());
    CHECK(outcome.status == 0);
    std::string drawn = workspace.read("text.svg"), expected = text;
    for (auto at = drawn.find("&quot;"); at != std::string::npos; at = drawn.find("&quot;")) drawn.replace(at, 6, "\"");
    for (auto at = drawn.find("&#39;"); at != std::string::npos; at = drawn.find("&#39;")) drawn.replace(at, 5, "'");
    CHECK(contains(drawn, '>' + expected + "</"));
    CHECK_FALSE(workspace.has("y"));
  }
}

TEST_CASE("a name with a line break or a pipe is no command") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NMX=3 NTST=20 -q");
  for (const std::string command : {"system \"touch made\"", "!touch made"}) {
    const std::string name = "a\n" + command + "\n#";
    workspace.write("p." + name, workspace.read("p.branch"));
    workspace.write("q." + name, workspace.read("q.branch"));
    INFO(command);
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"plot", "p." + name},
                                               {"plot", "p." + name, "-o", "a.svg"},
                                               {"plot", "q." + name, "EP1"},
                                               {"plot", "p.branch", "-o", "a'\n" + command + "\n#.svg"},
                                               {"plot", "--multipliers", "q." + name}}) {
      check_refused(workspace.tchat(words), {"line break"});
      CHECK_FALSE(workspace.has("made"));
    }
  }
  CHECK(workspace.tchat({"plot", "p.branch", "-o", "|touch made;.svg", "--script", "pipe.gp"}).status == 0);
  CHECK(workspace.has("|touch made;.svg"));
  Process({"/bin/sh", "-c", "gnuplot pipe.gp"}, workspace.file(""), workspace.file("log"))
      .wait(std::chrono::seconds(60));
  CHECK_FALSE(workspace.has("made"));
}

TEST_CASE("no initialisation file of gnuplot changes a picture") {
  const Workspace& workspace = impacting();
  REQUIRE(workspace.tchat("plot p.branch -o plain.svg").status == 0);
  std::filesystem::create_directories(workspace.file("config/gnuplot"));
  workspace.write(".gnuplot", "set label 99 'intruder' at screen 0.5,0.5\nset grid\n");
  workspace.write("config/gnuplot/gnuplotrc", "set label 99 'intruder' at screen 0.5,0.5\n");
  const std::string home = workspace.file(""), config = workspace.file("config");
  const Environment other_home("HOME", home.c_str()), other_config("XDG_CONFIG_HOME", config.c_str());
  REQUIRE(workspace.tchat("plot p.branch -o other.svg").status == 0);
  CHECK(workspace.read("other.svg") == workspace.read("plain.svg"));
}

TEST_CASE("ranges that gnuplot cannot draw are refused, all others drawn") {
  const Workspace& workspace = impacting();
  for (const std::string range :
       {"-1e308:1e308", "-1e90:1e90", "1:1e300", "1:1.0000000001", "1e16:1.000000000001e16"}) {
    INFO(range);
    for (const std::string axis : {"--xrange=", "--yrange="})
      check_refused(workspace.tchat("plot p.branch -o range.svg " + axis + range), {"range", "drawn"});
    check_refused(workspace.tchat("plot p.branch -o range.svg --logx --xrange=" + range), {"range"});
  }
  for (const std::string range : {"-1e89:1e89", "3:3.000001", "3.2:", ":2.9", "0:1e-300", "-1e-310:1e-310"}) {
    const Outcome outcome = workspace.tchat("plot p.branch -o range.svg --xrange=" + range);
    INFO(range << '\n' << outcome.text());
    CHECK(outcome.status == 0);
  }
}

TEST_CASE("bad usage of plot is refused with what there is") {
  const Workspace& workspace = impacting();
  workspace.write("p.broken", "   1  1  9  1  1.0\n   1  2  0  0  1.0 2.0\n");
  workspace.write("words", "alpha beta\n");
  workspace.write("table", "# alpha v\n2.9 0.1\nbroken\n");
  struct Bad {
    std::string arguments;
    std::vector<std::string> expected;
  };
  for (const Bad& bad : {Bad{"p.branch -y nosuch", {"'nosuch'", "alpha, L2-NORM, MAX x1", "1.."}},
                         Bad{"nosuch", {"'nosuch'", "p.nosuch"}},
                         Bad{"p.branch -y 1/omga", {"'1/omga'", "'omga'", "alpha, L2-NORM"}},
                         Bad{"p.branch -y (alpha", {"'(alpha'", "does not understand"}},
                         Bad{"p.branch -y x1@floor", {"'floor'", "wall, impact", "1..1"}},
                         Bad{"p.branch -z y1", {"-z", "q-file"}},
                         Bad{"--time q.branch PD1 -z y1", {"-z", "--time"}},
                         Bad{"q.branch PD1 -z nosuch", {"-z", "x1, x2, y1, y2"}},
                         Bad{"q.branch PD1 -z y1 --view 5", {"--view", "65,35"}},
                         Bad{"p.branch PD1", {"q.branch PD1"}},
                         Bad{"q.branch", {"which orbits", "(PD)"}},
                         Bad{"q.branch PD9", {"PD9", "(EP)"}},
                         Bad{"q.branch PD1 p.branch", {"p.branch", "q-file"}},
                         Bad{"q.branch PD1 -x z", {"'z'", "x1, x2, y1, y2"}},
                         Bad{"q.branch PD1 -y x1,x2", {"--time"}},
                         Bad{"q.branch PD1 -p nosuch", {"nosuch.cpp"}},
                         Bad{"q.branch PD1 -p linosc --surfaces 9", {"1..3"}},
                         Bad{"q.branch PD1 --surfaces wall", {"'wall'"}},
                         Bad{"--time p.branch", {"q-file"}},
                         Bad{"d.branch", {"--multipliers"}},
                         Bad{"--multipliers d.branch 99", {"99", "(PD)"}},
                         Bad{"p.branch -o x.jpg", {".png, .svg, .pdf or .html"}},
                         Bad{"p.branch -o nowhere/x.png", {"nowhere/x.png"}},
                         Bad{"p.branch -o nowhere/x.html", {"nowhere/x.html"}},
                         Bad{"p.branch -o x.html --script x.gp", {"--script", "FILE.png"}},
                         Bad{"q.branch PD1 -x x1 -y x2 -z y1 -o x.html", {"-z", "FILE.png"}},
                         Bad{"p.branch --xrange 3", {"--xrange", "colon"}},
                         Bad{"p.branch --xrange 3:x", {"'x'"}},
                         Bad{"p.branch --yrange 3:2", {"--yrange", "smaller"}},
                         Bad{"p.branch --size 10", {"1200x900"}},
                         Bad{"p.branch --size 10x99999", {"10000"}},
                         Bad{"p.branch --labels LP,ZZ", {"'ZZ'", "GR, BE, XI"}},
                         Bad{"p.branch --legend a --legend b", {"2 times"}},
                         Bad{"p.branch --logx --xrange=-1:2", {"positive"}},
                         Bad{"p.broken", {"p.broken:2"}},
                         Bad{"words", {"words:1"}},
                         Bad{"p.branch table", {"table:3", "'broken'"}},
                         Bad{"", {"--help"}},
                         Bad{"p.branch --nosuch", {"--help"}}}) {
    INFO("tchat plot " << bad.arguments);
    check_refused(workspace.tchat("plot " + bad.arguments + (contains(bad.arguments, "-o") ? "" : " -o bad.png")),
                  bad.expected);
    CHECK_FALSE(workspace.has("bad.png"));
  }
}
