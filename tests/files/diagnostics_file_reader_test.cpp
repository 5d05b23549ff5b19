// d-files: multipliers before or after their point, letters of types, the word inadmissible.
#include "files/diagnostics_file.hpp"

#include <catch2/catch.hpp>

using namespace tchat;

TEST_CASE("a d-file of this program") {
  const auto points = parse_diagnostics(
      "  BR    PT  IT     PARAMETER      RESIDUAL\n"
      "   2     1   1   3.03550E+00   6.37445E-10\n"
      "  BR    PT  TY  LAB       alpha       L2-NORM\n"
      "   2     1        0   3.03550E+00   1.87468E+00\n"
      " Multipliers:     Stable:   1\n"
      "   Multiplier   1  1.9100096656E-003  0.0000000000E+000   Abs. Val.  1.9100096656E-003\n"
      "   Multiplier   2 -6.9579946485E+008  2.0000000000E+000   Abs. Val.  6.9579946485E+008\n"
      "===============================================\n"
      "  BR    PT  TY  LAB       alpha       L2-NORM\n"
      "   2    -2  GR   42   3.03505E+00   1.86346E+00  inadmissible\n"
      "   2     2  NOTE: Inadmissible: segment 1\n"
      "===============================================\n"
      "end of run\n");
  REQUIRE(points.size() == 2);
  CHECK(points[0].label == 0);
  CHECK(points[0].type.empty());
  CHECK(points[0].admissible);
  REQUIRE(points[0].multipliers.size() == 2);
  CHECK(points[0].multipliers[1] == std::complex<double>(-6.9579946485e8, 2.0));
  CHECK(points[1].point == -2);
  CHECK(points[1].type == "GR");
  CHECK(points[1].label == 42);
  CHECK_FALSE(points[1].admissible);
  CHECK(points[1].multipliers.empty());
}

TEST_CASE("a block of AUTO has its multipliers before the point") {
  const auto points = parse_diagnostics(
      "===============================================\n"
      "  BR    PT  IT         PAR           L2-NORM\n"
      "   1     5   0    1.0E+00   2.0E+00\n"
      " Multipliers:     Stable:   2\n"
      "   1     5  NOTE:Multiplier inaccurate\n"
      "   1     5         Multiplier  1    5.00000E-01  2.50000E-01    Abs. Val.  5.59017E-01\n"
      "  BR    PT  TY  LAB    PAR(1)        L2-NORM\n"
      "   1    -5  PD    3   1.0E+00   2.0E+00\n"
      "===============================================\n");
  REQUIRE(points.size() == 1);
  CHECK(points[0].type == "PD");
  REQUIRE(points[0].multipliers.size() == 1);
  CHECK(points[0].multipliers[0] == std::complex<double>(0.5, 0.25));
}

TEST_CASE("the xi_n that vanish are read from the notes") {
  const auto points = parse_diagnostics(
      "  BR    PT  TY  LAB       omega\n"
      "   1    -2  XI    2   8.00522E-01\n"
      "   1     2  NOTE: codimension two: xi_2 = 0, xi_4 = 0\n"
      "   xi_1:                                          4.2219725705E+000\n"
      "===============================================\n"
      "  BR    PT  TY  LAB       omega\n"
      "   1    -3        0   8.10000E-01\n"
      "   1     3  NOTE: xi_x = 0, xi_7 = 0.5\n"
      "===============================================\n");
  REQUIRE(points.size() == 2);
  CHECK(points[0].xi_zeros == std::vector<int>{2, 4});
  CHECK(points[1].xi_zeros.empty());
}

TEST_CASE("a normal form is read from its note, whatever else that says") {
  const std::string heading = "  BR    PT  TY  LAB       p\n";
  const auto form_of = [&](const std::string& note) {
    return parse_diagnostics(
               heading + "   1     2  PD    2   8.0E-01\n   1     2  NOTE: period doubling\n   1     2  NOTE: " + note +
               "\n")
        .front()
        .normal_form;
  };
  for (const std::string& explanation : {std::string(), std::string(": stable orbits"), std::string("; another one")}) {
    const NormalFormNote written{"Re d", -1.25, 3e-11, "supercritical"};
    const auto form = form_of("lambda = 2; " + format_normal_form(written, explanation) + "; gradient: p 3");
    REQUIRE(form);
    CHECK(form->name == "Re d");
    CHECK(form->value == -1.25);
    CHECK(form->uncertainty == 3e-11);
    CHECK(form->verdict == "supercritical");
    CHECK_FALSE(form->is_subcritical());
  }
  CHECK(form_of(format_normal_form({"c", 1.0, 0.5, "subcritical pitchfork"}, ""))->is_subcritical());
  CHECK(form_of(format_normal_form({"a", 1.0, 0.5}, ""))->verdict.empty());
  CHECK(form_of("normal form a = 0.5 +- 1e-12; gradient: p 3")->uncertainty == 1e-12);
  CHECK_FALSE(form_of("no normal form: the end of segment 1 is tangent to its event surface"));
  CHECK_FALSE(form_of("normal form a = 0.5"));
  CHECK_FALSE(form_of("normal form a = x +- 2"));
}

TEST_CASE("where a special point may be missing is read back, whatever its text") {
  const std::string text =
      format_lost_point(1, 2, 3.14159265, -2e-7, "a multiplier goes from -0.79 to -1.1:\nthrough -1");
  CHECK(text.find('\n') == text.size() - 1);
  const auto points = parse_diagnostics("  BR    PT  TY  LAB      alpha\n   1     2        0  3.14E+00\n" + text);
  REQUIRE(points.size() == 1);
  REQUIRE(points.front().lost.size() == 1);
  CHECK(points.front().lost.front().from == Approx(3.1415927).epsilon(1e-8));
  CHECK(points.front().lost.front().to == -2e-7);
  CHECK(points.front().lost.front().text == "a multiplier goes from -0.79 to -1.1: through -1");
  CHECK(parse_diagnostics("   1     2  LOST a b: text\n").empty());
}
