#include "plot/label_text.hpp"

#include <catch2/catch.hpp>

#include "base/messages.hpp"

using namespace tchat;

TEST_CASE("names of columns become mathematics") {
  CHECK(mathematical_name("alpha").text == "α");
  CHECK(mathematical_name("omega").text == "ω");
  CHECK(mathematical_name("x1").text == "x_{1}");
  CHECK(mathematical_name("omega_d").text == "ω_{d}");
  CHECK(mathematical_name("MAX x12").text == "max x_{12}");
  CHECK(mathematical_name("L2-NORM").text == "L_2 norm");
  CHECK(mathematical_name("PAR(61)").text == "PAR(61)");
  CHECK(mathematical_name("velocity").text == "velocity");
  CHECK(mathematical_name("wall_gap").text == "wall\\_gap");
  CHECK(mathematical_name("a^b{c}").text == "a\\^b\\{c\\}");
}

TEST_CASE("texts of users stay as they are, and quotes end no string") {
  CHECK(plain_text("impacting_20072").text == "impacting_20072");
  CHECK_FALSE(plain_text("x_1").markup);
  CHECK(plain_text("two\nlines").text == "two lines");
  CHECK(gnuplot_quoted("`date` \"x\" \\n $1") == "'`date` \"x\" \\n $1'");
  CHECK(gnuplot_quoted("it's `a` \"x\" \\n $1") == R"("it\047s \140a\140 \042x\042 \134n \0441")");
  for (const char* text : {"two\nlines", "a\rb", "\x01", "tab\t", "\x7f"}) {
    CHECK_THROWS_AS(gnuplot_quoted(text), tchat::UserError);
    CHECK_THROWS_AS(refuse_control_characters(text, "-o"), tchat::UserError);
  }
  CHECK(joined(plain_text("PD_1: "), mathematical_name("alpha")).text == "PD\\_1: α");
}

TEST_CASE("widths of texts") {
  CHECK(text_width({"", false}) == 0.0);
  CHECK(text_width({"PDPD", false}) == Approx(2.0 * text_width({"PD", false})));
  CHECK(text_width({"x_{1}", true}) < text_width({"x1", false}));
  CHECK(text_width({"α", false}) == Approx(text_width({"a", false})));  // one character, two bytes
}

TEST_CASE("the xi_n that vanish, and numbers, as they are printed") {
  CHECK(xi_name({3}).text == "ξ_{3}");
  CHECK(xi_name({2, 4}).text == "ξ_{2,4}");
  CHECK(xi_name({1, 2}).text == "ξ_{1,2}");
  CHECK(xi_name({1, 2, 3, 4, 5}).text == "ξ_{1…5}");
  CHECK(xi_name({1, 2, 4}).text == "ξ_{1,2,4}");
  CHECK(xi_name({3}).markup);
  CHECK(number_text(-0.4938).text == "−0.4938");
  CHECK(number_text(2.5e-7).text == "2.5e−07");
  CHECK(number_text(3.0).text == "3");
  CHECK(text_height(xi_name({3})) > text_height(plain_text("XI")));
  CHECK(text_height(plain_text("a_b")) == text_height(plain_text("ab")));
}
