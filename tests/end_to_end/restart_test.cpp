// From a label of a q-file: the same point again, other meshes, other parameters, direction, the older file form.
#include <catch2/catch.hpp>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/closed_forms.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr double zeta = 0.05;
constexpr double restitution = 0.8;

/// Number of Newton iterations that the d-file tells of the first point.
int first_iterations(const Workspace& workspace, const std::string& name) {
  const std::string text = workspace.read("d." + name);
  const auto at = text.find("Iterations   :");
  REQUIRE(at != std::string::npos);
  return std::stoi(text.substr(at + 14));
}

/// Largest difference of states on equal meshes, of time points and of parameters.
double difference(const SolutionEntry& a, const SolutionEntry& b) {
  REQUIRE(a.t.size() == b.t.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < a.t.size(); ++k) {
    largest = std::max(largest, std::abs(a.t[k] - b.t[k]));
    for (std::size_t i = 0; i < a.states[k].size(); ++i)
      largest = std::max(largest, std::abs(a.states[k][i] - b.states[k][i]) / (1.0 + std::abs(a.states[k][i])));
  }
  for (std::size_t k = 0; k < a.par.size(); ++k)
    largest = std::max(largest, std::abs(a.par[k] - b.par[k]) / (1.0 + std::abs(a.par[k])));
  return largest;
}

/// The first point of a run that makes no step.
SolutionEntry restarted_point(const Workspace& workspace, const std::string& arguments) {
  workspace.run(arguments + " NMX=1 -o again");
  const auto solutions = workspace.solutions("again");
  REQUIRE(solutions.size() == 1);
  return solutions.front();
}

void check_every_label(const Workspace& workspace, const std::string& constants, const std::string& start) {
  for (const SolutionEntry& stored : workspace.solutions(start)) {
    INFO("label " << stored.label);
    const SolutionEntry again =
        restarted_point(workspace, "-c " + constants + " -s " + start + " IRS=" + std::to_string(stored.label));
    CHECK(first_iterations(workspace, "again") <= 1);
    CHECK(difference(stored, again) < 2e-10);  // the file has ten decimals
    CHECK(again.label > stored.label);
  }
}

double velocity(const SolutionEntry& solution) { return -solution.states.front()[1] / restitution; }

/// The 12-integer form of AUTO's older generation, two exponent digits, no type of problem or dimension.
std::string older_form(const SolutionEntry& entry) {
  std::ostringstream out;
  char buffer[64];
  const auto real = [&](double value) {
    std::snprintf(buffer, sizeof buffer, "%19.10E", value);
    return std::string(buffer);
  };
  const auto lines = [&](const std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (k % 7 == 0) out << (k > 0 ? "\n    " : "    ");
      out << real(values[k]);
    }
    out << '\n';
  };
  const int states = static_cast<int>(entry.states.front().size());
  const int points = static_cast<int>(entry.t.size());
  const int free = static_cast<int>(entry.free_parameters.size());
  const int rows = (states / 7 + 1) * points + (100 + 6) / 7 + 1 + 1 + (states + 6) / 7 * points;
  for (const int value : {entry.branch, entry.point, entry.type, entry.label, free, 1}) {
    std::snprintf(buffer, sizeof buffer, "%6d", value);
    out << buffer;
  }
  std::snprintf(buffer, sizeof buffer, "%8d%6d%8d%5d%5d%5d\n", points, states + 1, rows, entry.intervals,
                entry.collocation, 100);
  out << buffer;
  for (std::size_t k = 0; k < entry.t.size(); ++k) {
    std::vector<double> record{entry.t[k]};
    record.insert(record.end(), entry.states[k].begin(), entry.states[k].end());
    lines(record);
  }
  for (const int k : entry.free_parameters) {
    std::snprintf(buffer, sizeof buffer, "%5d", k);
    out << buffer;
  }
  out << '\n';
  lines(entry.parameter_direction);
  for (const auto& record : entry.direction) lines(record);
  lines(std::vector<double>(entry.par.begin(), entry.par.begin() + 100));
  return out.str();
}

}  // namespace

TEST_CASE("restart at every label of a branch: one Newton step at most, the same point") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting --both GRSTOP=0");
  check_every_label(workspace, "impacting", "impacting");
  workspace.run("-c nonimpacting_omega -d nonimpacting -o smooth");
  check_every_label(workspace, "nonimpacting_omega", "smooth");
}

TEST_CASE("restart of an orbit entered as two segments") {
  const Workspace workspace;
  workspace.run({"-c", "impacting", "-d", "impacting", "-o", "one", "NMX=3"});
  // Twice the signature, from the same data twice.
  std::istringstream rows(workspace.read("impacting.dat"));
  std::string twice =
      "# PAR(1) = 3.048525879392131\n# PAR(2) = 2.0072\n# PAR(61) = 3.1303234889689\n"
      "# PAR(62) = 3.1303234889689\n";
  for (std::string line; std::getline(rows, line);) {
    const auto first = line.find_first_not_of(' ');
    if (first == std::string::npos || line[first] == '#') continue;
    const auto state = line.find(' ', first);
    twice += line + line.substr(state) + "\n";
  }
  workspace.write("twice.dat", twice);
  const std::vector<std::string> signature{"GCNOSEG=2",    "GCSEGTYP=[1,1]",      "GCFIND=[1,1]",  "GCHIND=[1,1]",
                                           "GCGIND=[1,1]", "GCHGRZIND=[[1],[1]]", "ICP=[1,61,62]", "THL={61:0,62:0}"};
  std::vector<std::string> words{"-c", "impacting", "-d", "twice", "-o", "two"};
  words.insert(words.end(), signature.begin(), signature.end());
  workspace.run(words);
  for (const SolutionEntry& stored : workspace.solutions("two")) {
    INFO("label " << stored.label);
    REQUIRE(stored.states.front().size() == 8);
    // Both segments are the one-impact orbit.
    const ImpactingOrbit orbit(velocity(stored), 2.0072, zeta, restitution);
    for (std::size_t k = 0; k < stored.t.size(); k += 4)
      for (std::size_t i = 0; i < 8; ++i)
        CHECK(std::abs(stored.states[k][i] - orbit.at(stored.t[k] * orbit.period())[i % 4]) < 1e-9);
    std::vector<std::string> again{"-c", "impacting", "-s",    "two",
                                   "-o", "again",     "NMX=1", "IRS=" + std::to_string(stored.label)};
    again.insert(again.end(), signature.begin(), signature.end());
    workspace.run(again);
    CHECK(first_iterations(workspace, "again") <= 1);
    CHECK(difference(stored, workspace.solutions("again").front()) < 2e-10);
  }
  // The constants that were used say the same.
  workspace.run("-c r.two -s two -o again IRS=2 NMX=1");
  CHECK(first_iterations(workspace, "again") <= 1);
}

TEST_CASE("restart on another mesh") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting");
  const SolutionEntry stored = with_label(workspace.solutions("impacting"), 3);
  struct Mesh {
    const char* constants;
    int intervals, collocation;
    double accuracy;  // of the coarser of the two meshes, which the orbits agree to
  };
  for (const Mesh& mesh : {Mesh{"NTST=80", 80, 4, 1e-9}, Mesh{"NCOL=3", 50, 3, 1e-8},
                           Mesh{"NTST=80 NCOL=3", 80, 3, 1e-8}, Mesh{"NTST=20 NCOL=5", 20, 5, 1e-7}}) {
    INFO(mesh.constants);
    const SolutionEntry again =
        restarted_point(workspace, std::string("-c impacting -s impacting IRS=3 ") + mesh.constants);
    CHECK(again.intervals == mesh.intervals);
    CHECK(again.collocation == mesh.collocation);
    CHECK(again.parameter(1) == Approx(stored.parameter(1)).epsilon(1e-6));
    const ImpactingOrbit orbit(velocity(again), 2.0072, zeta, restitution);
    CHECK(std::abs(again.parameter(1) - orbit.alpha()) < mesh.accuracy);
    for (std::size_t k = 0; k < again.t.size(); k += static_cast<std::size_t>(mesh.collocation))
      for (std::size_t i = 0; i < 4; ++i)
        CHECK(std::abs(again.states[k][i] - orbit.at(again.t[k] * orbit.period())[i]) < mesh.accuracy);
    workspace.run(std::string("-c impacting -s impacting IRS=3 -o longer ") + mesh.constants);
    CHECK(workspace.points("longer").front().rows.size() > 5);
  }
}

TEST_CASE("restart with another value of a fixed parameter keeps ICP(1) at the first point") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting");
  const SolutionEntry stored = with_label(workspace.solutions("impacting"), 3);
  for (const char* change : {"PAR(zeta)=0.06", "PAR(3)=0.06"}) {
    const SolutionEntry again = restarted_point(workspace, std::string("-c impacting -s impacting IRS=3 ") + change);
    CHECK(std::abs(again.parameter(1) - stored.parameter(1)) < 1e-10);
    CHECK(again.parameter(3) == 0.06);
    const ImpactingOrbit orbit(velocity(again), 2.0072, 0.06, restitution);
    CHECK(again.parameter(1) == Approx(orbit.alpha()).epsilon(1e-9));
  }
}

TEST_CASE("a restart has the parameters of the label to the last bit") {
  const Workspace workspace;
  const double coefficient = 0.8 + 1.0 / 3e10;
  const double damping = 0.1 / 3.0;
  workspace.run({"-c", "impacting", "-d", "impacting", "-o", "branch", "NMX=5", "PAR(zeta)=0.03333333333333333333",
                 "PAR(r)=0.80000000003333333333"});
  REQUIRE(workspace.solutions("branch").front().parameter(3) == damping);
  REQUIRE(workspace.solutions("branch").front().parameter(4) == coefficient);
  const SolutionEntry again = restarted_point(workspace, "-c impacting -s branch IRS=EP2");
  CHECK(again.parameter(3) == damping);
  CHECK(again.parameter(4) == coefficient);
  // What was free, too: here alpha becomes a fixed parameter.
  const SolutionEntry end = workspace.solutions("branch").back();
  CHECK(restarted_point(workspace, "-c impacting -s branch ICP=[2,61] RL0=1 IRS=EP2").parameter(1) == end.parameter(1));
}

TEST_CASE("DS > 0 goes on in the direction of the label's run whatever the sign of DS was there, DS < 0 goes back") {
  const Workspace workspace;
  struct Run {
    const char* arguments;
    const char* restart;
  };
  // The impacting branch both ways, with a turning point of alpha on its way down; the grazing curve both ways.
  for (const Run& run :
       {Run{"-c impacting -d impacting -o branch --both GRSTOP=0 DS=0.02", "-c impacting GRSTOP=0"},
        Run{"-c impacting -d impacting -o branch --both GRSTOP=0 DS=-0.02", "-c impacting GRSTOP=0"},
        Run{"-c grazing_curve -s grazing -o branch --both NPR=5 NMX=16 DS=-0.02", "-c grazing_curve"}}) {
    INFO(run.arguments);
    if (std::string(run.restart).find("curve") != std::string::npos)
      workspace.run("-c to_grazing -d nonimpacting -o grazing");
    workspace.run(run.arguments);
    const std::vector<PointSection> sections = workspace.points("branch");
    REQUIRE(sections.size() == 2);
    int restarts = 0;
    for (const PointSection& section : sections)
      for (std::size_t k = 1; k < section.rows.size(); ++k) {
        const PointRow& here = section.rows[k];
        if (here.label == 0) continue;
        INFO("label " << here.label);
        const std::vector<double>& before = section.rows[k - 1].values;
        double way = 0.0, on = 0.0, back = 0.0;  // of all columns, for at a turning point the first one tells nothing
        for (const auto& [step, along] : {std::pair{"0.002", &on}, std::pair{"-0.002", &back}}) {
          workspace.run(std::string(run.restart) + " -s branch -o next NMX=2 RL0=0.1 RL1=99 UZR={} THL={} IRS=" +
                        std::to_string(here.label) + " DS=" + step);
          const std::vector<double> next = workspace.points("next").front().rows.at(1).values;
          REQUIRE(next.size() == before.size());
          way = 0.0;
          for (std::size_t c = 0; c < next.size(); ++c) {
            *along += (next[c] - here.values[c]) * (here.values[c] - before[c]);
            way += (here.values[c] - before[c]) * (here.values[c] - before[c]);
          }
        }
        CHECK(way > 0.0);
        CHECK(on > 0.0);
        CHECK(back < 0.0);
        ++restarts;
      }
    CHECK(restarts >= 6);
  }
}

TEST_CASE("a restart tells where it goes") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch DS=-0.02");
  const std::string restart = "-c impacting -s branch -o next NMX=2 IRS=2 DS=";
  CHECK(contains(workspace.run(restart + "0.02").out, "DS > 0: on in the direction stored with label 2 of q.branch"));
  CHECK(contains(workspace.run(restart + "-0.02").out, "DS < 0: back against the direction stored with label 2"));
  CHECK_FALSE(contains(workspace.run(restart + "0.02 ICP=[2,61]").out, "stored"));
  CHECK_FALSE(contains(workspace.run("-c impacting -d impacting -o next NMX=2").out, "stored"));
}

TEST_CASE("a changed parameter keeps the side of the stored direction, another free parameter grows for DS > 0") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o back DS=-0.02 GRSTOP=0");
  // The branch has turned: alpha rises again where the impact velocity is negative.
  const auto solutions = workspace.solutions("back");
  const SolutionEntry* turned = nullptr;
  for (const SolutionEntry& solution : solutions)
    if (velocity(solution) < -1.0 && turned == nullptr) turned = &solution;
  REQUIRE(turned != nullptr);
  REQUIRE(turned->parameter_direction.front() > 0.0);
  const std::string restart = "-c impacting -s back -o on NMX=4 GRSTOP=0 IRS=" + std::to_string(turned->label);
  for (const double sign : {1.0, -1.0}) {
    workspace.run(restart + " PAR(zeta)=0.052 DS=" + (sign > 0.0 ? "0.02" : "-0.02"));
    const auto rows = workspace.points("on").front().rows;
    CHECK(sign * (rows[1].values.front() - rows[0].values.front()) > 0.0);
  }
  for (const char* label : {"EP1", "2", "EP2"}) {
    workspace.run(std::string("-c impacting -s back -o other NMX=3 GRSTOP=0 RL0=1 DS=0.001 ICP=[2,61] IRS=") + label);
    const auto rows = workspace.points("other").front().rows;
    CHECK(rows[1].values.front() > rows[0].values.front());
    CHECK(workspace.points("other").front().names.front() == "omega");
  }
}

TEST_CASE("a user value where the branch restarts is not met again at once") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting");
  workspace.run("-c impacting -s impacting -o on IRS=UZ1 NMX=5");
  for (const PointRow& row : rows_of(workspace.points("on"))) CHECK(row.type != -4);
}

TEST_CASE("the grazing orbit restarts with another signature") {
  const Workspace workspace;
  // Impact velocity 0: the orbit that ends with an impact and the one that ends at the maximum are the same.
  workspace.run("-c grazing -d grazing -o grazing NMX=1");
  const SolutionEntry grazing = workspace.solutions("grazing").front();
  workspace.run("-c nonimpacting_alpha -s grazing -o smooth IRS=1 NMX=4 DS=-0.01 RL1=4 UZR={}");
  const auto rows = workspace.points("smooth").front().rows;
  CHECK(rows.front().values.front() == Approx(grazing.parameter(1)).epsilon(1e-9));
  for (const PointRow& row : rows) {
    const double reached = amplitude(row.values.front(), 2.0072, zeta);
    CHECK(row.values[2] == Approx(reached).epsilon(1e-9));
    CHECK(reached < 1.0 + 1e-9);
  }
}

TEST_CASE("restart from a q-file of the older generation") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o impacting");
  const auto solutions = workspace.solutions("impacting");
  std::string text;
  for (const SolutionEntry& solution : solutions) text += older_form(solution);
  workspace.write("q.old", text);
  const Outcome table = workspace.tchat("labels q.old");
  REQUIRE(table.status == 0);
  for (const SolutionEntry& solution : solutions) {
    INFO("label " << solution.label);
    const SolutionEntry again = restarted_point(workspace, "-c impacting -s old IRS=" + std::to_string(solution.label));
    CHECK(difference(solution, again) < 2e-10);
    CHECK(first_iterations(workspace, "again") <= 1);
  }
  workspace.run("-c impacting -s old -o by_type IRS=UZ1 NMX=1");
  CHECK(workspace.solutions("by_type").front().parameter(1) == Approx(3.2).epsilon(1e-9));
}

TEST_CASE("ISW = -1 at a label that is no branch point is refused, the known branch is not followed again") {
  const Workspace workspace;
  workspace.run("-q -c impacting -d impacting -o known NMX=40 NPR=5 NTST=20");
  const std::string solutions = workspace.read("q.known");
  int leads_back = 0;
  for (int label = 2; label <= 8; ++label) {
    // The first line of an entry: BR PT TY LAB ..., six places each.
    std::ostringstream line;
    line << std::setw(6) << label << std::setw(6) << 2 << std::setw(6) << 1;  // LAB NFPR ISW
    const std::size_t at = solutions.find(line.str());
    REQUIRE(at != std::string::npos);
    std::string changed = solutions;
    changed.replace(at - 6, 6, "     6");
    workspace.write("q.known", changed);
    // From a direction that is none only many iterations come back to the known branch for sure, not by rounding.
    for (const std::string step : {"0.01", "-0.01"}) {
      const Outcome outcome = workspace.tchat(
          "run linosc -c impacting -s known -o other ISW=-1 NMX=5 NTST=20 NWTN=12 ITNW=12 DSMAX=0.5 IRS=" +
          std::to_string(label) + " DS=" + step);
      INFO(label << ", DS = " << step << "\n" << outcome.text());
      CHECK(outcome.status == 1);
      CHECK(outcome.err.find("no step") != std::string::npos);
      CHECK_FALSE(workspace.has("p.other"));
      leads_back += outcome.err.find("leads away from the branch") != std::string::npos;
    }
  }
  CHECK(leads_back >= 1);
}
