#include "files/auto_format.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace tchat;

namespace {

std::string e26(double value) {
  std::string text;
  append_e26(text, value);
  return text;
}

}  // namespace

TEST_CASE("Nineteen columns, ten decimals, three exponent digits", "[output]") {
  CHECK(e19(1.2345678901) == "  1.2345678901E+000");
  CHECK(e19(-1.2345678901e-3) == " -1.2345678901E-003");
  CHECK(e19(0.0) == "  0.0000000000E+000");
  CHECK(e19(-0.0) == "  0.0000000000E+000");
  CHECK(e19(1e-100) == "  1.0000000000E-100");
  CHECK(e19(-1.7976931348623157e308) == " -1.7976931349E+308");
  CHECK(e19(5e-324) == "  0.0000000000E+000");
  // Ten decimals of the smallest normal number would be those of a subnormal one.
  CHECK(e19(-std::numeric_limits<double>::min()) == "  0.0000000000E+000");
  CHECK(std::stod(e19(2.2252e-308)) > 0.0);
  CHECK(e26(1.0 / 3.0) == "   3.3333333333333331E-001");
  CHECK(e26(-1e-100) == "  -1.0000000000000000E-100");
  CHECK(std::stod(e26(0.1 + 0.2)) == 0.1 + 0.2);
  CHECK(e19(9.99999999999) == "  1.0000000000E+001");
}

TEST_CASE("Values that are not finite are capped", "[output]") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(e19(infinity) == "  1.0000000000E+099");
  CHECK(e19(-infinity) == " -1.0000000000E+099");
  CHECK(e19(std::nan("")) == "  1.0000000000E+099");
}

TEST_CASE("ES format with Fortran's three-digit exponents", "[output]") {
  CHECK(es(0.1, 12, 4) == "  1.0000E-01");
  CHECK(es(-1.7976931348623157e308, 12, 4) == " -1.7976+308");
  CHECK(es(1e-7, 11, 4) == " 1.0000E-07");
  CHECK(es(-2.5e-120, 12, 4) == " -2.5000-120");
}

TEST_CASE("Integers never touch their neighbours", "[output]") {
  CHECK(integer_field(12, 5) == "   12");
  CHECK(integer_field(99999, 5) == " 99999");
  CHECK(integer_field(-123456, 6) == " -123456");
}

TEST_CASE("Point numbers wrap after 9999", "[output]") {
  CHECK(wrapped_point(1) == 1);
  CHECK(wrapped_point(9999) == 9999);
  CHECK(wrapped_point(10000) == 1);
  CHECK(wrapped_point(20000) == 2);
}

TEST_CASE("Headings fit their columns", "[output]") {
  CHECK(heading_field("alpha", 19) == "            alpha  ");
  CHECK(heading_field("a very long name of a parameter", 19) == "a very long name   ");
  CHECK(heading_field("a very long name of a parameter", 14) == "a very long   ");
  CHECK(heading_field("\xCE\xB1'\n", 14) == "         ___  ");
}
