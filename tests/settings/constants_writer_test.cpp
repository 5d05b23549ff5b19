#include <catch2/catch.hpp>

#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/sample_files.hpp"
#include "settings/settings_check.hpp"

using namespace tchat;

namespace {

RunSettings appendix() { return read_constants_text(testing::appendix_b(), "gc.test"); }

/// Nothing at its default, and numbers that short decimals do not hold.
RunSettings awkward() {
  RunSettings s = appendix();
  apply_overrides(s, std::vector<std::string>{"NDIM=7",
                                              "IPS=150",
                                              "IRS=XI2",
                                              "ILP=0",
                                              "ICP=[2, 1, 62, 61]",
                                              "NTST=77",
                                              "NCOL=7",
                                              "IAD=0",
                                              "ISP=-3",
                                              "ISW=-1",
                                              "IPLT=-5",
                                              "NBC=3",
                                              "NINT=4",
                                              "NMX=0",
                                              "RL0=-1e300",
                                              "RL1=0.30000000000000004",
                                              "A0=-2.2250738585072014e-308",
                                              "A1=1.7976931348623157e308",
                                              "NPR=11",
                                              "MXBF=-4",
                                              "IID=5",
                                              "ITMX=0",
                                              "ITNW=9",
                                              "NWTN=1",
                                              "JAC=-1",
                                              "EPSL=3.3333333333333335e-7",
                                              "EPSU=1e-11",
                                              "EPSS=5e-324",
                                              "DS=-0.1",
                                              "DSMIN=1e-9",
                                              "DSMAX=123456789.12345679",
                                              "IADS=0",
                                              "THL={61: 0, 1: 0.1, 64: 2}",
                                              "THU={7: 1e-3, 1: 0}",
                                              "UZR={1: [1, 2], -1: 3, 2: 0.7, 1: 4}",
                                              "GCISTART=-2",
                                              "GCIDIFF=2",
                                              "GCIPSI=[9, 1]",
                                              "GCIFIXED=[-1, 0]",
                                              "GCNOSEG=2",
                                              "GCSEGTYP=[0, 2]",
                                              "GCFIND=[9, 8]",
                                              "GCHIND=[7, 6]",
                                              "GCGIND=[5, 4]",
                                              "GCHGRZIND=[[], [3, 3]]",
                                              "GRSTOP=0",
                                              "GRJUMP=3",
                                              "CLSTOP=0",
                                              "STOP=[PD1, GR2]"});
  return s;
}

}  // namespace

TEST_CASE("Written constants read back to the same bits", "[constants]") {
  for (const RunSettings& s : {appendix(), awkward()}) {
    CHECK(testing::same_constants(read_constants_text(positional_text(s), "r.test"), s));
    CHECK(testing::same_constants(read_constants_text(keyword_text(s), "r.test"), s));
  }
}

TEST_CASE("Written text raises no warning and is reproduced by itself", "[constants]") {
  Warnings warnings;
  const std::string text = positional_text(awkward());
  CHECK(positional_text(read_constants_text(text, "r.test", &warnings)) == text);
  CHECK(warnings.empty());
}

TEST_CASE("Each record names its values", "[constants]") {
  const std::string text = positional_text(appendix());
  CHECK(text.find("5 180 1 1 ") == 0);
  CHECK(text.find(" NDIM, IPS, IRS, ILP\n") != std::string::npos);
  CHECK(text.find("\n61 0\n62 0\n") != std::string::npos);
  CHECK(text.find("\n2 2 1 ") != std::string::npos);
  CHECK(text.find(" GCHNO(2), (GCHGRZIND(I), I=1, GCHNO(2))\n") != std::string::npos);
  CHECK(text.find("\nGRSTOP = 1\nGRJUMP = 1\nSTOP = []\n") != std::string::npos);
}

TEST_CASE("The keyword form explains each constant", "[constants]") {
  const std::string text = keyword_text(awkward());
  CHECK(text.find("UZR = {1: [1, 2], -1: 3, 2: 0.7, 1: 4} ") != std::string::npos);
  CHECK(text.find("GCHGRZIND = [[], [3, 3]] ") != std::string::npos);
  CHECK(text.find("NTST = 77                      # number of mesh intervals") != std::string::npos);
  CHECK(text.find("NICP") == std::string::npos);
}

TEST_CASE("The table knows each constant once, with an example that is accepted", "[constants]") {
  for (const Constant& constant : constants_table()) {
    CAPTURE(constant.keyword);
    CHECK(find_constant(constant.keyword) == &constant);
    if (std::holds_alternative<ListCount>(constant.member) || std::holds_alternative<MonitorCounts>(constant.member))
      continue;
    RunSettings s = appendix();
    const ParameterNames monitors = [](const std::string&, const std::string&) { return names_a_monitor; };
    std::vector<std::string> overrides{std::string(constant.keyword) + " = " + std::string(constant.example)};
    if (constant.keyword == "HOLD") overrides.emplace_back("ICP = [1, 2, 61, 62]");  // one more parameter is free
    if (constant.keyword == "CONSERVED") overrides.emplace_back("ICP = [61, 62]");   // one less
    CHECK_NOTHROW(apply_overrides(s, overrides));
    CHECK_NOTHROW(resolve_names(s, ParameterLayout(), monitors));
  }
}
