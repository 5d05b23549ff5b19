// What a diagram shows: styles from signs, types and the files beside a p-file; columns by name.
#include "plot/branch_figure.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <set>

#include "base/messages.hpp"
#include "plot/branch_quantity.hpp"
#include "plot/figure.hpp"
#include "plot/layout.hpp"
#include "plot/underlay.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;
using test_support::TemporaryFolder;

namespace {

struct Row {
  int point, type, label;
  double x, norm, omega;
};

std::string header(int ips, int isw, int curve_type = 0, const char* active = "1 2 61") {
  std::string text = fmt::format(
      "   0   0.0 1.0 0.0 1.0\n   0   NDIM=   2   IPS = {}   ISP =   2\n   0   ISW ={:4}   NSEG=   1\n"
      "   0   parnames = {{1: 'alpha', 2: 'omega', 3: 'r'}}\n   0   Active continuation parameters:  {}\n",
      ips, isw, active);
  if (curve_type != 0) text += fmt::format("   0   Branch type: {}  TY = 'LP'\n", curve_type);
  return text +
         "   0\n   0    PT  TY  LAB             alpha            L2-NORM              omega             MAX x1\n";
}

std::string rows(const std::vector<Row>& list) {
  std::string text;
  for (const Row& r : list)
    text += fmt::format("{:4}{:6}{:4}{:5}{:19.10E}{:19.10E}{:19.10E}{:19.10E}\n", 1, r.point, r.type, r.label, r.x,
                        r.norm, r.omega, 2.0 * r.norm);
  return text;
}

/// One point of a d-file.
std::string diagnostics(int point, const char* type, int label, double x, bool admissible) {
  return fmt::format("  BR    PT  TY  LAB       alpha\n{:4}{:6}{:>4}{:5}{:14.5E}{}\n{}\n", 1, point, type, label, x,
                     admissible ? "" : "  inadmissible", std::string(47, '='));
}

const std::vector<Row> branch = {{1, 9, 1, 0.0, 1.0, 2.0},  {2, 0, 0, 0.1, 1.1, 2.0},   {3, 7, 2, 0.2, 1.2, 2.0},
                                 {-4, 0, 0, 0.3, 1.3, 2.0}, {-5, -4, 3, 0.4, 1.4, 2.0}, {-6, 9, 4, 0.5, 1.5, 2.0}};

std::vector<const Curve*> with_dash(const Figure& figure, Dash dash) {
  std::vector<const Curve*> found;
  for (const Curve& curve : figure.panels[0].curves)
    if (curve.stroke.dash == dash) found.push_back(&curve);
  return found;
}

std::vector<std::string> labels_of(const Figure& figure) {
  std::vector<std::string> labels;
  for (const Marker& marker : figure.panels[0].markers) labels.push_back(marker.label.text);
  return labels;
}

}  // namespace

TEST_CASE("stable solid, unstable dashed, the change at the located point") {
  const TemporaryFolder folder;
  const BranchFile file = read_branch_file(folder.write("p.a", header(180, 1) + rows(branch)));
  const Figure figure = branch_figure({file}, {});
  CHECK(figure.panels[0].x.label.text == "α");
  CHECK(figure.panels[0].y.label.text == "L_2 norm");
  const auto solid = with_dash(figure, Dash::solid), dashed = with_dash(figure, Dash::dashed);
  REQUIRE(solid.size() == 1);
  REQUIRE(dashed.size() == 1);
  CHECK(dashed[0]->points.front().x == 0.0);
  CHECK(dashed[0]->points.back().x == 0.2);
  CHECK(solid[0]->points.front().x == 0.2);
  CHECK(solid[0]->points.back().x == 0.5);
  CHECK(labels_of(figure) == std::vector<std::string>{"PD"});
  REQUIRE(figure.key.size() == 2);
  CHECK(figure.key[0].text.text == "stable");
}

TEST_CASE("labels by type, all, none, with numbers") {
  const TemporaryFolder folder;
  const BranchFile file = read_branch_file(folder.write("p.a", header(180, 1) + rows(branch)));
  LabelSelection all;
  all.all = true;
  CHECK(labels_of(branch_figure({file}, {"", "", all, {}})) == std::vector<std::string>{"EP", "PD", "UZ", "EP"});
  LabelSelection chosen;
  chosen.defaults = false;
  chosen.types = {"EP"};
  chosen.numbers = true;
  CHECK(labels_of(branch_figure({file}, {"", "", chosen, {}})) == std::vector<std::string>{"EP 1", "EP 4"});
  LabelSelection none;
  none.defaults = false;
  CHECK(branch_figure({file}, {"", "", none, {}}).panels[0].markers.empty());
}

TEST_CASE("inadmissible points and names of UZ points come from the d-file") {
  const TemporaryFolder folder;
  const std::string path = folder.write("p.a", header(180, 1) + rows(branch));
  std::string text;
  for (const Row& r : branch)
    text += diagnostics(r.point,
                        r.label == 3  ? "GR"
                        : r.type == 7 ? "PD"
                        : r.type == 9 ? "EP"
                                      : "",
                        r.label, r.x, r.point != -6);
  folder.write("d.a", text);
  const BranchFile file = read_branch_file(path);
  CHECK(line_kind(file, 0, 4) == LineKind::stable);
  CHECK(line_kind(file, 0, 5) == LineKind::inadmissible);
  const Figure figure = branch_figure({file}, {});
  CHECK(labels_of(figure) == std::vector<std::string>{"PD", "GR"});
  const auto dotted = with_dash(figure, Dash::dotted);
  REQUIRE(dotted.size() == 1);
  CHECK(dotted[0]->points.front().x == 0.4);
  CHECK(figure.key.back().text.text == "inadmissible");
}

TEST_CASE("subcritical points are open symbols") {
  const TemporaryFolder folder;
  const std::string path = folder.write("p.a", header(180, 1) + rows(branch));
  for (const bool subcritical : {false, true}) {
    std::string text = diagnostics(3, "PD", 2, 0.2, true);
    const std::string verdict = subcritical ? "subcritical" : "supercritical";
    text.insert(text.find("===="),
                "   1     3  NOTE: " + format_normal_form({"c", 0.5, 1e-9, verdict}, ": what") + "\n");
    folder.write("d.a", text);
    const Figure figure = branch_figure({read_branch_file(path)}, {});
    REQUIRE(figure.panels[0].markers.size() == 1);
    CHECK(figure.panels[0].markers[0].label.text == "PD");
    CHECK(figure.panels[0].markers[0].filled == !subcritical);
  }
}

TEST_CASE("where stability is not known there is none to show") {
  const TemporaryFolder folder;
  std::string text = header(4, 1);
  const BranchFile file =
      read_branch_file(folder.write("b.a", text + rows({{1, 9, 1, 0.0, 1.0, 2.0}, {2, 9, 2, 1.0, 1.0, 2.0}})));
  CHECK(line_kind(file, 0, 1) == LineKind::stable);
  const Figure figure = branch_figure({file}, {});
  REQUIRE(figure.key.size() == 1);
  CHECK(figure.key[0].text.text == "a");
}

TEST_CASE("two-parameter curves: free parameters as axes, a line and a name for each kind") {
  const TemporaryFolder folder;
  const std::vector<Row> curve = {{1, 0, 0, 0.0, 1.0, 2.0}, {2, 59, 8, 1.0, 1.1, 2.5}};
  const std::vector<BranchFile> files = {
      read_branch_file(folder.write("p.grazing", header(150, 1, 0, "2 1 61") + rows(curve))),
      read_branch_file(folder.write("p.folds", header(180, 2, 5) + rows(curve))),
      read_branch_file(folder.write("p.doublings", header(180, 2, 7) + rows(curve))),
      read_branch_file(
          folder.write("p.from_types", header(180, 2) + rows({{1, 0, 0, 0.0, 1.0, 2.0}, {2, 79, 3, 1.0, 1.0, 3.0}})))};
  const Figure figure = branch_figure(files, {});
  CHECK(figure.panels[0].x.label.text == "ω");
  CHECK(figure.panels[0].y.label.text == "α");
  REQUIRE(figure.key.size() == 4);
  CHECK(figure.key[0].text.text == "grazing");
  CHECK(figure.key[1].text.text == "fold");
  CHECK(figure.key[2].text.text == "period doubling (doublings)");
  CHECK(figure.key[3].text.text == "period doubling (from_types)");
  CHECK(figure.key[2].stroke->colour != figure.key[3].stroke->colour);
  CHECK(with_dash(figure, Dash::solid).size() == 4);  // dashes would say unstable
  std::set<std::pair<std::string, Symbol>> looks;
  for (const KeyEntry& entry : figure.key) looks.insert({entry.stroke->colour, entry.marker.value().symbol});
  CHECK(looks.size() == 4);
  const std::vector<Marker> symbols = lay_out(figure).panels[0].symbols;
  for (const KeyEntry& entry : figure.key)
    CHECK(std::any_of(symbols.begin(), symbols.end(), [&entry](const Marker& symbol) {
      return symbol.colour == entry.stroke->colour && symbol.symbol == entry.marker->symbol;
    }));

  const Figure named = branch_figure(files, {"", "", {}, {"G", "F", "P", "P2"}});
  CHECK(named.key[2].text.text == "P");
}

TEST_CASE("columns by heading, number, PAR(k), last word, others are refused with those there are") {
  const TemporaryFolder folder;
  const BranchFile file = read_branch_file(folder.write("p.a", header(180, 1) + rows(branch)));
  for (const auto& [wanted, column] : {std::pair("alpha", 0U),
                                       {"1", 0U},
                                       {"PAR(1)", 0U},
                                       {"par(2)", 2U},
                                       {"OMEGA", 2U},
                                       {"max  x1", 3U},
                                       {"x1", 3U},
                                       {"l2-norm", 1U},
                                       {"4", 3U}}) {
    INFO(wanted);
    CHECK(find_column(file, 0, wanted, "-x").column == column);
  }
  for (const char* wanted : {"nosuch", "0", "5", "-1", "PAR(3)", "r", "", "U(9)", "PAR(99999999999)"}) {
    const std::string message = message_of<UserError>([&] { find_column(file, 0, wanted, "-y"); });
    CHECK(message.find("alpha, L2-NORM, omega, MAX x1") != std::string::npos);
    CHECK(message.find("-y") != std::string::npos);
  }
}

TEST_CASE("a section with several branches is not one line, after 9999 the count goes on") {
  const TemporaryFolder folder;
  const BranchFile two = read_branch_file(folder.write("p.a", header(180, 1) + rows({{1, 9, 1, 0.0, 1.0, 2.0},
                                                                                     {2, 9, 2, 1.0, 1.0, 2.0},
                                                                                     {-1, 9, 3, 5.0, 1.0, 2.0},
                                                                                     {-2, 0, 0, 6.0, 1.0, 2.0}})));
  CHECK(two.pieces.size() == 2);
  const BranchFile one = read_branch_file(folder.write(
      "p.b",
      header(180, 1) + rows({{9998, 0, 0, 0.0, 1.0, 2.0}, {9999, 0, 0, 1.0, 1.0, 2.0}, {1, 0, 0, 2.0, 1.0, 2.0}})));
  CHECK(one.pieces.size() == 1);
}

TEST_CASE("a table of numbers: two columns, names from the last comment before them") {
  const TemporaryFolder folder;
  const DataFile data =
      read_data_file(folder.write("d.txt", "# brute force\n#  a  v  events\n\n 0 0.5 1\n1e-1 -0.25 2\n"));
  CHECK(data.name == "d");
  CHECK(data.x_name == "a");
  CHECK(data.y_name == "v");
  REQUIRE(data.points.size() == 2);
  CHECK(data.points[1].x == 0.1);
  CHECK(data.points[1].y == -0.25);
  CHECK(read_data_file(folder.write("e.txt", "# a v\n0 1 2\n")).x_name.empty());
  for (const char* text : {"0 0.5\n0 0.6\n", "# a b\n3 1\n", "1.5 2 3 4 5 6.5\n"})
    CHECK(looks_like_data(folder.write("x", text)));
  for (const char* text : {"", "# a\n", "1\n", "a b\n", "0 -1.0 1.0 0.0 2.0\n", "1 2 9 1 0.5\n"})
    CHECK_FALSE(looks_like_data(folder.write("x", text)));
  const auto message = [&](const std::string& text) {
    return message_of<UserError>([&] { read_data_file(folder.write("bad.txt", text)); });
  };
  CHECK_THAT(message("1 2\n3\n"), Contains("bad.txt:2") && Contains("'3'"));
  CHECK_THAT(message("1 2\n3 x\n"), Contains("bad.txt:2") && Contains("two numbers"));
  CHECK_THAT(message("# nothing\n"), Contains("no numbers"));
}

TEST_CASE("dots beneath branches, and alone") {
  const TemporaryFolder folder;
  const BranchFile file = read_branch_file(folder.write("p.a", header(180, 1) + rows(branch)));
  BranchFigureOptions options;
  options.clouds.push_back({"brute force", "a", "v", {{0.5, 7.0}, {1.5, 8.0}}});
  const Figure both = branch_figure({file}, options);
  REQUIRE(both.panels[0].clouds.size() == 1);
  CHECK(both.panels[0].clouds[0].points.size() == 2);
  REQUIRE(both.key.size() == 4);  // with stable and unstable
  CHECK(both.key[1].text.text == "brute force");
  CHECK(both.panels[0].x.label.text != "a");
  const FigureLayout layout = lay_out(both);
  CHECK(layout.panels[0].x.low <= 0.5);
  CHECK(layout.panels[0].y.high >= 8.0);
  const Figure alone = branch_figure({}, options);
  REQUIRE(alone.key.size() == 1);
  CHECK(alone.key[0].text.text == "brute force");
  CHECK(alone.panels[0].x.label.text == mathematical_name("a").text);
  CHECK(alone.panels[0].y.label.text == mathematical_name("v").text);
}

TEST_CASE("a zero of xi_n is labelled with its n") {
  const TemporaryFolder folder;
  const std::string grazing =
      header(150, 1) + rows({{1, 9, 1, 0.0, 1.0, 2.0}, {2, -4, 2, 0.5, 1.1, 2.0}, {3, -4, 3, 1.0, 1.2, 2.0}});
  folder.write(
      "d.a",
      diagnostics(1, "EP", 1, 0.0, true) +
          "  BR    PT  TY  LAB       alpha\n   1     2  XI    2   5.0E-01\n   1     2  NOTE: codimension two: xi_2 "
          "= 0, xi_4 = 0\n" +
          std::string(47, '=') + '\n' + diagnostics(3, "GC", 3, 1.0, true));
  const BranchFile file = read_branch_file(folder.write("p.a", grazing));
  CHECK(labels_of(branch_figure({file}, {})) == std::vector<std::string>{"ξ_{2,4}", "GC"});
  BranchFigureOptions numbered;
  numbered.labels.numbers = true;
  CHECK(labels_of(branch_figure({file}, numbered)) == std::vector<std::string>{"XI 2", "GC 3"});
}

TEST_CASE("inadmissible parts set no range where there are admissible ones") {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "p.a", header(180, 1) + rows({{-1, 9, 1, 0.0, 1.0, 2.0}, {-2, 0, 0, 1.0, 2.0, 2.0}, {-3, 9, 2, 9.0, 50.0, 2.0}}));
  const auto frame_of = [&](int admissible_points, const AxisSettings& x) {
    std::string text;
    for (int point = 1; point <= 3; ++point)
      text += diagnostics(-point, point == 2 ? "" : "EP",
                          point == 1   ? 1
                          : point == 3 ? 2
                                       : 0,
                          point == 1   ? 0.0
                          : point == 3 ? 9.0
                                       : 1.0,
                          point <= admissible_points);
    folder.write("d.a", text);
    BranchFigureOptions options;
    options.labels.all = true;
    Figure figure = branch_figure({read_branch_file(path)}, options);
    figure.panels[0].x.low = x.low, figure.panels[0].x.high = x.high;
    return lay_out(figure).panels[0];
  };
  const PanelLayout part = frame_of(2, {});
  CHECK(part.x.high < 1.2);
  CHECK(part.y.low < 1.0);
  CHECK(part.y.high < 2.2);
  CHECK(frame_of(3, {}).y.high > 50.0);
  CHECK(frame_of(0, {}).y.high > 50.0);
  CHECK(frame_of(1, {}).y.high > 50.0);  // one point is no part of a branch
  AxisSettings beyond;
  beyond.low = 5.0, beyond.high = 10.0;
  CHECK(frame_of(2, beyond).y.high > 50.0);
}

TEST_CASE("a single curve has a key") {
  const TemporaryFolder folder;
  const std::vector<Row> curve = {{1, 0, 0, 0.0, 1.0, 2.0}, {2, 59, 8, 1.0, 1.1, 2.5}};
  const auto key_of = [&](const std::string& text) {
    std::vector<std::string> names;
    for (const KeyEntry& entry : branch_figure({read_branch_file(folder.write("p.a", text))}, {}).key)
      names.push_back(entry.text.text);
    return names;
  };
  CHECK(key_of(header(180, 2, 7) + rows(curve)) == std::vector<std::string>{"period doubling"});
  CHECK(key_of(header(180, 1) + rows({{-1, 9, 1, 0.0, 1.0, 2.0}, {-2, 9, 2, 0.5, 1.0, 2.0}})) ==
        std::vector<std::string>{"stable"});
  CHECK(key_of(header(180, 1) + rows({{1, 9, 1, 0.0, 1.0, 2.0}, {2, 9, 2, 0.5, 1.0, 2.0}})) ==
        std::vector<std::string>{"unstable"});
}

TEST_CASE("lines end at the bounds of the run") {
  const TemporaryFolder folder;
  const std::string beyond = rows({{-1, 9, 1, 0.5, 0.5, 2.0}, {-2, 0, 0, 0.9, 0.7, 2.0}, {-3, 9, 2, 1.1, 0.9, 2.0}});
  const auto end_of = [&] {
    const BranchFile file = read_branch_file(folder.file("p.a"));
    CHECK(part_within_bounds(file, 0, 0) == 1.0);
    return branch_figure({file}, {}).panels[0].curves.back().points.back();
  };
  folder.write("p.a", header(180, 1) + beyond);
  CHECK(end_of().x == Approx(1.0).epsilon(1e-14));
  CHECK(end_of().y == Approx(0.8).epsilon(1e-14));
  folder.write("r.a", "NDIM = 2, ICP = [1, 61], RL0 = 0, RL1 = 1.00001, A1 = 1\n");  // more digits than in the header
  CHECK(end_of().x == Approx(1.00001).epsilon(1e-14));
  folder.write("r.a", "NDIM = 2, ICP = [1, 61], RL0 = 0, RL1 = 1.5, A1 = 1\n");  // of another run
  CHECK(end_of().x == Approx(1.0).epsilon(1e-14));
  folder.write("p.a", header(180, 1) + rows({{-1, 9, 1, 0.5, 0.5, 2.0}, {-2, 9, 2, 0.75, 1.5, 2.0}}));
  CHECK(end_of().x == Approx(0.625).epsilon(1e-14));  // A1
}

TEST_CASE("eight curves in one picture: no colour twice, none of them grey, all of them solid") {
  const TemporaryFolder folder;
  std::vector<BranchFile> files;
  const auto add = [&](const std::string& name, int ips, int type) {
    files.push_back(
        read_branch_file(folder.write("p." + name, header(ips, type == 0 ? 1 : 2, type) +
                                                       rows({{1, 0, 0, 0.0, 1.0, 2.0}, {2, 0, 0, 1.0, 1.1, 2.5}}))));
  };
  for (const char* name : {"z", "y", "x", "w"}) add(name, 150, 0);
  for (const char* name : {"v", "u"}) add(name, 180, 7);
  for (const char* name : {"t", "s"}) add(name, 180, 5);
  const Figure figure = branch_figure(files, {});
  REQUIRE(figure.key.size() == 8);
  CHECK(figure.key[0].text.text == "grazing (z)");
  CHECK(figure.key[0].stroke->colour == "#000000");  // the first in the command line, not in the alphabet
  std::set<std::string> colours;
  for (const KeyEntry& entry : figure.key) {
    const std::string& colour = entry.stroke->colour;
    colours.insert(colour);
    CHECK(entry.stroke->dash == Dash::solid);
    CHECK(
        (colour == "#000000" || colour.substr(1, 2) != colour.substr(3, 2) || colour.substr(1, 2) != colour.substr(5)));
  }
  CHECK(colours.size() == 8);
}

TEST_CASE("black branches have no names in the key") {
  const TemporaryFolder folder;
  const std::string text = header(180, 1) + rows({{-1, 9, 1, 0.0, 1.0, 2.0}, {-2, 9, 2, 0.5, 1.0, 2.0}});
  BranchFigureOptions options;
  options.black = true;
  const Figure figure = branch_figure(
      {read_branch_file(folder.write("p.a", text)), read_branch_file(folder.write("p.b", text))}, options);
  REQUIRE(figure.panels[0].curves.size() == 2);
  for (const Curve& curve : figure.panels[0].curves) CHECK(curve.stroke.colour == "#000000");
  REQUIRE(figure.key.size() == 1);
  CHECK(figure.key[0].text.text == "stable");
}

TEST_CASE("twelve branches have twelve colours") {
  std::set<std::string> colours;
  for (std::size_t k = 0; k < 12; ++k) colours.insert(series_colour(k));
  CHECK(colours.size() == 12);
  std::set<Symbol> symbols;
  for (std::size_t k = 0; k < 5; ++k) symbols.insert(series_symbol(k));
  CHECK(symbols.size() == 5);
}
