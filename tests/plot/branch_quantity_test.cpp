// What an axis shows: expressions, and states where segments end.
#include "plot/branch_quantity.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "plot/branch_figure.hpp"
#include "plot/column_expression.hpp"

using namespace tchat;

namespace {

template <class Function>
std::string message_of(Function function) {
  try {
    function();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Three points of an orbit with two impacts on a wall and a section between them.
BranchFile branch() {
  BranchFile file;
  file.path = "p.a";
  file.name = "a";
  PointSection section;
  section.problem_type = 180;
  section.dimension = 2;
  section.segments = 3;
  section.active_parameters = {2, 61, 62, 63};
  section.states = {{1, "x1"}, {2, "x2"}};
  section.parameters = {{1, "alpha"}, {2, "omega"}};
  section.events = {{1, "wall"}, {2, "maximum of x1"}};
  section.jumps = {{1, "impact"}, {2, "identity"}};
  section.signature = {{1, 1, 1}, {1, 2, 2}, {1, 1, 1}};
  section.columns = {"omega", "L2-NORM", "MAX x1", "MAX x2"};
  for (int k = 1; k <= 3; ++k) section.rows.push_back({1, -k, 0, k, {2.0 * k, -4.0, 0.5 * k, 3.0}});
  file.sections = {section};
  file.pieces = {{0, 0, 3}};
  file.types = {{"", "", ""}};
  file.admissible = {{true, true, true}};
  for (int k = 1; k <= 3; ++k) {
    SegmentEnds ends{Eigen::MatrixXd(2, 3), Eigen::MatrixXd(2, 3)};
    ends.first << 1.0, 1.0, 0.5, -0.8 * k, -1.6 * k, 0.0;
    ends.last << 1.0, 0.5, 1.0, k, 0.0, 2.0 * k;
    file.ends.push_back(ends);
  }
  file.solutions.resize(3);
  file.solution = {{0, 1, 2}};
  file.diagnostic = {{-1, 0, -1}};
  file.diagnostics.resize(1);
  file.parameters = {{{1, 8.0}, {2, 2.0}}};
  return file;
}

std::vector<double> values(const BranchFile& file, const std::string& wanted) {
  return read_quantity(file, 0, wanted, "-y").arms.at(0);
}

}  // namespace

TEST_CASE("expressions over columns and fixed parameters, by gnuplot") {
  const BranchFile file = branch();
  CHECK(values(file, "1/omega") == std::vector<double>{0.5, 0.25, 1.0 / 6.0});
  CHECK(values(file, "omega/2") == std::vector<double>{1.0, 2.0, 3.0});
  CHECK(values(file, "1/2*PAR(2)") == std::vector<double>{1.0, 2.0, 3.0});  // no division of integers
  CHECK(values(file, "L2-NORM**2 - alpha") == std::vector<double>{8.0, 8.0, 8.0});
  CHECK(values(file, "MAX x1 + max x2 - MAX x2") == values(file, "MAX x1"));
  CHECK(values(file, "omega > 3 ? 2e0*omega : -omega") == std::vector<double>{-2.0, 8.0, 12.0});
  CHECK(values(file, "sqrt(omega**2)")[2] == Approx(6.0));
  CHECK(std::isnan(values(file, "sqrt(L2-NORM)")[0]));
  CHECK(std::isnan(values(file, "1/(omega - 4)")[1]));
  CHECK(read_quantity(file, 0, "2*omega**2/(x2 - alpha)", "-y").label.text == "2·ω^{2}/(max x_{2}−α)");
}

TEST_CASE("states at events: an arm for each in a period, before and behind the jump") {
  const BranchFile file = branch();
  for (const char* name : {"x2@wall", "x2@impact", "U(2)@WALL"}) {
    const BranchQuantity quantity = read_quantity(file, 0, name, "-y");
    REQUIRE(quantity.arms.size() == 2);
    CHECK(quantity.arms[0] == std::vector<double>{1.0, 2.0, 3.0});
    CHECK(quantity.arms[1] == std::vector<double>{2.0, 4.0, 6.0});
    CHECK(contains(quantity.label.text, "x_{2} at "));
  }
  const BranchQuantity after = read_quantity(file, 0, "x2@after:wall", "-y");
  CHECK(after.arms[0] == std::vector<double>{-1.6, -3.2, -1.6 * 3});
  CHECK(after.arms[1] == std::vector<double>{-0.8, -1.6, -0.8 * 3});  // segment 1 follows the last
  CHECK(values(file, "x1@maximum of x1") == std::vector<double>{0.5, 0.5, 0.5});
  CHECK(values(file, "x2@3") == std::vector<double>{2.0, 4.0, 6.0});
  const BranchQuantity ratio = read_quantity(file, 0, "-x2@wall/omega", "-y");
  REQUIRE(ratio.arms.size() == 2);
  CHECK(ratio.arms[1] == std::vector<double>{-1.0, -1.0, -1.0});
  CHECK(read_quantity(file, 0, "x2@wall*x1@2", "-y").arms.size() == 2);
}

TEST_CASE("coefficients of normal forms are known where the d-file has one") {
  BranchFile file = branch();
  file.diagnostics[0].normal_form = NormalFormNote{"c", 0.5, 1e-9, "supercritical"};
  const BranchQuantity coefficient = read_quantity(file, 0, "coefficient", "-y");
  CHECK(coefficient.known == std::vector<bool>{false, true, false});
  CHECK(coefficient.arms[0][1] == 0.5);
  const BranchQuantity relative = read_quantity(file, 0, "uncertainty/coefficient", "-y");
  CHECK(relative.arms[0][1] == Approx(2e-9));
  CHECK_FALSE(relative.known[0]);
}

TEST_CASE("a branch of two impacts has two arms in the picture") {
  BranchFile file = branch();
  BranchFigureOptions options;
  options.y = "x2@wall";
  options.labels.all = true;
  file.types[0][1] = "PD";
  std::vector<std::string> warnings;
  const Figure figure = branch_figure({file}, options, &warnings);
  REQUIRE(figure.panels[0].curves.size() == 2);
  CHECK(figure.panels[0].curves[1].points.back().y == 6.0);
  CHECK(figure.panels[0].markers.size() == 2);
  CHECK(warnings.empty());

  file.solution[0][1] = -1;  // no label there: the line goes on to the next one
  const Figure gap = branch_figure({file}, options, &warnings);
  REQUIRE(gap.panels[0].curves.size() == 2);
  CHECK(gap.panels[0].curves[1].points.size() >= 2);
  CHECK(gap.panels[0].curves[1].points.back().y == 6.0);
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "1 of 2 points"));
  CHECK(contains(warnings[0], "NPR=1"));
}

TEST_CASE("what is no expression is refused in one sentence that names what there is") {
  BranchFile file = branch();
  const auto message = [&](const std::string& wanted) {
    return message_of([&] { read_quantity(file, 0, wanted, "-y"); });
  };
  CHECK(contains(message("1/omga"), "'omga'"));
  CHECK(contains(message("1/omga"), "omega, L2-NORM"));
  CHECK(contains(message("nosuch"), "'nosuch'"));
  CHECK(contains(message("1+1"), "no column"));
  CHECK(contains(message("(omega"), "does not understand"));
  CHECK(contains(message("sin(omega,2)"), "does not understand"));
  CHECK(contains(message("omega^2"), "x**2"));
  CHECK(contains(message("omega; system('touch made')"), "';'"));
  CHECK(contains(message("omega*`touch made`"), "'`'"));
  CHECK(contains(message("system(omega)"), "'system'"));
  CHECK(contains(message("x2@floor"), "wall, impact, maximum of x1, identity"));
  CHECK(contains(message("x2@4"), "1..3"));
  CHECK(contains(message("x3@wall"), "'x3'"));
  for (const char* wanted : {"1/omga", "(omega", "omega^2", "x2@floor"}) {
    CHECK(contains(message(wanted), "p.a: -y"));
    CHECK(message(wanted).find('\n') == std::string::npos);
  }
  file.solution[0].assign(3, -1);
  CHECK(contains(message("x2@wall"), "NPR=1"));
}
