// Pages: JSON that nothing in a file can break out of, the digits of numbers, what is said where files are missing, and
// the command that restarts at a label.
#include "plot/page.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "plot/branch_figure.hpp"
#include "plot/page_branch.hpp"
#include "plot/page_figure.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::TemporaryFolder;

namespace {

std::string points_of_run(const std::string& name_of_state = "x") {
  std::string text =
      "   0   0.0 1.0 0.0 1.0\n   0   NDIM=   2   IPS = 180   ISP =   2\n   0   ISW =   1   NSEG=   1\n"
      "   0   unames = {1: '" +
      name_of_state +
      "'}\n   0   Active continuation parameters:  1 61\n   0\n   0    PT  TY  LAB             PAR(1)            "
      "L2-NORM\n";
  for (int point = 1; point <= 5; ++point)
    text += fmt::format("{:4}{:6}{:4}{:5}{:19.10E}{:19.10E}\n", 1, -point, point == 3 ? 7 : 0, point == 3 ? 2 : 0,
                        0.1234567891 * point, 1.0 / point);
  return text;
}

std::string page_of(const BranchFile& file, const PageBranchOptions& options = {}) {
  const Sheet sheet{{branch_figure({file}, {})}, 1, 1200, 900, {}, false};
  return page_html(lay_out(sheet), {{{{file}, {}}}, options, "run"});
}

std::string data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = page.find(begin) + begin.size();
  return page.substr(at, page.find("</script>", at) - at);
}

}  // namespace

TEST_CASE("no text closes the element that it is in") {
  CHECK(page_text("</script><b>&") == "\"\\u003c/script\\u003e\\u003cb\\u003e\\u0026\"");
  CHECK(page_text("<!--") == "\"\\u003c!--\"");
  CHECK(page_text("a\"b\\c\nd\x7f") == R"("a\"b\\c d ")");
}

TEST_CASE("letters of any script stay, bytes that are no UTF-8 do not") {
  CHECK(page_text("ξ₁ … 🙂") == "\"ξ₁ … 🙂\"");
  const std::string unknown = "\xEF\xBF\xBD";
  CHECK(page_text("a\xFF") == "\"a" + unknown + "\"");
  CHECK(page_text("\xC3") == "\"" + unknown + "\"");                              // cut off
  CHECK(page_text("\xC0\xBC") == "\"" + unknown + unknown + "\"");                // an overlong '<'
  CHECK(page_text("\xED\xA0\x80") == "\"" + unknown + unknown + unknown + "\"");  // a surrogate
}

TEST_CASE("numbers have all their digits, or as many as asked for, and what is not finite is null") {
  CHECK(page_number(3.0361935655) == "3.0361935655");
  CHECK(page_number(0.1) == "0.1");
  CHECK(page_number(1.0 / 3.0, 7) == "0.3333333");
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), -1e99}) {
    CHECK(page_number(value) == "null");
    CHECK(page_number(value, 7) == "null");
  }
}

TEST_CASE("a page holds the values of the points to the last digit, and its libraries") {
  const TemporaryFolder folder;
  const std::string page = page_of(read_branch_file(folder.write("p.a", points_of_run())));
  CHECK_THAT(data_of(page), Contains("[0.1234567891,0.2469135782,0.3703703673,0.4938271564,0.6172839455]"));
  CHECK_THAT(data_of(page), Contains("\"stability\":\"sssss\""));
  CHECK_THAT(page, Contains("Michael Bostock"));
  CHECK_THAT(page, Contains("d3.behavior.zoom"));
  CHECK_THAT(page, !Contains("http-equiv=\"refresh\"") && !Contains("src=\"http"));
  CHECK(page == page_of(read_branch_file(folder.file("p.a"))));
}

TEST_CASE("a name in a file is text in the page") {
  const TemporaryFolder folder;
  const BranchFile file = read_branch_file(folder.write("p.a", points_of_run("<script>alert(1)")));
  CHECK_THAT(data_of(page_of(file)), !Contains("<") && Contains("\\u003cscript\\u003ealert(1)"));
}

TEST_CASE("a page says which file it lacks") {
  const TemporaryFolder folder;
  const std::string data = data_of(page_of(read_branch_file(folder.write("p.a", points_of_run()))));
  CHECK_THAT(data, Contains("q.a is missing") && Contains("d.a is missing"));
}

TEST_CASE("points of a diagram know their rows, markers their points") {
  const TemporaryFolder folder;
  const Panel panel = branch_figure({read_branch_file(folder.write("p.a", points_of_run()))}, {}).panels.front();
  REQUIRE(panel.computed.size() == 5);
  CHECK(panel.computed[3].row == 3);
  CHECK(panel.computed[3].at == PicturePoint{0.4938271564, 0.25});
  REQUIRE(panel.markers.size() == 1);
  CHECK(panel.markers[0].computed == 2U);
}

TEST_CASE("a figure in space is no page") {
  Figure figure;
  figure.panels.emplace_back();
  figure.panels[0].z = AxisSettings{};
  figure.panels[0].curves.push_back({{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}, {}});
  const Sheet sheet{{figure}, 1, 1200, 900, {}, false};
  CHECK_THROWS_AS(page_html(lay_out(sheet), {{FigureFiles{}}, {}, "space"}), UserError);
}

TEST_CASE("the restart command names the problem of -p, of the run, or the only one in the folder") {
  const TemporaryFolder folder;
  folder.write("r.a", "");
  const BranchFile file = read_branch_file(folder.write("p.a", points_of_run()));
  const RestartCommand unknown = restart_command(file, "");
  CHECK_THAT(unknown.from("PD1"), Contains("tchat run PROBLEM -c " + folder.file("r.a") + " -s " + folder.file("a")));
  CHECK_THAT(unknown.from("PD1"), Contains(folder.file("a") + "_PD1 IRS=PD1"));
  CHECK_THAT(unknown.remark, Contains("-p PROBLEM"));

  folder.write("ball.tch", "");
  CHECK_THAT(restart_command(file, "").from("3"), Contains("tchat run ball -p " + folder.file("ball") + " -c "));
  CHECK(restart_command(file, "").remark.empty());
  folder.write("other.cpp", "");
  CHECK_THAT(restart_command(file, "").from("3"), Contains("run PROBLEM "));
  folder.write("a.cpp", "");
  CHECK_THAT(restart_command(file, "").from("3"), Contains("run a -p " + folder.file("a") + " "));
  CHECK_THAT(restart_command(file, "dir/it's.so").from("3"), Contains(R"(tchat run 'it'\''s' -p 'dir/it'\''s.so' -c)"));
}

TEST_CASE("without constants there is no restart command") {
  const TemporaryFolder folder;
  const RestartCommand none = restart_command(read_branch_file(folder.write("p.a", points_of_run())), "");
  CHECK_FALSE(none.exists());
  CHECK_THAT(none.remark, Contains("r.a"));
}
