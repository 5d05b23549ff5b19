// What the author of a problem reads when it does not compile: his file and line, one sentence, the cure.
#include <algorithm>
#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/messages.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

const std::string sizes = "  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;\n";

/// A problem whose field is `field`, line 5 of the source, with `members` on line 4.
std::string problem(const std::string& field, const std::string& members = "", const std::string& before = "") {
  return "#include <tchat/problem.hpp>\n" + before + "\nstruct Ball {\n" + members + "\n  template <class T> " + field +
         "\n" + (members.find("dimension") == std::string::npos ? sizes : "") +
         "  template <class T> T event(int, const T* x, const T*) const { return x[0]; }\n"
         "  template <class T> void jump(int, const T* x, const T*, T* g) const { g[0] = x[0]; g[1] = -x[1]; }\n"
         "};\nTCHAT_PROBLEM(Ball)\n";
}

std::string field(const std::string& body) {
  return "void field(int, const T* x, const T* par, T* f) const { f[0] = x[1]; " + body + " }";
}

/// The lines that the compiler's refusal is told in, without the last one, the command that shows all.
std::vector<std::string> told(const std::string& source) {
  const PluginFolder folder;
  folder.write("ball.cpp", source);
  std::vector<std::string> lines;
  try {
    resolve_plugin(folder / "ball", {"", TCHAT_TEST_INCLUDE});
  } catch (const UserError& error) {
    std::istringstream text(error.what());
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  REQUIRE(lines.size() >= 2);
  CHECK_THAT(lines.back(), Contains("All that the compiler says: c++ -std=c++20 -fsyntax-only"));
  lines.pop_back();
  return lines;
}

/// One mistake: its place and its sentence on the first line, the author's line on the second.
void check_told(const std::string& source, int line, const std::string& sentence) {
  const std::vector<std::string> lines = told(source);
  INFO(lines[0]);
  CHECK(lines.size() == 2);
  CHECK_THAT(lines[0], Contains("/ball.cpp:" + std::to_string(line) + ": ") && Contains(sentence));
}

}  // namespace

TEST_CASE("an output function of another form") {
  check_told(problem(field("f[1] = -par[0];"),
                     "  static constexpr int user_values = 1;"
                     " double user_value(int, const double* x, const double*) const { return x[0]; }"),
             4, "`user_value` must be: void user_value(const double* x, const double* par, double* out) const");
}

TEST_CASE("slips in formulas, each with its cure, in the order of their lines") {
  const std::vector<std::string> lines = told(problem(field(
      "f[0] = std::sin(x[0]);\n f[1] = std::max(x[1], 0.0);\n double a = x[0];\n f[1] = x[1] ^ 2;\n f[1] = f(0);")));
  const char* const cures[] = {"write sin(...), without std::", "write fmax(a, b)", "write T (or auto), not double",
                               "write pow(a, b)", "square brackets"};
  REQUIRE(lines.size() == 10);
  for (const char* cure : cures)
    CHECK(std::count_if(lines.begin(), lines.end(),
                        [&](const std::string& line) { return line.find(cure) != std::string::npos; }) == 1);
  for (int line = 5; line < 10; ++line)
    CHECK(std::count_if(lines.begin(), lines.end(), [&](const std::string& text) {
            return text.find("/ball.cpp:" + std::to_string(line) + ": ") != std::string::npos;
          }) == 1);
}

TEST_CASE("functions of plain numbers") {
  const std::vector<std::string> lines =
      told(problem(field("f[1] = cube(x[0]);\n f[1] = floor(x[0]);\n f[1] = sin(x);\n f[1] = sign(x[0]);"), "",
                   "double cube(double a) { return a * a * a; }"));
  const std::string text = lines[0] + lines[2] + lines[4] + lines[6];
  for (const char* cure :
       {"template <class T> T cube(const T& a)", "no derivative of floor", "an array is given", "there is no sign"})
    CHECK_THAT(text, Contains(cure));
}

TEST_CASE("members that are missing, private, or no templates", "[compiles]") {
  check_told(problem("void feld(int, const T*, const T*, T*) const {}"), 10,
             "`field` must be: template <class T> void");
  check_told(problem(field(""), "static constexpr int dimension = 2, parameters = 1, fields = 1, jumps = 1;"), 9,
             "static constexpr int `events` = ...;");
  check_told(problem(field(""), "static constexpr const char* state_names[] = {\"q\"};"), 4,
             "`state_names` needs as many entries as dimension says (1 found, 2 needed)");
  check_told(problem("int none = 0; void field(int, const double*, const double*, double*) const {}"), 5,
             "`field` must be: template <class T> void");
}

TEST_CASE("conditions of boundary value problems without their number, or numbers without them", "[compiles]") {
  const std::string boundary =
      "template <class T> void boundary(const tchat::Ends<T>&, const T*, T* b) const { b[0] = 0.0; }";
  const std::string integrand =
      "template <class T> void integrand(int, const T* x, const T*, T* q) const { q[0] = x[0]; }";
  const std::string number = "static constexpr int boundary_conditions = 1;";
  const auto says = [](const std::string& members, const std::string& sentence) {
    CAPTURE(members);
    const std::vector<std::string> lines = told(problem(field(""), members));
    INFO(lines[0]);
    CHECK(lines.size() == 2);
    CHECK_THAT(lines[0], Contains(sentence));
  };
  says(boundary, "static constexpr int `boundary_conditions` = ...;");
  says(number, "`boundary` must be: template <class T> void boundary(const tchat::Ends<T>& orbit");
  says(number + boundary + integrand, "static constexpr int `integral_conditions` = ...;");
  says(number + boundary + "static constexpr int integral_conditions = 1;",
       "`integrand` must be: template <class T> void integrand(int s");
  says(integrand + "static constexpr int integral_conditions = 1;", "`boundary_conditions` must be at least 1");
}

TEST_CASE("sliding modes of functions that are not there, or are the same", "[compiles]") {
  const auto says = [](const std::string& numbers, const std::string& sentence) {
    CAPTURE(numbers);
    const std::vector<std::string> lines =
        told(problem(field(""),
                     "static constexpr int dimension = 2, parameters = 1, fields = 3, events = 3, jumps = 1;"
                     "static constexpr tchat::Sliding sliding{" +
                         numbers + "};"));
    INFO(lines[0]);
    CHECK_THAT(lines[0], Contains(sentence) && Contains("ball.cpp:4: "));
  };
  says(".field = 4, .minus = 2, .plus = 1, .surface = 1, .to_minus = 2, .to_plus = 3",
       "`sliding`: field, minus and plus must be numbers from 1 to `fields`");
  says(".field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 2, .to_plus = 0",
       "`sliding`: surface, to_minus and to_plus must be numbers from 1 to `events`");
  says(".field = 3, .minus = 1, .plus = 1, .surface = 1, .to_minus = 2, .to_plus = 3",
       "`sliding`: field, minus and plus must be three different fields");
  says(".field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 2, .to_plus = 1",
       "`sliding`: surface, to_minus and to_plus must be three different event functions");
}

TEST_CASE("punctuation and the header", "[compiles]") {
  check_told(problem(field("f[1] = x[0]")), 5, "a ; is missing");
  check_told(problem(field("if (x[0] > 0) {")), 10, "a } is missing above: the { of line 3 is not closed");
  std::string no_header = problem(field(""));
  no_header.replace(0, no_header.find('\n'), "// nothing included");
  const std::vector<std::string> lines = told(no_header);
  CHECK_THAT(lines[0], Contains("ball.cpp:10: ") && Contains("#include <tchat/problem.hpp>"));
}

TEST_CASE("what once had to be avoided works: fmax, fmin, fmod, abs of a double") {
  const PluginFolder folder;
  folder.write("ball.cpp", problem(field("f[1] = fmax(x[0], par[0]) + fmin(1.0, x[1]) + fmod(x[0], 2) + abs(x[0]);")));
  CHECK_NOTHROW(resolve_plugin(folder / "ball", {"", TCHAT_TEST_INCLUDE}));
}
