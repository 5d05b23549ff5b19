// Expressions: precedence, associativity, numbers, functions; what is no expression.
#include <catch2/catch.hpp>
#include <cmath>

#include "plugin/expression.hpp"

using namespace tchat::formulas;

namespace {

double value_of(const std::string& text) {
  FormulaErrors errors;
  const auto statements = read_statements(text, errors);
  errors.throw_if_any("text", text);
  TokenReader in(statements.at(0));
  const Expression expression = parse_expression(in);
  in.expect_end();
  return constant_value(expression, "the value");
}

/// "column: message" of the mistake.
std::string mistake_in(const std::string& text) {
  try {
    value_of(text);
  } catch (const FormulaError& error) {
    return std::to_string(error.at.column) + ": " + error.message;
  } catch (const std::exception& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("operators bind as in mathematics, powers from the right") {
  const std::vector<std::pair<const char*, double>> cases = {
      {"1/2", 0.5},         {"7/2/2", 1.75},    {"2 - 3 - 4", -5.0},
      {"2 - (3 - 4)", 3.0}, {"2 + 3*4", 14.0},  {"(2 + 3)*4", 20.0},
      {"-2^2", -4.0},       {"(-2)^2", 4.0},    {"2^3^2", 512.0},
      {"(2^3)^2", 64.0},    {"2**3**2", 512.0}, {"2^-1", 0.5},
      {"2^-1^2", 0.5},      {"-2^-2", -0.25},   {"2^-1*4", 2.0},
      {"3*-2", -6.0},       {"- - 3", 3.0},     {"+3 - +2", 1.0},
      {"-3*-2^2", 12.0},    {"6/3*2", 4.0},     {"2*pi", 6.283185307179586},
      {"1/(1/3)", 3.0},
  };
  for (const auto& [text, value] : cases) {
    INFO(text);
    CHECK(value_of(text) == value);
  }
}

TEST_CASE("numbers in every form, Fortran's too") {
  const std::vector<std::pair<const char*, double>> cases = {
      {"12", 12.0},      {"1.5", 1.5},    {".5", 0.5},     {"2.", 2.0},    {"1e3", 1000.0},
      {"1E+3", 1000.0},  {"1e-3", 0.001}, {"1d-3", 1e-3},  {"1D3", 1e3},   {"2.5e-1", 0.25},
      {"1e-400*0", 0.0}, {"0.1", 0.1},    {"1.e2", 100.0}, {".5d+1", 5.0}, {"007", 7.0}};
  for (const auto& [text, value] : cases) {
    INFO(text);
    if (std::string(text) == "1e-400*0")
      CHECK(mistake_in(text).find("out of the range") != std::string::npos);
    else
      CHECK(value_of(text) == value);
  }
}

TEST_CASE("functions") {
  CHECK(value_of("sin(pi/6)") == Approx(0.5));
  CHECK(value_of("exp(log(3))") == Approx(3.0));
  CHECK(value_of("ln(exp(2))") == Approx(2.0));
  CHECK(value_of("atan2(1, -1)") == Approx(std::atan2(1.0, -1.0)));
  CHECK(value_of("max(1, 2) - min(1, 2)") == 1.0);
  CHECK(value_of("abs(-3) + sign(-3) + heav(-1) + heav(0)") == 3.0);
  CHECK(value_of("mod(-1, 3)") == 2.0);
  CHECK(value_of("flr(-0.5)") == -1.0);
  CHECK(value_of("pow(2, 10)") == 1024.0);
}

TEST_CASE("what is no expression is told with its column") {
  const auto told = [](const std::string& text, const std::string& column, const std::string& part) {
    INFO(text);
    const std::string mistake = mistake_in(text);
    CHECK_THAT(mistake, Catch::Matchers::StartsWith(column + ": ") && Catch::Matchers::Contains(part));
  };
  told("1 +", "4", "the end of the line");
  told("(1 + 2", "7", "opened in column 1");
  told("1 + 2)", "6", "')'");
  told("sin(1", "6", "opened in column 4");
  told("2 3", "3", "'3'");
  told("(1)(2)", "4", "*");
  told("1 * / 2", "5", "'/'");
  told("1 < 2 < 3", "7", "not chained");
  told("sin 1", "5", "sin(1)");
  told("1 = 2", "3", "'='");
  told("()", "2", "')'");
  told("sin()", "5", "')'");
  CHECK_THAT(mistake_in("2x"), Catch::Matchers::Contains("text:1:2: 'x' follows") && Catch::Matchers::Contains("2*x"));
  CHECK_THAT(mistake_in("1.2.3"), Catch::Matchers::Contains("text:1:4: '.' follows"));
  CHECK_THAT(mistake_in("1e999"), Catch::Matchers::Contains("out of the range"));
  CHECK_THAT(mistake_in("3 $ 4"), Catch::Matchers::Contains("text:1:3: the character '$'"));
}

TEST_CASE("what is nested too deep or too long is refused, not a stack overflow") {
  CHECK_THAT(mistake_in(std::string(100000, '(')), Catch::Matchers::Contains("nested"));
  CHECK_THAT(mistake_in(std::string(100000, '-') + "1"), Catch::Matchers::Contains("nested"));
  std::string chain = "1";
  for (int k = 0; k < 50000; ++k) chain += "^1";
  CHECK_THAT(mistake_in(chain), Catch::Matchers::Contains("nested"));
  std::string sum = "1";
  for (int k = 0; k < 50000; ++k) sum += "+1";
  CHECK_THAT(mistake_in(sum), Catch::Matchers::Contains("parts"));
  CHECK(value_of(sum.substr(0, 1801)) == 901.0);
}
