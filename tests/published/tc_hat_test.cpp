// TC-HAT's way of working: the Makefile of Appendix A, the constants file of Appendix B, the MEMS oscillator in
// Fortran. Values by shooting, and the same chain with the C++ problem, whose derivatives are exact.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "published/chain.hpp"
#include "settings/sample_files.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

/// A copy of problems/mems_fortran with TC-HAT's commands on PATH.
class TcHatFolder {
 public:
  TcHatFolder() {
    for (const auto& entry : fs::directory_iterator(PROBLEMS "/mems_fortran"))
      if (entry.is_regular_file()) fs::copy_file(entry.path(), file(entry.path().filename().string()));
  }

  Outcome shell(const std::string& command) const {
    const std::string script = "PATH=$PATH:'" SCRIPTS "'; export PATH TCHAT='" TCHAT_EXECUTABLE "'; " + command;
    return Process({"/bin/sh", "-c", script}, folder_.file(""), logs_.file(std::to_string(++runs_)))
        .wait(std::chrono::seconds(200));
  }
  void succeed(const std::string& command) const {
    const Outcome outcome = shell(command);
    INFO(command << '\n' << outcome.text());
    REQUIRE(outcome.status == 0);
  }

  std::string file(const std::string& name) const { return folder_.file(name); }
  bool has(const std::string& name) const { return folder_.has(name); }
  std::string read(const std::string& name) const { return folder_.read(name); }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  PointSection points(const std::string& name) const { return read_points(read("p." + name)).at(0); }

  /// Files of that beginning in the folder.
  int count(const std::string& beginning) const {
    int found = 0;
    for (const auto& entry : fs::directory_iterator(folder_.file("")))
      found += entry.path().filename().string().starts_with(beginning) ? 1 : 0;
    return found;
  }

 private:
  TemporaryFolder folder_, logs_;
  mutable int runs_ = 0;
};

void check_near(double found, double expected, double tolerance) {
  CAPTURE(found, expected);
  CHECK(std::abs(found - expected) <= tolerance);
}

/// The value in column `wanted` of the row whose column `where` is nearest to `at`.
double value_at(const PointSection& section, const std::string& where, double at, const std::string& wanted) {
  const std::size_t key = section.column(where);
  const PointRow* nearest = &section.rows.front();
  for (const PointRow& row : section.rows)
    if (std::abs(row.values[key] - at) < std::abs(nearest->values[key] - at)) nearest = &row;
  check_near(nearest->values[key], at, 1e-9);
  return nearest->values[section.column(wanted)];
}

/// ICP(1) at the first row of a type number.
double first_of_type(const PointSection& section, int type) {
  for (const PointRow& row : section.rows)
    if (row.type == type) return row.values[0];
  FAIL("no point of type " << type);
  return 0.0;
}

/// Appendix A's four steps, and what they must leave.
void run_makefile(const TcHatFolder& folder) {
  folder.succeed("make -j2");
  for (const char* step : {"1", "2", "3", "4"})
    for (const char* letter : {"p.mems.", "q.mems.", "d.mems.", "r.mems."})
      CHECK(folder.has(std::string(letter) + step));
  CHECK(folder.count("fort.") == 0);
  for (const char* removed : {"gc.mems", "q.mems", "mems.f", "mems.dat", "p.fort"}) CHECK_FALSE(folder.has(removed));
}

}  // namespace

TEST_CASE("Appendix A's Makefile with the Fortran problem: values found by shooting, and those of the C++ problem") {
  const TcHatFolder fortran;
  CHECK(fortran.read("gc.mems.2") == tchat::testing::appendix_b());
  run_makefile(fortran);
  CHECK(fortran.read("d.mems.4").find("Second derivatives are central differences") != std::string::npos);

  // Forward integration agrees; step 2 has NCOL = 2, so errors are of fourth order in 1/50.
  for (const char* labels : {"q.mems.1", "q.mems.2 PD1 LP1 GR1 --tolerance 2e-5", "q.mems.3", "q.mems.4"})
    fortran.succeed(std::string("\"$TCHAT\" verify -p mems ") + labels);

  // Step 1, the grazing curve.
  const PointSection grazing = fortran.points("mems.1");
  check_near(value_at(grazing, "PAR(2)", 0.56, "PAR(1)"), 0.532126908360, 1e-8);
  check_near(value_at(grazing, "PAR(2)", 0.60, "PAR(1)"), 0.573896440745, 1e-8);
  check_near(value_at(grazing, "PAR(2)", 0.64, "PAR(1)"), 0.591556762123, 1e-8);
  check_near(value_at(grazing, "PAR(2)", 0.70, "PAR(1)"), 0.600363015628, 1e-8);
  double nearest = 1.0;  // to the zero of xi_1
  for (const PointRow& row : grazing.rows)
    if (row.type == -4) nearest = std::min(nearest, std::abs(row.values[0] - 0.613649461804));
  CHECK(nearest < 1e-8);

  // Step 2, Appendix B: NCOL = 2, so errors are of fourth order in 1/50.
  const PointSection impacting = fortran.points("mems.2");
  check_near(first_of_type(impacting, 7), 0.72439826618, 1e-6);
  check_near(first_of_type(impacting, 5), 0.84723210893, 1e-6);
  check_near(impacting.rows.back().values[0], 0.74694282418, 1e-6);  // secondary grazing

  // Step 4, the fold curve from the preparatory run of step 3.
  const PointSection folds = fortran.points("mems.4");
  check_near(value_at(folds, "PAR(2)", 0.86, "PAR(1)"), 0.92376437612, 1e-8);

  // The same with the C++ problem, which has no durations among its starting values.
  const TcHatFolder cpp;
  fs::copy_file(PROBLEMS "/mems/mems.cpp", cpp.file("mems.cpp"));
  for (const char* data : {"mems.dat.1", "mems.dat.2"})
    cpp.write(data, "# PAR(1) = 0.597984349382\n# PAR(2) = 0.8\n# PAR(61) = 3.926990816987\n# PAR(62) = 0\n" +
                        cpp.read(data));
  run_makefile(cpp);
  for (const char* step : {"mems.1", "mems.2", "mems.3", "mems.4"}) {
    const PointSection ours = fortran.points(step);
    const PointSection theirs = cpp.points(step);
    REQUIRE(ours.rows.size() == theirs.rows.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < ours.rows.size(); ++k) {
      CHECK(ours.rows[k].point == theirs.rows[k].point);
      CHECK(ours.rows[k].type == theirs.rows[k].type);
      for (std::size_t c = 0; c < ours.rows[k].values.size(); ++c) {
        // Where a maximum of the sines falls on the adapted mesh is not a result.
        if (ours.names[c] == "MAX U(4)" || ours.names[c] == "MAX U(5)") continue;
        largest = std::max(largest, std::abs(ours.rows[k].values[c] - theirs.rows[k].values[c]));
      }
    }
    INFO(step);
    CHECK(largest < 1e-8);
  }
}

TEST_CASE("@gc with constants on the command line, GCIDIFF 0 to 2: folds and period doublings to 1e-9") {
  const TcHatFolder folder;
  folder.succeed("cp gc.mems.2 gc.mems; cp mems.f.2 mems.f; cp mems.dat.2 mems.dat; @gmdat mems NCOL=4");
  const std::string order = GENERATE("0", "1");
  folder.succeed("@gc mems NCOL=4 NPR=0 DSMAX=0.05 GCIDIFF=" + order + " && @sv one");
  const PointSection points = folder.points("one");
  check_near(first_of_type(points, 7), 0.72439826618, 1e-9);
  check_near(first_of_type(points, 5), 0.84723210893, 1e-9);
  check_near(points.rows.back().values[0], 0.74694282418, 1e-9);
}

TEST_CASE("TC-HAT's commands: what they leave, keep and refuse") {
  const TcHatFolder folder;
  CHECK(folder.shell("@gc mems").status == 2);
  CHECK(folder.shell("@sv one").status == 2);
  folder.succeed("cp gc.mems.1 gc.mems; cp mems.f.1 mems.f; cp mems.dat.1 mems.dat; @gmdat mems; @gc mems NMX=3");
  for (const char* file : {"fort.2", "fort.3", "fort.7", "fort.8", "fort.9"}) CHECK(folder.has(file));
  CHECK(folder.read("fort.3") == folder.read("q.mems"));
  CHECK_FALSE(folder.has("p.fort"));
  const Outcome table = folder.shell("@lb");
  CHECK(table.out.find("EP") != std::string::npos);

  const std::string points = folder.read("fort.7");
  folder.succeed("@sv one");
  CHECK(folder.read("p.one") == points);
  CHECK_FALSE(folder.has("fort.7"));
  CHECK(folder.has("fort.2"));
  CHECK(folder.read("r.one") == folder.read("fort.2"));

  folder.succeed("@gc mems NMX=2 && @ap one");  // appended, the files before kept
  CHECK(folder.read("p.one~") == points);
  CHECK(folder.read("p.one").starts_with(points));
  CHECK(folder.read("p.one").size() > points.size());
  CHECK(folder.shell("@lb one").status == 0);
  folder.succeed("@cp one two && @mv two three && @ap one three");
  CHECK_FALSE(folder.has("q.two"));
  CHECK(folder.read("q.three~") == folder.read("q.one"));
  folder.succeed("@dl three && @cl");
  CHECK_FALSE(folder.has("p.three"));
  CHECK(folder.count("fort.") == 0);
  CHECK(folder.has("p.one"));

  // A failed run stops a chain; STOP and errors of the compiler are shown.
  const std::string source = folder.read("mems.f");
  const auto failing = [&](const std::string& old, const std::string& text) {
    std::string changed = source;
    changed.replace(changed.find(old), old.size(), text);
    folder.write("mems.f", changed);
    const Outcome outcome = folder.shell("@gc mems && @sv never");
    CHECK(outcome.status == 2);
    CHECK_FALSE(folder.has("p.never"));
    return outcome.text();
  };
  CHECK(failing("FI(2)=X(3)", "FI(2)=X(3").find("FI(2)=X(3") != std::string::npos);
  CHECK(failing("RADIUS=X(4)", "IF (X(3).NE.0.5D0) STOP\n      RADIUS=X(4)").find("STOP in Fortran") !=
        std::string::npos);
  CHECK(failing("FI(2)=X(3)", "FJ2=X(3)").find("leaves FI(2) unset") != std::string::npos);
  CHECK(failing("INCLUDE 'mems.h'", "INCLUDE 'mens.h'").find("mens.h") != std::string::npos);
}

TEST_CASE("any of PAR(1..60) may belong to a Fortran problem, which does not say how many it has") {
  const TcHatFolder folder;
  folder.succeed("for file in gc.mems mems.f mems.dat; do cp $file.1 $file; done");
  folder.succeed("\"$TCHAT\" run mems -d mems IRS=0 'PAR(12)=3.5' 'UZR={11: 3}' NMX=1 -q");
  CHECK(folder.shell("\"$TCHAT\" run mems -d mems IRS=0 'PAR(63)=1' NMX=1 -q").status == 2);
}

TEST_CASE("tchat check names the wrong derivative of a Fortran problem") {
  const TcHatFolder folder;
  folder.succeed("cp gc.mems.2 gc.mems; sed 's/DFIDX(3,5)=/DFIDX(3,4)=/' mems.f.1 >mems.f");
  const Outcome outcome = folder.shell("\"$TCHAT\" check mems --state 0,0.2,0.1,0,1");
  CHECK(outcome.status == 1);
  CHECK(outcome.out.find("d f_1[U(3)] / d U(4)") != std::string::npos);
  CHECK(outcome.out.find("d f_2[U(3)] / d U(5)") != std::string::npos);
  folder.succeed("cp mems.f.1 mems.f; \"$TCHAT\" check mems; \"$TCHAT\" check mems -c gc.mems.1");
}
