#include "settings/point_type.hpp"
#include "files/solution_file.hpp"

#include <catch2/catch.hpp>

using namespace tchat;

TEST_CASE("Type numbers and their names") {
  const std::pair<int, const char*> cases[] = {
      {0, ""},     {1, "BP"},   {2, "LP"},   {3, "HB"},   {4, "RG"},   {5, "LP"},   {6, "BP"},
      {7, "PD"},   {8, "TR"},   {9, "EP"},   {-9, "MX"},  {-4, "UZ"},  {59, "EP"},  {-54, "UZ"},
      {54, "RG"},  {-59, "MX"}, {79, "EP"},  {-55, "R1"}, {-76, "R2"}, {-52, "CP"}, {28, "LPD"},
      {78, "LPD"}, {23, "LTR"}, {77, "PTR"}, {88, "TTR"}, {55, "LP"},  {-32, "GH"}, {-57, "R3"}};
  for (const auto& [type, name] : cases) {
    CAPTURE(type);
    CHECK(type_name(type) == name);
  }
}

TEST_CASE("A UZ label is named by its kind, on every curve") {
  CHECK(type_name(-4, {UserPointKind::user_value, 0, 1, 0.0}) == "UZ");
  CHECK(type_name(-4, {UserPointKind::contact, 1, 2, 0.5}) == "GR");
  CHECK(type_name(-74, {UserPointKind::impact_velocity, 1, 1, 1.0}) == "GR");
  CHECK(type_name(-4, {UserPointKind::xi, 1, 3, 0.0}) == "XI");
  CHECK(type_name(-4, {UserPointKind::grazing_codimension_two, 1, -1, 0.0}) == "GC");
  CHECK(type_name(9, {UserPointKind::contact, 1, 2, 0.5}) == "EP");
}

TEST_CASE("What a UZ label is, in words") {
  CHECK(description({}).empty());
  CHECK(description({UserPointKind::user_value, 0, 3, 0.0}) == "user value of PAR(3)");
  CHECK(description({UserPointKind::contact, 2, 1, 0.25}) == "contact inside segment 2, event function 1, tau = 0.25");
  CHECK(description({UserPointKind::xi, 1, 4, 0.0}) == "xi_4 = 0");
  CHECK(description({UserPointKind::impact_velocity, 1, 1, 1.0}) ==
        "impact velocity zero at the end of segment 1, event function 1");
}
