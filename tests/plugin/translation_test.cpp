// The language's statements, by the C++ that they become; the C++ itself is compiled in compiled_formulas_test.cpp.
#include <catch2/catch.hpp>

#include "plugin/cpp_writer.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

std::string cpp_of(const std::string& text) { return translate_formulas(text, "folder/two-walls.tch").cpp; }

/// The part behind the first line, which does not differ.
const std::string end = "event e = x\n";

}  // namespace

TEST_CASE("statements of XPPAUT's form and of this one's are the same") {
  const std::string cpp = cpp_of("par a=1, b=2\ninit x=1\nx' = a*x^2 + b\n" + end);
  for (const char* text : {"par a=1 b=2\nx(0)=1\nx'=a*x**2+b\n", "param a=1; b=2\ninit x=1\ndx/dt=a*x^2+b\n",
                           "# a comment\r\npar a=1,b=2 # another\r\ninit x=1\r\n\r\nx' = a*x^2 \\\r\n   + b\r\n",
                           "\xEF\xBB\xBFparameters a=1, b=2\ninitial x = 1\nx' = a * x ^ 2 + b\n",
                           "par a=1\npar b=4/2\ninit x=1\nx' = a*x^2.0 + b\n"})
    CHECK(cpp_of(text + end) == cpp);
  CHECK(cpp_of("par a=1, b=2\ninit x=1\nx' = a*x^2 + b\n" + end + "done\nnothing that is read\n") == cpp);
}

TEST_CASE("numbers are doubles that are read back exactly, signs and products keep their order") {
  const std::string cpp =
      cpp_of("par a=1\nx' = 1/3*a - (2 - x) + 0.1*a^3 - -a/(x*a)\ny' = -(x+1)^2 - 1e22*x^-2\n" + end);
  CHECK_THAT(cpp, Contains("1.0 / 3.0 * a - (2.0 - x) + 0.1 * cube(a) - (-a / (x * a))"));
  CHECK_THAT(cpp, Contains("-square(x + 1.0) - 1e+22 * pow(x, -2.0)"));
}

TEST_CASE("definitions stand where they are used, in the order in which they need each other") {
  const std::string cpp = cpp_of("c = 2*b\nb = x + 1\nspare = x\nx' = c\n" + end);
  CHECK_THAT(cpp, Contains("const T b = x + 1.0;\n    const T c = 2.0 * b;\n    rate[0] = c;"));
  CHECK_THAT(cpp, !Contains("spare"));
}

TEST_CASE("names that are none in C++ get an underscore, those of the problem stay") {
  const std::string cpp = cpp_of("par new=1, NAN=2, T=3\nstate' = new*NAN*T\nevent class = state\n");
  CHECK_THAT(cpp, Contains("&state_ = state[0];") && Contains("const T &new_ = par[0], &NAN_ = par[1], &T_ = par[2]"));
  CHECK_THAT(cpp, Contains("parameter_names[] = {\"new\", \"NAN\", \"T\"}") && Contains("{\"class\"}"));
  CHECK_THAT(cpp, Contains("struct TwoWalls {"));
}

TEST_CASE("equations before the first field hold in every field that has none of its own") {
  const std::string cpp = cpp_of("x' = v\nfield slip: v' = -1\nfield stick\nv' = 0\n" + end);
  CHECK_THAT(
      cpp,
      Contains("if (index == 1) {  // slip\n      const T &v = state[1];\n      rate[0] = v;\n      rate[1] = -1.0;"));
  CHECK_THAT(cpp, Contains("// stick\n    const T &v = state[1];\n    rate[0] = v;\n    rate[1] = 0.0;"));
}

TEST_CASE("a jump identity is the last one unless there is one, and others keep their numbers") {
  CHECK_THAT(cpp_of("x' = 1\n" + end), Contains("jumps = 1;") && Contains("jump_names[] = {\"identity\"}"));
  CHECK_THAT(cpp_of("x' = 1\njump a: x = 0\njump b\nx -> 1\n" + end),
             Contains("jump_names[] = {\"a\", \"b\", \"identity\"}"));
  CHECK_THAT(cpp_of("x' = 1\njump identity\njump b: x -> 1\n" + end), Contains("{\"identity\", \"b\"}"));
}

TEST_CASE("sliding: fields and events behind all others, what follows by the sides of the surface") {
  const std::string cpp =
      translate_formulas(
          "par sliding=1\nv' = sliding\nfield up\nslide stuck on falls: lets_down -> down, "
          "lets_up -> up\nfield down\nevent falls = v\nevent rises = -v\n"
          "after any if stuck: stuck until lets_down -> identity, lets_up -> identity\n"
          "after falls if up: up until falls -> identity\nafter any: down until rises -> identity\n",
          "mine.tch")
          .cpp;
  CHECK_THAT(cpp, Contains("fields = 3, events = 4, jumps = 1;"));
  CHECK_THAT(cpp, Contains("{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3, .to_plus = 4}"));
  CHECK_THAT(cpp, Contains("field_names[] = {\"up\", \"down\", \"stuck\"}"));
  CHECK_THAT(cpp, Contains("event_names[] = {\"falls\", \"rises\", \"lets_down\", \"lets_up\"}"));
  CHECK_THAT(cpp, Contains("if (tchat::next_field(*this, sliding[0], from, state, par) == 3) return {{3, 3, 1}, {3, 4, "
                           "1}};"));
  CHECK_THAT(cpp, Contains("if (from[1] == 1 && tchat::next_field(*this, sliding[0], from, state, par) == 1) return "
                           "{{1, 1, 1}};"));
  CHECK_THAT(cpp, !Contains("&sliding = par[0]"));  // the user's name gives way to the member
}

TEST_CASE("what follows an event: names, conditions, the first line that holds") {
  const Translation translation = translate_formulas(
      "x' = 1\nfield slip\nfield stick\nevent wall = x\nevent rest = x - 1\njump hit: x -> 0\njump stop\n"
      "after start: stick until wall -> hit\nafter hit if x < 0 and not x > 3: slip until wall -> hit, rest -> stop\n"
      "after stick wall: slip until wall -> hit\nafter any: stick until rest -> identity\n",
      "mine.tch");
  CHECK(translation.has_successors);
  CHECK_THAT(translation.cpp, Contains("if (from[0] == 0) return {{2, 1, 1}};"));
  CHECK_THAT(translation.cpp, Contains("if (from[2] == 1) {\n      using T = double;\n      const T &x = state[0];\n"
                                       "      if (x < 0.0 && !(x > 3.0)) return {{1, 1, 1}, {1, 2, 2}};\n    }"));
  CHECK_THAT(translation.cpp, Contains("if (from[0] == 2 && from[1] == 1) return {{1, 1, 1}};"));
  CHECK_THAT(translation.cpp, Contains("return {{2, 2, 3}};\n  }"));
  CHECK_FALSE(translate_formulas("x' = 1\n" + end, "mine.tch").has_successors);
}
