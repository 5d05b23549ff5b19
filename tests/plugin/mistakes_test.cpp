// What is wrong in a file of formulas is told with line, column and cure.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "plugin/cpp_writer.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// A sound problem in which one mistake is made.
const std::string sound = "par a=1, b=2\nx' = v\nv' = -a*x\nevent wall = 1 - x\njump impact: v -> -b*v\n";

std::string mistake_in(const std::string& text) {
  try {
    translate_formulas(text, "mine.tch");
  } catch (const UserError& error) {
    return error.what();
  }
  return "none";
}

/// One mistake, in line 6 of the sound problem and this line, at the column, with these words.
void check_mistake(const std::string& line, int column, const std::string& part) {
  INFO(line);
  const std::string mistake = mistake_in(sound + line + "\n");
  CHECK_THAT(mistake, StartsWith("mine.tch:6:" + std::to_string(column) + ": ") && Contains(part));
  CHECK(std::count(mistake.begin(), mistake.end(), '\n') <= 2);
}

}  // namespace

TEST_CASE("the sound problem is sound") { CHECK(mistake_in(sound) == "none"); }

TEST_CASE("the line is shown with a mark below the place") {
  CHECK(mistake_in(sound + "c = a +* b\n") ==
        "mine.tch:6:8: a number, a name or a parenthesis is expected here, not '*'\n    c = a +* b\n           ^");
}

TEST_CASE("names: unknown ones with what was meant, doubled ones, built-in ones") {
  check_mistake("c = aa*2", 5, "'aa' is not known (did you mean 'a'?)");
  check_mistake("c = alpha", 5, "'alpha' is not known; define it, as 'par NAME=VALUE'");
  check_mistake("c = sine(a)", 5, "did you mean 'sin'?");
  check_mistake("c = V", 5, "did you mean 'v'?");
  check_mistake("c = t", 5, "time does not appear");
  check_mistake("c = U(1)", 5, "by their names");
  check_mistake("c = if(x > 0)", 5, "a field of its own");
  check_mistake("a = 3", 1, "used twice, it is a parameter already (line 1)");
  check_mistake("par x=3", 5, "used twice, it is a state already (line 2)");
  check_mistake("x = 3", 1, "stands behind 'jump NAME:'");
  check_mistake("exp = 3", 1, "built in");
  check_mistake("pi = 3", 1, "built in");
  check_mistake("and = 3", 1, "word of the language");
  check_mistake("f(x, x) = 3", 6, "an argument twice");
  check_mistake("event wall = x", 7, "two events with the name 'wall'");
  check_mistake("jump wall", 6, "an event already");
  check_mistake("aux E = v, E = x", 12, "two values");
}

TEST_CASE("functions: their arguments, and names that are none") {
  check_mistake("c = sin(a, b)", 5, "has 1 argument, here are 2");
  check_mistake("c = max(a)", 5, "has 2 arguments, here are 1");
  check_mistake("c = a(b)", 5, "no function; write * between factors");
  check_mistake("c = sin", 5, "write its argument, as sin(...)");
  check_mistake("c = c + 1", 5, "defined by itself: c -> c");
  check_mistake("f(q) = f(q - 1)", 8, "defined by itself: f -> f");
}

TEST_CASE("states and equations") {
  CHECK_THAT(mistake_in("event wall = 1\n"), Contains("no equation"));
  CHECK_THAT(mistake_in(""), Contains("no equation"));
  check_mistake("init y=1", 6, "no equation for 'y'; write y' =");
  check_mistake("init a=1", 6, "'a' is a parameter, no state");
  check_mistake("init x=1, x=2", 11, "two starting values");
  check_mistake("init x=a", 8, "'a' cannot be used in it");
  check_mistake("par c=1/0", 7, "not a finite number");
  check_mistake("x' = 2", 1, "has an equation already, in line 2");
  check_mistake("jump other: y -> 1", 13, "no equation for 'y'");
  check_mistake("jump other: x -> 1, x -> 2", 21, "two values");
  const std::string fields = "x' = 1\nevent e = x\nfield slip\nu' = 1\nfield stick\n";
  CHECK_THAT(
      mistake_in(fields),
      StartsWith("mine.tch:5:7: the field stick has no equation for u; write one below it, as u' = 0, or above"));
  CHECK_THAT(mistake_in("x -> 3\n"), Contains("there is none above it"));
}

TEST_CASE("conditions stand behind 'if' only, and there nothing else") {
  check_mistake("c = a < b", 7, "a condition where a number is needed");
  check_mistake("c = 1 + (a < b)", 12, "a field of its own");
  check_mistake("after any if x: wall -> impact", 14, "a condition is needed");
  check_mistake("after any if x < 1 and v: wall -> impact", 24, "joins conditions");
}

TEST_CASE("what follows an event") {
  check_mistake("after any: wal -> impact", 12, "no event 'wal' (did you mean 'wall'?)");
  check_mistake("after any: wall -> impct", 20, "no jump 'impct' (did you mean 'impact'?)");
  check_mistake("after crash: wall -> impact", 7, "no field, event or jump 'crash'");
  check_mistake("after any wall: wall -> impact", 7, "stands alone");
  check_mistake("after wall wall: wall -> impact", 12, "one too many");
  check_mistake("after: wall -> impact", 6, "after what?");
  check_mistake("after any wall -> impact", 16, "':' is expected");
  check_mistake("after any: wall", 16, "behind an event comes its jump");
  check_mistake("after any: wall -> impact | wall -> impact", 27, "a comma and the next event");
  check_mistake("after start: wall -> impact", 1, "'after wall: ...' without 'if'");
  CHECK_THAT(mistake_in(sound + "after any if x < 0: wall -> impact\n"),
             Contains("what follows the start is not said") && Contains("what follows wall -> impact is not said"));
  const std::string fields = "x' = 1\nfield a\nfield b\nevent e = x\n";
  CHECK_THAT(mistake_in(fields + "after any: e -> identity\n"), Contains("which field is followed?"));
  CHECK_THAT(mistake_in(fields + "after any: c until e -> identity\n"), Contains("no field 'c'"));
}

TEST_CASE("sliding: fields and events that are not there, are made twice, or lie on one side only") {
  const std::string fields = "par V=1\nv' = 1\nfield up\nfield down\nevent falls = v - V\nevent rises = V - v\n";
  const auto says = [&](const std::string& lines, const std::string& place, const std::string& part) {
    INFO(lines);
    CHECK_THAT(mistake_in(fields + lines + "\n"), StartsWith("mine.tch:" + place + ": ") && Contains(part));
  };
  CHECK(mistake_in(fields + "slide stuck on falls: lets_down -> down, lets_up -> up\n") == "none");
  says("slide stuck on fall: lets_down -> down, lets_up -> up", "7:16", "no event 'fall' (did you mean 'falls'?)");
  says("slide stuck on falls: lets_down -> dwn, lets_up -> up", "7:36", "no field 'dwn' (did you mean 'down'?)");
  says("slide stuck on falls: lets_down -> up, lets_up -> up", "7:51", "on both sides of falls is the field up");
  says("slide stuck on falls: lets_down -> down", "7:40", "it is written 'slide NAME on EVENT: EVENT -> FIELD, EVENT");
  says("slide stuck on falls: falls -> down, lets_up -> up", "7:23", "two events with the name 'falls'");
  says("slide up on falls: lets_down -> down, lets_up -> up", "7:7", "two fields with the name 'up'");
  says("slide stuck on falls: lets_down -> down, lets_up -> up\nslide more on rises: a -> stuck, b -> down", "8:27",
       "'stuck' is made by a slide or contact statement");
  const std::string two =
      "slide stuck on falls: lets_down -> down, lets_up -> up\nslide held on rises: a -> up, b -> down\n";
  says(two + "after any if up: up until falls -> identity", "9:14", "the field up is a side of 2 surfaces");
  says("slide stuck on falls: lets_down -> down, lets_up -> up\nafter any: up until falls -> identity", "8:1",
       "no 'after' line leads to field");
}

TEST_CASE("functions that jump in value are refused where derivatives are taken, also behind definitions") {
  check_mistake("field own: v' = -sign(v)", 18, "sign(...) jumps in value");
  check_mistake("event other = heav(x) - 0.5", 15, "heav(...) jumps in value");
  CHECK_THAT(mistake_in("c = floor(x)\nx' = c\nevent e = x\n"), StartsWith("mine.tch:1:5: floor(...) jumps"));
  CHECK_THAT(mistake_in("f(q) = sign(q)\nx' = f(x)\nevent e = x\n"), StartsWith("mine.tch:1:8: sign(...) jumps"));
  for (const char* line : {"c = sign(a)\nfield own: v' = c", "jump other: v -> sign(v)", "aux s = sign(v)",
                           "f(q) = sign(q)\nfield own: v' = f(a)", "s = sign(v)"})
    CHECK(mistake_in(sound + line + "\n") == "none");
}

TEST_CASE("functions with a kink are allowed and remarked on") {
  const Translation translation = translate_formulas("x' = -abs(x)*x\nevent e = abs(x) - 1\n", "mine.tch");
  REQUIRE(translation.remarks.size() == 1);
  CHECK_THAT(translation.remarks[0], StartsWith("mine.tch:1:7: abs(...) has a kink"));
  CHECK(translate_formulas(sound, "mine.tch").remarks.empty());
}

TEST_CASE("words of other programs are told what is written instead") {
  check_mistake("global 1 {x} {v=-v}", 1, "event NAME = EXPRESSION");
  check_mistake("@ total=100", 1, "gc.NAME");
  check_mistake("wiener w", 1, "without noise");
  check_mistake("\" a comment", 1, "comments begin with #");
  check_mistake("!c=a", 1, "NAME = EXPRESSION");
  check_mistake("evnt other = x", 1, "did you mean 'event'?");
  check_mistake("\xCF\x89 = 3", 1, "the character '\xCF\x89'");
}

TEST_CASE("all mistakes are told, in the order of the lines, at most ten") {
  const std::string two = mistake_in("par a=1\nx' = b\ny' = c\nevent e = x\n");
  CHECK_THAT(two, Contains("mine.tch:2:6: 'b'") && Contains("\nmine.tch:3:6: 'c'"));
  std::string many;
  for (int k = 0; k < 12; ++k) many += "x" + std::to_string(k) + "' = (\n";
  CHECK_THAT(mistake_in(many), Contains("mine.tch:10:") && Contains("2 more mistakes") && !Contains("mine.tch:11:"));
}

TEST_CASE("hundreds of parameters are no mistake") {
  std::string text = "x' = p299\nevent e = x\npar p0=0";
  for (int k = 1; k < 300; ++k) text += ", p" + std::to_string(k) + "=0";
  CHECK(mistake_in(text) == "none");
  CHECK_THAT(mistake_in(text + ", p7=1"), Contains("p7"));
}

TEST_CASE("functions that double their work at every level are refused, definitions are not") {
  // f0 has 1 part and each further one 5 with its two calls: f(k) takes 6 * 2^k - 5 operations, 98299 for k = 14.
  const auto functions = [](int levels) {
    std::string text = "f0(y) = y\n";
    for (int k = 1; k <= levels; ++k) {
      const std::string before = "f" + std::to_string(k - 1) + "(y)";
      text += "f" + std::to_string(k) + "(y) = " + before + " + " + before + "\n";
    }
    return text + "x' = v\nv' = -f" + std::to_string(levels) + "(x)\n";
  };
  CHECK_NOTHROW(translate_formulas(functions(14), "mine.tch"));
  CHECK_THAT(
      mistake_in(functions(30)),
      StartsWith("mine.tch:16:1: a value of the function f15 takes 2e+05 operations") && Contains("NAME = EXPRESSION"));

  std::string definitions = "a0 = x\n";
  for (int k = 1; k <= 30; ++k) {
    const std::string before = "a" + std::to_string(k - 1);
    definitions += "a" + std::to_string(k) + " = " + before + " + " + before + "\n";
  }
  CHECK(translate_formulas(definitions + "x' = v\nv' = -a30\n", "mine.tch").cpp.size() < 10'000);
}
