#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/sample_files.hpp"
#include "settings/settings_check.hpp"

using namespace tchat;
using Ints = std::vector<int>;

namespace {

RunSettings appendix() { return read_constants_text(testing::appendix_b(), "gc.test"); }

RunSettings with(const std::vector<std::string>& overrides) {
  RunSettings s = appendix();
  apply_overrides(s, overrides);
  return s;
}

}  // namespace

TEST_CASE("Overrides replace one constant and leave the rest", "[constants]") {
  RunSettings expected = appendix();
  expected.step = -0.01;
  CHECK(testing::same_constants(with({"DS=-0.01"}), expected));
  CHECK(testing::same_constants(with({"ds = -1d-2"}), expected));
  expected.max_points = 50;
  CHECK(testing::same_constants(with({"DS=-0.01", "NMX=50"}), expected));
  CHECK(testing::same_constants(with({"NMX=70", "DS=-0.01, NMX=50"}), expected));
  CHECK(with({"NTST=80"}).mesh_intervals == 80);
}

TEST_CASE("Overrides of lists", "[constants]") {
  CHECK(with({"ICP=[2,61]"}).free_parameters == Ints{2, 61});
  CHECK(with({"ICP=2,61"}).free_parameters == Ints{2, 61});
  CHECK(with({"ICP=2 61"}).free_parameters == Ints{2, 61});
  CHECK(with({"ICP=2"}).free_parameters == Ints{2});
  CHECK(with({"ICP=[2,61]", "NICP=2"}).free_parameters == Ints{2, 61});
  const RunSettings s = with({"UZR={1: [2.5, 3.0], -2: 4}", "THL={61: 0}"});
  REQUIRE(s.user_values.size() == 3);
  CHECK(s.user_values[1].value == 3.0);
  CHECK(s.user_values[2].parameter == 2);
  CHECK(s.user_values[2].stop);
  REQUIRE(s.parameter_weights.size() == 1);
  CHECK(s.parameter_weights[0].index == 61);
  CHECK(with({"THL={}"}).parameter_weights.empty());
  CHECK(with({"GCIPSI=[]"}).test_functions.empty());
}

TEST_CASE("Names of parameters in the place of their indices", "[constants]") {
  const ParameterNames names = [](const std::string& name, const std::string& where) {
    if (name != "omega" && name != "alpha") throw UserError(where + ": no such name");
    return name == "omega" ? 2 : 1;
  };
  RunSettings s = with({"ICP=[omega, alpha, 61]", "UZR={omega: [1.5, 2], -alpha: 3}", "THL={omega: 0.5}"});
  CHECK(s.names.size() == 2);
  CHECK(keyword_text(s).find("UZR = {omega: [1.5, 2], -alpha: 3} ") != std::string::npos);
  resolve_names(s, ParameterLayout(), names);
  CHECK(s.names.empty());
  CHECK(s.free_parameters == std::vector<int>{2, 1, 61});
  REQUIRE(s.user_values.size() == 3);
  CHECK(s.user_values[1].parameter == 2);
  CHECK_FALSE(s.user_values[1].stop);
  CHECK(s.user_values[2].parameter == 1);
  CHECK(s.user_values[2].stop);
  CHECK(s.parameter_weights.at(0).index == 2);
  CHECK_THROWS_AS(with({"THU={omega: 1}"}), UserError);

  const auto refusal = [&names](const char* key_value) {
    RunSettings wrong = with({key_value});
    try {
      resolve_names(wrong, ParameterLayout(), names);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refusal("ICP=[omega, 61, beta]") == "command line: ICP (free parameters, durations included): no such name");
  CHECK(refusal("ICP=[omega, 61, 2]").find("command line: ICP(3)") == 0);
  CHECK(refusal("THL={omega: 1, 2: 3}").find("the index '2' twice") != std::string::npos);
}

TEST_CASE("Overrides of start and stop", "[constants]") {
  const RunSettings s = with({"IRS=PD1", "STOP=[PD1,GR2]"});
  CHECK(s.start.type == "PD");
  CHECK(s.start.number == 1);
  REQUIRE(s.stop_rules.size() == 2);
  CHECK(s.stop_rules[1].type == "GR");
  CHECK(s.stop_rules[1].count == 2);
  CHECK(with({"STOP=PD1"}).stop_rules.size() == 1);
  for (const char* type : {"GC", "CP", "R1", "R2", "R3", "R4"}) {
    const StartLabel start = with({std::string("IRS=") + type + "12"}).start;
    CHECK(start.type == type);
    CHECK(start.number == 12);
  }
  CHECK(with({"IRS=0"}).start.from_data());
  CHECK_FALSE(with({"GRSTOP=0"}).stop_at_grazing);
}

TEST_CASE("Parameter values go by index or by name", "[constants]") {
  const RunSettings s = with({"PAR(2)=0.8", "PAR( omega )=-1d-1", "par(061)=3.5"});
  REQUIRE(s.parameter_values.size() == 3);
  CHECK(s.parameter_values[0].name == "2");
  CHECK(s.parameter_values[0].value == 0.8);
  CHECK(s.parameter_values[1].name == "omega");
  CHECK(s.parameter_values[1].value == -0.1);
  CHECK(s.parameter_values[2].name == "61");
  CHECK(with({"PAR={1: 0.5, omega: 2}"}).parameter_values.size() == 2);
}

TEST_CASE("A new signature comes as lists in any order", "[constants]") {
  const RunSettings s = with(
      {"GCGIND=[4]", "ICP=[1,61]", "THL={61: 0}", "GCFIND=[3]", "GCHIND=[2]", "GCSEGTYP=2", "GCHGRZIND=[5, 6, 7]"});
  REQUIRE(s.segments.size() == 1);
  CHECK(s.segments[0].index == IndexVector{3, 2, 4});
  CHECK(s.segments[0].type == 2);
  CHECK(s.segments[0].monitor == Ints{5, 6, 7});
  const RunSettings t = with({"GCGIND=[4, 3]"});
  REQUIRE(t.segments.size() == 2);
  CHECK(t.segments[0].index == IndexVector{1, 1, 4});
  CHECK(t.segments[1].index == IndexVector{2, 2, 3});
  CHECK(t.segments[1].monitor == Ints{2, 1});
}

TEST_CASE("Settings stay as they were when an override is refused", "[constants]") {
  RunSettings s = appendix();
  const std::vector<std::string> overrides{"NMX=5", "DS=0"};
  CHECK_THROWS_AS(apply_overrides(s, overrides), UserError);
  CHECK(testing::same_constants(s, appendix()));
}

TEST_CASE("Monitored events that GCIPSI does not number are told", "[constants]") {
  const auto warnings_of = [](const std::vector<std::string>& overrides) {
    RunSettings s = appendix();  // one event on segment 1, two on segment 2; GCIPSI = 1, 2, 3
    Warnings warnings;
    apply_overrides(s, overrides, &warnings);
    std::string text;
    for (const std::string& warning : warnings) text += warning + '\n';
    return text;
  };
  const std::string two_more = warnings_of({"GCHGRZIND=[[1,3],[2,1,3]]"});
  CHECK_THAT(two_more, Catch::Matchers::Contains("2 test functions are not located") &&
                           Catch::Matchers::Contains("4 (event 1 on segment 2), 5 (event 3 on segment 2)") &&
                           Catch::Matchers::Contains("GCIPSI"));
  CHECK(warnings_of({"GCHGRZIND=[[1,3],[2,1,3]]", "GCIPSI=[1,2,3,4,5]"}).empty());
  CHECK(warnings_of({"GCHGRZIND=[[1],[2,1,3]]", "GCIPSI=[1]"}).empty());  // chosen in the same breath
  CHECK(warnings_of({"GCHGRZIND=[[1,2],[1]]"}).empty());                  // as many as before
  CHECK(warnings_of({"DS=0.1"}).empty());
  RunSettings torus = appendix();
  apply_overrides(torus, std::vector<std::string>{"IPS=182", "ICP=[1,60]", "GCIPSI=[]"});
  Warnings warnings;
  apply_overrides(torus, std::vector<std::string>{"GCHGRZIND=[[1,3],[2,1,3]]"}, &warnings);
  CHECK(warnings.empty());  // without GCIPSI all are located on tori
}
