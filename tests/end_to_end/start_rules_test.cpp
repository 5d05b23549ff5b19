// What a run starts from: IRS, -d, -s and their defaults; what it may replace; where it ends.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <catch2/catch.hpp>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Short branches: few points, a coarse mesh.
const std::string quick = " NTST=20 NMX=12 NPR=4 ";

void check_refusal(const Outcome& outcome, const std::vector<std::string>& parts) {
  INFO(outcome.text());
  CHECK(outcome.signal == 0);
  CHECK(outcome.status == 2);
  for (const std::string& part : parts) {
    INFO("expected: " << part);
    CHECK(contains(outcome.err, part));
  }
}

}  // namespace

TEST_CASE("IRS chooses a label by number or by type and count") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NTST=20");
  const auto solutions = workspace.solutions("branch");
  const auto alpha_at = [&](const std::string& label) {
    workspace.run("-c impacting -s branch -o chosen NTST=20 NMX=1 IRS=" + label);
    return workspace.solutions("chosen").front().parameter(1);
  };
  CHECK(alpha_at("UZ1") == Approx(3.2).epsilon(1e-9));
  CHECK(alpha_at("EP1") == Approx(solutions.front().parameter(1)).epsilon(1e-9));
  CHECK(alpha_at("EP2") == Approx(solutions.back().parameter(1)).epsilon(1e-9));
  CHECK(alpha_at("RG1") == Approx(with_label(solutions, 2).parameter(1)).epsilon(1e-9));
  CHECK(alpha_at("2") == Approx(with_label(solutions, 2).parameter(1)).epsilon(1e-9));

  for (const char* missing : {"77", "PD1", "UZ2", "EP3"}) {
    INFO(missing);
    const Outcome refused = workspace.tchat("run linosc -c impacting -s branch -o none IRS=" + std::string(missing));
    check_refusal(refused, {"q.branch", missing, "1 (EP)", "2 (RG)", "4 (UZ)"});
    CHECK_FALSE(workspace.has("p.none"));
  }
}

TEST_CASE("options -d, -s and IRS that contradict each other") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch" + quick);
  check_refusal(workspace.tchat("run linosc -c impacting -d impacting -o none IRS=2"), {"IRS = 2", "label 1"});
  check_refusal(workspace.tchat("run linosc -c impacting -d impacting -o none IRS=UZ1"), {"UZ1", "label 1"});
  check_refusal(workspace.tchat("run linosc -c impacting -s branch -o none"), {"q.branch", "IRS", "1 (EP)", "2 (RG)"});
  check_refusal(workspace.tchat("run linosc -c impacting -s branch -d impacting -o none IRS=1"), {"-d", "-s"});
  check_refusal(workspace.tchat("run linosc -c impacting -o none IRS=3"), {"IRS = 3", "q.linosc"});
  CHECK_FALSE(workspace.has("p.none"));
  // As label 1 the data are a restart: the first point has no label, counting goes on from 1.
  workspace.run("-c impacting -d impacting -o data IRS=1" + quick);
  CHECK(workspace.points("data").front().rows.front().label == 0);
  CHECK(labels_of(workspace.points("data")).front() == 2);
}

TEST_CASE("without -d and -s: q.NAME when IRS > 0 and it exists, else NAME.dat") {
  const Workspace workspace;
  workspace.write("linosc.dat", workspace.read("impacting.dat"));
  workspace.write("gc.linosc", workspace.read("gc.impacting"));
  workspace.run("NTST=20 IRS=1 NMX=1 -o from_data");
  CHECK(workspace.solutions("from_data").front().parameter(1) == Approx(3.048525879).epsilon(1e-8));
  workspace.run("NTST=20");
  CHECK(labels_of(workspace.points("linosc")).front() == 1);
  workspace.run("NTST=20 IRS=UZ1 NMX=1 -o from_label");
  CHECK(workspace.solutions("from_label").front().parameter(1) == Approx(3.2).epsilon(1e-9));
  workspace.run("NTST=20 IRS=0 NMX=1 -o from_data");
  CHECK(workspace.solutions("from_data").front().parameter(1) == Approx(3.048525879).epsilon(1e-8));
}

TEST_CASE("the start file is replaced only where -o says so, and its predecessor is kept") {
  const Workspace workspace;
  workspace.write("linosc.dat", workspace.read("impacting.dat"));
  workspace.write("gc.linosc", workspace.read("gc.impacting"));
  workspace.run(quick);
  const std::string before = workspace.read("q.linosc");
  check_refusal(workspace.tchat("run linosc IRS=2" + quick), {"q.linosc", "-o linosc"});
  check_refusal(workspace.tchat("run linosc -s linosc IRS=2" + quick), {"q.linosc", "-o linosc"});
  CHECK(workspace.read("q.linosc") == before);
  CHECK_FALSE(workspace.has("q.linosc~"));
  workspace.run("-s linosc -o linosc IRS=2" + quick);
  CHECK(workspace.read("q.linosc~") == before);
  CHECK(workspace.solutions("linosc").front().label == labels_of(read_solutions(before)).back() + 1);
}

TEST_CASE("paths name constants, data and start files") {
  const Workspace workspace;
  workspace.run("-c ./gc.impacting -d ./impacting.dat -o branch" + quick);
  workspace.run("-c gc.impacting -s ./q.branch -o again IRS=2" + quick);
  workspace.run("-c ./impacting -s " + workspace.file("q.branch") + " -o absolute IRS=2" + quick);
  CHECK(workspace.read("p.again") == workspace.read("p.absolute"));
}

TEST_CASE("r.O as constants of the next run") {
  const Workspace workspace;
  workspace.run({"-c", "impacting", "-d", "impacting", "-o", "one", "NTST=20", "NMX=9", "DS=0.03",
                 "UZR={1:[3.06,3.07]}", "STOP=[UZ2]", "IPLT=2", "THU={3: 0.5}"});
  workspace.run("-c r.one -d impacting -o two");
  CHECK(workspace.read("p.one") == workspace.read("p.two"));
  CHECK(workspace.read("q.one") == workspace.read("q.two"));
  CHECK(workspace.read("r.one") == workspace.read("r.two"));
  workspace.run("-c impacting -s one -o three IRS=UZ1 NTST=20 NMX=5");
  workspace.run("-c r.three -s one -o four");
  CHECK(workspace.read("p.three") == workspace.read("p.four"));
}

TEST_CASE("parameters by name or by index: the same run") {
  const Workspace workspace;
  workspace.run("-c nonimpacting_omega -d nonimpacting -o index ICP=[2,61] UZR={2:1.5}");
  workspace.run("-c nonimpacting_omega -d nonimpacting -o name ICP=[omega,61] UZR={omega:1.5}");
  CHECK(workspace.read("p.name") == workspace.read("p.index"));
  CHECK(workspace.read("r.name") == workspace.read("r.index"));
  const Outcome refused =
      workspace.tchat("run linosc -c nonimpacting_omega -d nonimpacting -o none ICP=[frequency,61]");
  CHECK(refused.status == 2);
  CHECK(refused.err.find("frequency") != std::string::npos);
  CHECK(refused.err.find("alpha, omega, zeta, r") != std::string::npos);
  CHECK_FALSE(workspace.has("p.none"));
  // A name takes no index away from those that stand beside it.
  const Outcome beside = workspace.run("-c nonimpacting_omega -d nonimpacting -o beside ICP=[omega,60,61] NMX=2");
  CHECK(beside.err.find("PAR(60) is no parameter") != std::string::npos);
  // Names in the file, other constants on the command line.
  workspace.write("gc.named", "NDIM = 4\nICP = [omega, 61]\nGCHIND = [2]\nGCGIND = [2]\nGCSEGTYP = [0]\n");
  workspace.run("-c named -d nonimpacting -o both_ways NMX=2");
  for (const char* other : {"dat nonimpacting -c named -p linosc -o label THL={omega:0.5}",
                            "resegment q.both_ways 1 --to double -c named -p linosc -o double"}) {
    const Outcome outcome = workspace.tchat(other);
    INFO(outcome.text());
    CHECK(outcome.status == 0);
  }
  CHECK(workspace.read("gc.double").find("ICP = [2, 61") != std::string::npos);
}

TEST_CASE("events that may come next but are not monitored cause a warning with the cure") {
  const Workspace workspace;
  const std::string run = "run linosc -c nonimpacting_alpha -d nonimpacting -o branch" + quick;
  CHECK(workspace.tchat(run).err.empty());
  const Outcome blind = workspace.tchat(run + "GCHGRZIND=[[]] GCIPSI=[]");
  INFO(blind.text());
  CHECK(blind.status == 0);
  CHECK(contains(blind.err, "event 1 (wall) on segment 1 may come next"));
  CHECK(contains(blind.err, "GCHGRZIND=[[1]]"));
}

TEST_CASE("bounds of the constants file that come to bound another parameter are told") {
  const Workspace workspace;
  const std::string run = "run linosc -c impacting -d impacting -o branch ICP=omega" + quick;
  const Outcome inherited = workspace.tchat(run + "DS=0.001");
  INFO(inherited.text());
  CHECK(contains(inherited.err, "was given for alpha and now bounds omega"));
  CHECK(contains(inherited.err, "RL1 = "));
  CHECK(workspace.tchat(run + "RL0=1.9 RL1=2.1 DS=0.001").err.empty());
}

TEST_CASE("parameters beyond the free one are told where the curve of the label may have been meant") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NTST=20 DS=-0.01 NMX=200");
  const std::string run = "run linosc -c impacting -s branch -o more IRS=PD1 ICP=[1,2]" + quick;
  const Outcome idle = workspace.tchat(run);
  INFO(idle.text());
  CHECK(contains(idle.err, "omega of ICP stays fixed with ISW = 1"));
  CHECK(contains(idle.err, "ISW=2"));
  CHECK(workspace.tchat(run + "ISW=2 DS=0.001 NMX=3").err.empty());
}

TEST_CASE("the jump that contact brings must be there, and no identity where xi_n are asked for") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  const std::string run = "run linosc -c grazing_curve -s grazing -o curve IRS=GR1 NMX=3 NTST=20 ";
  check_refusal(workspace.tchat(run + "GRJUMP=9"), {"GRJUMP is 9", "allowed: 1..2"});
  const Outcome identity = workspace.tchat(run + "GRJUMP=2");
  INFO(identity.text());
  CHECK(contains(identity.err, "GRJUMP = 2 (identity) is the identity"));
  CHECK_FALSE(contains(identity.out, "xi_1"));
  CHECK(workspace.tchat(run).err.empty());
}

TEST_CASE("a run starts from the trajectory of a simulation, and from the table of another program") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch NTST=20 NMX=1");
  const SolutionEntry orbit = workspace.solutions("branch").front();
  const std::string parameters = fmt::format("PAR(alpha)={:.17g}", orbit.parameter(1));
  REQUIRE(workspace.tchat("simulate linosc -q --transient-time 300 -o motion PAR(omega)=2.0072 " + parameters).status ==
          0);
  const auto check = [&](const std::string& data) {
    const Outcome outcome = workspace.tchat("run linosc -c impacting -o from NTST=20 NMX=1 IRS=0 -d " + data);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
    const SolutionEntry found = workspace.solutions("from").front();
    CHECK(found.parameter(1) == Approx(orbit.parameter(1)).epsilon(1e-9));  // tables have ten digits
    CHECK(found.parameter(61) == Approx(orbit.parameter(61)).epsilon(1e-9));
    for (std::size_t k = 0; k < 4; ++k) CHECK(found.states.front()[k] == Approx(orbit.states.front()[k]).margin(1e-8));
  };
  check("motion.trajectory");
  REQUIRE(workspace.tchat_redirected("orbit q.branch 1", "> table").status == 0);
  check("table");

  // The period starts in mid-flight; t repeats at the impact.
  std::string rows = fmt::format("# PAR(omega) = 2.0072\n# PAR(alpha) = {:.17g}\nt x1 x2 y1 y2\n", orbit.parameter(1));
  const std::size_t nodes = orbit.t.size();
  const auto add = [&](std::size_t k, double shift) {
    rows +=
        fmt::format("{:.17g} {:.17g}\n", (orbit.t[k] + shift) * orbit.parameter(61), fmt::join(orbit.states[k], " "));
  };
  for (std::size_t k = nodes / 2; k < nodes; ++k) add(k, 0.0);
  for (std::size_t k = 0; k <= nodes / 2; ++k) add(k, 1.0);
  workspace.write("other.dat", rows);
  check("other");
}

TEST_CASE("tables that do not fit the signature are refused") {
  const Workspace workspace;
  const std::string start = "# PAR(omega) = 2.0072\n";
  workspace.write("twice.dat", start + "0 1 -1 0 1\n1 0 0 1 0\n1 0.5 0 1 0\n2 1 1 0 1\n2 1 -1 0 1\n3 0 0 1 0\n");
  check_refusal(workspace.tchat("run linosc -c impacting -d twice -o none IRS=0"),
                {"twice.dat:4", "repeated 2 times", "3 segments"});
  workspace.write("same.dat", start + "0 1 -1 0 1\n1 0 0 1 0\n1 0 0 1 0\n2 1 1 0 1\n");
  check_refusal(workspace.tchat("run linosc -c impacting -d same -o none IRS=0"), {"same.dat:4", "repeats"});
  REQUIRE(workspace.tchat("simulate linosc -q --time 5 -o short --signature 1,1,1").status == 0);
  check_refusal(workspace.tchat("run linosc -c impacting -d short.trajectory -o none IRS=0 GCHIND=[2]"),
                {"short.trajectory", "{(1,2,1)}"});
}
