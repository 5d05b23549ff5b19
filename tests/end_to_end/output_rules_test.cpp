// What the constants say about limits, labels, measures and files, seen in the files.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

using Rows = std::vector<PointRow>;

const std::string impacting = "-c impacting -d impacting -o branch ";
const std::string smooth = "-c nonimpacting_alpha -d nonimpacting -o branch ";

Rows rows_after(const Workspace& workspace, const std::string& arguments) {
  workspace.run(arguments);
  return workspace.points("branch").front().rows;
}

/// Time mean of f(state) over an orbit of one segment: Simpson's rule for the equally spaced points of each interval
/// with four collocation points (Boole's), exact for the interpolating polynomial of degree 4 when f is linear.
template <class Function>
double time_mean(const SolutionEntry& solution, const Function& f) {
  static constexpr double weights[] = {7.0 / 90, 32.0 / 90, 12.0 / 90, 32.0 / 90, 7.0 / 90};
  double mean = 0.0;
  for (std::size_t j = 0; j + 4 < solution.t.size(); j += 4)
    for (std::size_t k = 0; k < 5; ++k)
      mean += (solution.t[j + 4] - solution.t[j]) * weights[k] * f(solution.states[j + k]);
  return mean;
}

double square(double x) { return x * x; }

}  // namespace

TEST_CASE("with --append a run adds a section, labels go on counting") {
  const Workspace workspace;
  workspace.run(impacting + "NMX=11 NPR=5");
  const std::string first_points = workspace.read("p.branch");
  const std::string first_solutions = workspace.read("q.branch");
  const auto before = labels_of(workspace.points("branch"));
  workspace.run("-c impacting -s branch -o branch --append IRS=2 DS=-0.02 NMX=11 NPR=5");
  CHECK(workspace.read("p.branch").compare(0, first_points.size(), first_points) == 0);
  CHECK(workspace.read("q.branch").compare(0, first_solutions.size(), first_solutions) == 0);
  const auto sections = workspace.points("branch");
  REQUIRE(sections.size() == 2);
  const auto labels = labels_of(sections);
  CHECK(labels == labels_of(workspace.solutions("branch")));
  for (std::size_t k = 0; k < labels.size(); ++k) CHECK(labels[k] == static_cast<int>(k) + 1);
  CHECK(labels.size() > before.size());
  CHECK_FALSE(workspace.has("q.branch~"));
  // Appending where there is nothing yet begins the files.
  workspace.run("-c impacting -d impacting -o fresh --append NMX=3");
  CHECK(labels_of(workspace.points("fresh")).front() == 1);
}

TEST_CASE("with --both a run computes the two directions into one set of files") {
  const Workspace workspace;
  workspace.run(impacting + "NMX=12 NPR=5 --both");
  const auto sections = workspace.points("branch");
  REQUIRE(sections.size() == 2);
  CHECK(sections[0].rows.front().values == sections[1].rows.front().values);
  CHECK(sections[0].rows[1].values.front() > sections[0].rows[0].values.front());
  CHECK(sections[1].rows[1].values.front() < sections[1].rows[0].values.front());
  CHECK(sections[0].rows.front().branch != sections[1].rows.front().branch);
  CHECK(sections[0].real("DS") == 0.02);
  CHECK(sections[1].real("DS") == -0.02);
  const auto labels = labels_of(sections);
  CHECK(labels == labels_of(workspace.solutions("branch")));
  for (std::size_t k = 0; k < labels.size(); ++k) CHECK(labels[k] == static_cast<int>(k) + 1);
}

TEST_CASE("option -o may name a folder") {
  const Workspace workspace;
  std::filesystem::create_directory(workspace.file("results"));
  workspace.run("-c impacting -d impacting -o results/branch NMX=3");
  for (const char letter : {'p', 'q', 'd', 'r'}) CHECK(workspace.has(std::string("results/") + letter + ".branch"));
  workspace.run("-c results/r.branch -s results/branch -o results/on IRS=1 NMX=3");
  CHECK(workspace.has("results/p.on"));
}

TEST_CASE("durations that ICP leaves out are free all the same") {
  const Workspace workspace;
  workspace.run(impacting + "NMX=6");
  const auto listed = workspace.points("branch");
  workspace.run(impacting + "NMX=6 ICP=[1]");
  const auto sections = workspace.points("branch");
  CHECK(sections.front().names.size() + 1 == listed.front().names.size());
  CHECK(sections.front().rows.back().values.front() == listed.front().rows.back().values.front());
  CHECK(sections.front().rows.back().values.back() == listed.front().rows.back().values.back());
  CHECK(workspace.solutions("branch").front().free_parameters == std::vector<int>{1, 61});
}

TEST_CASE("a GCSEGTYP that contradicts the jump warns and changes nothing") {
  const Workspace workspace;
  workspace.run(impacting + "NMX=6");
  const auto rows = workspace.points("branch").front().rows;
  const Outcome outcome = workspace.run(impacting + "NMX=6 GCSEGTYP=[0]");
  CHECK(outcome.err.find("warning") != std::string::npos);
  CHECK(outcome.err.find("GCSEGTYP") != std::string::npos);
  CHECK(workspace.points("branch").front().rows.back().values == rows.back().values);
}

TEST_CASE("user functions of a plugin are columns") {
  const Workspace workspace(Workspace::Plugin::source);
  workspace.edit("linosc.cpp", "  template <class T>\n  T event",
                 "  static constexpr int user_values = 2;\n"
                 "  static constexpr const char* user_value_names[] = {\"energy\", \"ratio\"};\n"
                 "  void user_value(const double* x, const double* par, double* out) const {\n"
                 "    out[0] = 0.5 * (x[0] * x[0] + x[1] * x[1]);\n    out[1] = par[0] / par[1];\n  }\n\n"
                 "  template <class T>\n  T event");
  workspace.run(impacting + "NMX=6 NPR=2");
  const auto sections = workspace.points("branch");
  for (const SolutionEntry& solution : workspace.solutions("branch")) {
    const PointRow& row = with_label(sections, solution.label);
    const auto& start = solution.states.front();
    CHECK(row.values[sections.front().column("energy")] ==
          Approx(0.5 * (square(start[0]) + square(start[1]))).epsilon(1e-9));
    CHECK(row.values[sections.front().column("ratio")] ==
          Approx(solution.parameter(1) / solution.parameter(2)).epsilon(1e-9));
  }
}

TEST_CASE("with -q a run prints nothing") {
  const Workspace workspace;
  const Outcome outcome = workspace.run(impacting + "-q NMX=5");
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
  CHECK(workspace.points("branch").front().rows.size() == 5);
}

TEST_CASE("user values are met to 1e-9, a negative index ends the branch") {
  const Workspace workspace;
  workspace.run({"-c", "impacting", "-d", "impacting", "-o", "branch", "UZR={1: [3.1, 3.2]}"});
  auto sections = workspace.points("branch");
  std::vector<double> met;
  for (const PointRow& row : sections.front().rows)
    if (row.type == -4) met.push_back(row.values.front());
  REQUIRE(met.size() == 2);
  CHECK(std::abs(met[0] - 3.1) < 1e-9);
  CHECK(std::abs(met[1] - 3.2) < 1e-9);
  CHECK(sections.front().integer("NUZR") == 2);

  const Outcome stopped =
      workspace.run({"-c", "impacting", "-d", "impacting", "-o", "branch", "UZR={1: 3.1, -1: 3.2}"});
  CHECK(stopped.out.find("stopped: at the last special point above") != std::string::npos);
  CHECK(stopped.out.find("GRSTOP") == std::string::npos);
  sections = workspace.points("branch");
  CHECK(sections.front().rows.back().type == -4);
  CHECK(std::abs(sections.front().rows.back().values.front() - 3.2) < 1e-9);

  // A duration is a parameter like any other.
  const double period = 2.0 * M_PI / 2.5;
  workspace.run(
      {"-c", "nonimpacting_omega", "-d", "nonimpacting", "-o", "branch", "UZR={-61: " + std::to_string(period) + "}"});
  sections = workspace.points("branch");
  CHECK(sections.front().rows.back().type == -4);
  CHECK(std::abs(sections.front().rows.back().values.back() - std::stod(std::to_string(period))) < 1e-9);
  CHECK(sections.front().rows.back().values.front() == Approx(2.5).epsilon(1e-5));
}

TEST_CASE("two user values inside one step are both met, in order") {
  const Workspace workspace;
  workspace.run({"-c", "impacting", "-d", "impacting", "-o", "branch", "DS=2", "DSMAX=2", "IADS=0",
                 "UZR={1: [3.2, 3.06, 3.12]}"});
  std::vector<double> met;
  for (const PointRow& row : rows_of(workspace.points("branch")))
    if (row.type == -4) met.push_back(row.values.front());
  REQUIRE(met.size() == 3);
  CHECK(std::abs(met[0] - 3.06) < 1e-9);
  CHECK(std::abs(met[1] - 3.12) < 1e-9);
  CHECK(std::abs(met[2] - 3.2) < 1e-9);
}

TEST_CASE("STOP ends the branch at the n-th point of a type") {
  const Workspace workspace;
  for (const std::string stop : {"UZ1", "UZ2"}) {
    workspace.run({"-c", "impacting", "-d", "impacting", "-o", "branch", "UZR={1: [3.1, 3.2]}", "STOP=[" + stop + "]"});
    const PointRow last = workspace.points("branch").front().rows.back();
    CHECK(last.type == -4);
    CHECK(std::abs(last.values.front() - (stop == "UZ1" ? 3.1 : 3.2)) < 1e-9);
  }
}

TEST_CASE("NMX counts the start point, the last point is EP") {
  const Workspace workspace;
  for (const int points : {1, 2, 7}) {
    const Rows rows = rows_after(workspace, impacting + "NPR=0 NMX=" + std::to_string(points));
    CHECK(rows.size() == static_cast<std::size_t>(points));
    CHECK(rows.back().type == 9);
  }
}

TEST_CASE("RL0, RL1, A0, A1: the first point outside is the last one, EP") {
  const Workspace workspace;
  Rows rows = rows_after(workspace, impacting + "RL1=3.1");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values.front() > 3.1);
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) CHECK(rows[k].values.front() <= 3.1);
  rows = rows_after(workspace, smooth + "RL0=2.5");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values.front() < 2.5);
  CHECK(rows[rows.size() - 2].values.front() >= 2.5);
  rows = rows_after(workspace, impacting + "A1=2.5");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values[1] > 2.5);
  CHECK(rows[rows.size() - 2].values[1] <= 2.5);
  rows = rows_after(workspace, smooth + "A0=1.5");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values[1] < 1.5);
  CHECK(rows[rows.size() - 2].values[1] >= 1.5);
}

TEST_CASE("a label beyond the bounds, where an earlier run ended, is a branch of one point, and that is said") {
  const Workspace workspace;
  workspace.run(impacting + "RL1=3.1");
  const Outcome outside = workspace.run("-c impacting -s branch -o on IRS=EP2 RL1=3.1");
  CHECK(outside.text().find("starts outside the bounds RL0, RL1") != std::string::npos);
  CHECK(workspace.points("on").front().rows.size() == 1);
}

TEST_CASE("with --clip the branch ends on the bound") {
  const Workspace workspace;
  const auto clipped = [&](const std::string& arguments) {
    const Outcome outcome = workspace.run(arguments + " --clip");
    CHECK(outcome.out.find("stopped: ") != std::string::npos);
    CHECK(outcome.out.find(", the bound ") != std::string::npos);
    return workspace.points("branch").front().rows;
  };
  Rows rows = clipped(impacting + "RL1=3.1");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values.front() == Approx(3.1).epsilon(1e-9));
  rows = clipped(smooth + "RL0=2.5");
  CHECK(rows.back().type == 9);
  CHECK(rows.back().values.front() == Approx(2.5).epsilon(1e-9));
  rows = clipped(impacting + "A1=2.5");
  CHECK(rows.back().values[1] == Approx(2.5).epsilon(1e-7));
  rows = clipped(smooth + "A0=1.5");
  CHECK(rows.back().values[1] == Approx(1.5).epsilon(1e-7));
}

TEST_CASE("with --clip a branch that starts on a bound has no point beyond it") {
  const Workspace workspace;
  workspace.run(impacting + "RL1=3.1 --clip");
  const Outcome outcome = workspace.tchat("run linosc -c impacting -s branch -o both IRS=EP2 RL1=3.1 --clip --both");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(outcome.text().find("alpha = 3.1, the bound RL1, where the branch starts") != std::string::npos);
  std::size_t longest = 0;
  for (const auto& section : workspace.points("both")) {
    longest = std::max(longest, section.rows.size());
    for (const auto& row : section.rows) CHECK(row.values.front() <= 3.1 * (1.0 + 1e-9));
  }
  CHECK(longest > 1);
}

TEST_CASE("a start outside of RL0, RL1 or A0, A1 is refused, and nothing is written") {
  const Workspace workspace;
  for (const std::string bounds : {"RL0=2 RL1=3", "A0=0 A1=1"}) {
    const Outcome outcome = workspace.tchat("run linosc " + impacting + bounds);
    INFO(outcome.text());
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("outside of the bounds") != std::string::npos);
    CHECK(outcome.err.find(bounds[0] == 'R' ? "alpha is 3.0485" : "the solution measure is 2.165") !=
          std::string::npos);
    CHECK_FALSE(workspace.has("p.branch"));
  }
}

TEST_CASE("NPR labels every NPR-th point") {
  const Workspace workspace;
  for (const int every : {1, 3, 0}) {
    const Rows rows = rows_after(workspace, impacting + "NMX=10 UZR={} NPR=" + std::to_string(every));
    for (const PointRow& row : rows) {
      const int number = std::abs(row.point);
      const int type = number == 1 || number == 10 ? 9 : every > 0 && number % every == 0 ? 4 : 0;
      CHECK(row.type == type);
    }
  }
  const Outcome outcome = workspace.tchat("run linosc " + impacting + "NMX=10 UZR={} NPR=1");
  CHECK(contains(outcome.out, "EP    1"));
  CHECK(contains(outcome.out, "EP   10"));
  CHECK_FALSE(contains(outcome.out, "RG"));  // they go to the files
}

TEST_CASE("IADS = 0 keeps the step, IADS = n changes it every n-th point") {
  const Workspace workspace;
  const auto steps = [&](const std::string& constants) {
    workspace.run(impacting + "NMX=8 UZR={} " + constants);
    std::vector<double> lengths;
    std::istringstream in(workspace.read("d.branch"));
    for (std::string line; std::getline(in, line);)
      if (const auto at = line.find("Next Step    :"); at != std::string::npos)
        lengths.push_back(std::stod(line.substr(at + 14)));
    REQUIRE(lengths.size() == 7);
    return lengths;
  };
  for (const double length : steps("IADS=0 DS=0.03")) CHECK(length == 0.03);
  const auto third = steps("IADS=3 DS=0.01");
  CHECK(third[0] == 0.01);
  CHECK(third[1] == 0.01);
  CHECK(third[2] > 0.01);
  CHECK(third[3] == third[2]);
  CHECK(third[5] > third[4]);
  for (const double length : steps("DS=0.01 DSMAX=0.02")) CHECK(length <= 0.02);
}

TEST_CASE("IPLT chooses the measure, as computed from the q-file") {
  const Workspace workspace;
  struct Measure {
    int selector;
    std::string name;
  };
  for (const Measure& measure :
       {Measure{0, "L2-NORM"}, Measure{2, "MAX x2"}, Measure{-1, "MIN x1"}, Measure{-3, "MIN y1"},
        Measure{5, "INTEGRAL x1"}, Measure{9, "L2-NORM x1"}, Measure{12, "L2-NORM y2"}}) {
    INFO("IPLT = " << measure.selector);
    workspace.run(impacting + "NMX=8 NPR=4 A0=-100 IPLT=" + std::to_string(measure.selector));
    const auto sections = workspace.points("branch");
    CHECK(sections.front().names[1] == measure.name);
    for (const SolutionEntry& solution : workspace.solutions("branch")) {
      const int n = 4;
      const auto k = static_cast<std::size_t>((std::abs(measure.selector) - 1) % n);
      double expected = 0.0;
      if (measure.selector == 0)
        expected = std::sqrt(time_mean(
            solution, [](const auto& u) { return square(u[0]) + square(u[1]) + square(u[2]) + square(u[3]); }));
      else if (measure.selector < 0 || measure.selector <= n) {
        expected = solution.states.front()[k];
        for (const auto& u : solution.states)
          expected = measure.selector < 0 ? std::min(expected, u[k]) : std::max(expected, u[k]);
      } else if (measure.selector <= 2 * n)
        expected = time_mean(solution, [k](const auto& u) { return u[k]; });
      else
        expected = std::sqrt(time_mean(solution, [k](const auto& u) { return square(u[k]); }));
      const double printed = with_label(sections, solution.label).values[1];
      CHECK(std::abs(printed - expected) < 1e-8);
    }
  }
}

TEST_CASE("THU enters the L2-norm, further free parameters get columns") {
  const Workspace workspace;
  workspace.run(
      {"-c", "impacting", "-d", "impacting", "-o", "branch", "NMX=3", "THU={2: 0, 3: 0, 4: 0}", "ICP=[1,61,3]"});
  const auto sections = workspace.points("branch");
  for (const SolutionEntry& solution : workspace.solutions("branch"))
    CHECK(std::abs(with_label(sections, solution.label).values[1] -
                   std::sqrt(time_mean(solution, [](const auto& u) { return square(u[0]); }))) < 1e-8);
  const auto& names = sections.front().names;
  CHECK(names == std::vector<std::string>{"alpha", "L2-NORM", "MAX x1", "MAX x2", "MAX y1", "MAX y2", "PAR(61)", "zeta",
                                          "PERIOD"});
  CHECK(sections.front().rows.front().values[sections.front().column("zeta")] == 0.05);
}
