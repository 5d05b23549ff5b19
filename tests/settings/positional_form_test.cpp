#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "base/messages.hpp"
#include "settings/constants_file.hpp"
#include "settings/sample_files.hpp"
#include "settings/settings_check.hpp"
#include "settings/settings_type.hpp"

using namespace tchat;
using tchat::testing::appendix_b;
using tchat::testing::appendix_b_with;
using tchat::testing::same_constants;
using Ints = std::vector<int>;

namespace {

int no_names(const std::string&, const std::string&) { return names_a_monitor; }

RunSettings read(const std::string& text) { return read_constants_text(text, "gc.test"); }

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

/// A file in the system's temporary folder that goes with the test.
struct TemporaryFile {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "tchat_constants_test_gc.mems";
  explicit TemporaryFile(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  ~TemporaryFile() { std::filesystem::remove(path); }
};

}  // namespace

TEST_CASE("Appendix B reads character for character", "[constants]") {
  const TemporaryFile file(appendix_b());
  Warnings warnings;
  const RunSettings s = read_constants_file(file.path.string(), &warnings);
  CHECK(warnings.empty());
  CHECK(s.dimension == 5);
  CHECK(s.problem_type == 180);
  CHECK(s.start.type.empty());
  CHECK(s.start.number == 1);
  CHECK(s.detect_folds == 1);
  CHECK(s.free_parameters == Ints{1, 61, 62});
  CHECK(s.mesh_intervals == 50);
  CHECK(s.collocation_points == 2);
  CHECK(s.adapt_mesh_every == 3);
  CHECK(s.detect_bifurcations == 2);
  CHECK(s.branch_mode == 1);
  CHECK(s.measure == 0);
  CHECK(s.boundary_conditions == 0);
  CHECK(s.integral_conditions == 0);
  CHECK(s.max_points == 1000);
  CHECK(s.parameter_min == 0.0);
  CHECK(s.parameter_max == 1.0);
  CHECK(s.measure_min == 0.0);
  CHECK(s.measure_max == 100.0);
  CHECK(s.print_every == 1);
  CHECK(s.max_bifurcations == 0);
  CHECK(s.diagnostics_level == 2);
  CHECK(s.max_location_iterations == 10);
  CHECK(s.max_newton == 8);
  CHECK(s.full_newton == 3);
  CHECK(s.jacobian == 0);
  CHECK(s.tolerance_parameters == 1e-10);
  CHECK(s.tolerance_states == 1e-10);
  CHECK(s.tolerance_special == 1e-10);
  CHECK(s.step == 1e-4);
  CHECK(s.step_min == 0.0);
  CHECK(s.step_max == 0.005);
  CHECK(s.adapt_step_every == 1);
  REQUIRE(s.parameter_weights.size() == 2);
  CHECK(s.parameter_weights[0].index == 61);
  CHECK(s.parameter_weights[1].index == 62);
  CHECK(s.parameter_weights[1].value == 0.0);
  CHECK(s.state_weights.empty());
  CHECK(s.user_values.empty());
  CHECK(s.grazing_start == 0);
  CHECK(s.derivative_order == 1);
  CHECK(s.test_functions == Ints{1, 2, 3});
  CHECK(s.fixed.empty());
  REQUIRE(s.segments.size() == 2);
  CHECK(s.segments[0].type == 1);
  CHECK(s.segments[1].type == 0);
  CHECK(s.segments[0].index == IndexVector{1, 1, 1});
  CHECK(s.segments[1].index == IndexVector{2, 2, 2});
  CHECK(s.segments[0].monitor == Ints{1});
  CHECK(s.segments[1].monitor == Ints{2, 1});
  CHECK(s.stop_at_grazing);
  CHECK(s.grazing_jump == 1);
  CHECK(s.stop_rules.empty());
}

TEST_CASE("Separators, exponents and line ends of the positional form are list-directed", "[constants]") {
  const RunSettings expected = read(appendix_b());
  SECTION("CRLF") { CHECK(same_constants(read(replaced(appendix_b(), "\n", "\r\n")), expected)); }
  SECTION("lone carriage returns") { CHECK(same_constants(read(replaced(appendix_b(), "\n", "\r")), expected)); }
  SECTION("no final newline") {
    std::string text = appendix_b();
    text.pop_back();
    CHECK(same_constants(read(text), expected));
  }
  SECTION("no final newline nor commentary") {
    CHECK(same_constants(read(replaced(appendix_b(), "\tGCHNO(2), (GCHGRZIND(I+GCHNO(1)), I=1, GCHNO(2))\n", "")),
                         expected));
  }
  SECTION("byte order mark") { CHECK(same_constants(read("\xEF\xBB\xBF" + appendix_b()), expected)); }
  SECTION("blank lines before, between, after") {
    CHECK(same_constants(read("\n  \n" + replaced(appendix_b(), "\n", "\n\n") + "\n\n"), expected));
  }
  SECTION("commas, tabs and signs") {
    CHECK(same_constants(read(appendix_b_with(1, "  +5,180 ,\t1 , 1, NDIM")), expected));
  }
  SECTION("a record over several lines, the comma at either end") {
    CHECK(same_constants(read(appendix_b_with(3, "50 2 3\n2,\n1\n, 0 0 0 NTST")), expected));
  }
  SECTION("repeats") {
    CHECK(same_constants(read(appendix_b_with(3, "50 2 3 2 1 3*0")), expected));
    CHECK(same_constants(read(appendix_b_with(6, "3*1d-10")), expected));
    CHECK(same_constants(read(appendix_b_with(3, "50 2 3 2 1 2*0\n0 rest")), expected));
  }
  SECTION("repeats end with their record") {
    CHECK(same_constants(read(appendix_b_with(6, "999999999*1d-10")), expected));
  }
  SECTION("exponent letters and decimal points") {
    CHECK(same_constants(read(appendix_b_with(6, "1D-10 1.0d-10 .1E-9")), expected));
    CHECK(same_constants(read(appendix_b_with(7, "+1.d-4 0 5e-03 1")), expected));
  }
  SECTION("a slash after the last value is commentary") {
    CHECK(same_constants(read(appendix_b_with(1, "5 180 1 1/ NDIM")), expected));
  }
  SECTION("commentary beside a zero count") {
    CHECK(same_constants(read(appendix_b_with(11, "0 / no weights")), expected));
  }
}

TEST_CASE("Each pair is a record of its own", "[constants]") {
  const RunSettings s =
      read(appendix_b_with(12, "3 three values\n1 0.25 first\n-1,0.75 stop here\n61\n4.5D0 over two lines"));
  REQUIRE(s.user_values.size() == 3);
  CHECK(s.user_values[0].parameter == 1);
  CHECK(s.user_values[0].value == 0.25);
  CHECK_FALSE(s.user_values[0].stop);
  CHECK(s.user_values[1].parameter == 1);
  CHECK(s.user_values[1].value == 0.75);
  CHECK(s.user_values[1].stop);
  CHECK(s.user_values[2].parameter == 61);
  CHECK(s.user_values[2].value == 4.5);
  const RunSettings t = read(appendix_b_with(11, "1\n3 0.5"));
  REQUIRE(t.state_weights.size() == 1);
  CHECK(t.state_weights[0].index == 3);
  CHECK(t.state_weights[0].value == 0.5);
}

TEST_CASE("The start may be a type with a count", "[constants]") {
  const RunSettings s = read(appendix_b_with(1, "5 180 pd2 1"));
  CHECK(s.start.type == "PD");
  CHECK(s.start.number == 2);
  CHECK_FALSE(s.start.from_data());
  CHECK(read(appendix_b_with(1, "5 180 0 1")).start.from_data());
  for (const std::string type : {"BP", "LP", "PD", "TR", "UZ", "GR", "XI", "EP", "MX", "RG"})
    CHECK(read(appendix_b_with(1, "5 180 " + type + "12 1")).start.type == type);
}

TEST_CASE("Extension constants follow the last record", "[constants]") {
  const RunSettings s =
      read(appendix_b() + "\n# more\nGRSTOP = 0, grjump=2   # jump of contact\nSTOP = ['PD1', gr3]\n");
  CHECK_FALSE(s.stop_at_grazing);
  CHECK(s.grazing_jump == 2);
  REQUIRE(s.stop_rules.size() == 2);
  CHECK(s.stop_rules[0].type == "PD");
  CHECK(s.stop_rules[0].count == 1);
  CHECK(s.stop_rules[1].type == "GR");
  CHECK(s.stop_rules[1].count == 3);
}

TEST_CASE("Branch modes and problem types that a run may refuse are read", "[constants]") {
  CHECK(read(appendix_b_with(3, "50 2 3 2 0 0 0 0")).branch_mode == 1);
  CHECK(read(appendix_b_with(3, "50 2 3 2 -1 0 0 0")).branch_mode == -1);
  std::string locus = appendix_b_with(3, "50 2 3 2 2 0 0 0");
  CHECK(read(replaced(locus, "3 1 61 62\t", "4 1 2 61 62\t")).branch_mode == 2);
  const std::string grazing = replaced(appendix_b(), "5 180 1 1\t", "5 150 0 1\t");
  CHECK(read(replaced(grazing, "3 1 61 62\t", "2 2 1\t")).problem_type == 150);
}

TEST_CASE("A switch may weigh the durations of the doubled orbit", "[constants]") {
  const std::string switching = appendix_b_with(3, "50 2 3 2 -1 0 0 0");
  CHECK(read(replaced(switching, "62 0.0\t", "64 0.0\t")).parameter_weights[1].index == 64);
  RunSettings beyond = read(replaced(switching, "62 0.0\t", "65 0.0\t"));
  CHECK_THROWS_WITH(resolve_names(beyond, ParameterLayout(), no_names), Catch::Contains("ITHL"));
}

TEST_CASE("Durations follow more than 60 parameters", "[constants]") {
  const auto with_indices = [](const std::string& icp, int parameters) {
    RunSettings s = read(appendix_b_with(2, icp));
    resolve_names(s, ParameterLayout(parameters), no_names);
    return s;
  };
  CHECK(free_problem_parameters(with_indices("3 61 101 102", 100)) == Ints{61});
  CHECK(active_parameters(with_indices("1 100", 100)) == Ints{100, 101, 102});
  CHECK(active_parameters(with_indices("1 1", 61)) == Ints{1, 62, 63});
  CHECK_THROWS_WITH(with_indices("3 1 101 103", 100),
                    Catch::Contains("gc.test:2: ICP(3)") &&
                        Catch::Contains("1 to 100 (parameters of the problem) or 101 to 102 (durations"));
  CHECK_THROWS_WITH(with_indices("2 101 102", 100), Catch::Contains("0 parameters that are not durations"));
}

TEST_CASE("Suspicious but legal text is reported", "[constants]") {
  Warnings warnings;
  read_constants_text(appendix_b_with(2, "3 1 61 62 63 NICP"), "gc.test", &warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("gc.test:2: '63'") == 0);
  warnings.clear();
  read_constants_text(appendix_b() + "written in autumn\n", "gc.test", &warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("gc.test:22: ignored: 'written in autumn'") == 0);
  warnings.clear();
  read_constants_text(appendix_b_with(16, "2 2 0 GCNOSEG"), "gc.test", &warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("GCSEGTYP(1) = 2") != std::string::npos);
}
