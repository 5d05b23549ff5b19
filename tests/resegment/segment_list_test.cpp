// Signatures cut at a contact, rotated and repeated; the constants that go with them.
#include "resegment/segment_list.hpp"

#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "resegment/signature_match.hpp"
#include "settings/constants_file.hpp"
#include "support/mems_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

RunSettings impacting_settings() {
  return read_constants_text(
      "NDIM = 5, ICP = [1, 61, 62], THL = {61: 0.25, 62: 0.5}, UZR = {1: 0.7, 62: 0.1}, STOP = [GR1]\n"
      "GCFIND = [1, 2], GCHIND = [1, 2], GCGIND = [1, 2], GCSEGTYP = [1, 0]\n"
      "GCHGRZIND = [[1], [2, 1]], GCIPSI = [1, 3]\n",
      "test");
}

Signature signature(const SegmentList& segments) {
  Signature result;
  for (const NewSegment& segment : segments) result.push_back(segment.index);
  return result;
}

Orbit orbit(std::initializer_list<double> durations) {
  Orbit x;
  x.shape = {5, static_cast<int>(durations.size()), 1, 2};
  x.par = ParameterVector(ParameterLayout());
  int s = 0;
  for (const double t : durations) x.duration(s++) = t;
  return x;
}

}  // namespace

TEST_CASE("a contact inside a segment cuts it in two") {
  const CutList cut = cut_at({segments_of(impacting_settings()), {}}, {ContactPoint::inside, 0, 1, 0.325}, 2);
  CHECK(cut.contacts == std::vector<std::size_t>{0});
  CHECK(signature(cut.segments) == mems_orbits::secondary_grazing);
  CHECK(cut.segments[0].piece.to == 0.325);
  CHECK(cut.segments[1].piece.from == 0.325);
  CHECK(cut.segments[1].piece.to == 1.0);
  CHECK(cut.segments[2].piece.whole());
}

TEST_CASE("a section on the contact is replaced, its jump is the caller's choice") {
  RunSettings settings = impacting_settings();
  settings.segments = {{1, {1, 3, 3}, {1}}};
  settings.test_functions = {1};
  const CutList cut = cut_at({segments_of(settings), {}}, {ContactPoint::section, 0, 1, 1.0}, 3);
  CHECK(signature(cut.segments) == mems_orbits::grazing);
  CHECK(cut.segments[0].piece.whole());
  const CutList born = with_empty_segments(cut, 0, 2);
  REQUIRE(born.segments.size() == 3);
  CHECK(born.segments[2].piece.empty());
  CHECK(born.segments[2].piece.from == 1.0);
}

TEST_CASE("segments of no duration after a vanishing impact are left out, also around the end of the list") {
  SegmentList segments = segments_of(impacting_settings());
  const CutList cut = without_empty_segments({segments, {0}}, 0, orbit({3.9, 1e-9}));
  REQUIRE(cut.segments.size() == 1);
  CHECK(cut.segments[0].index.field == 1);
  const CutList around = without_empty_segments({segments, {1}}, 0, orbit({1e-9, 3.9}));
  REQUIRE(around.segments.size() == 1);
  CHECK(around.contacts == std::vector<std::size_t>{0});
  CHECK(around.segments[0].index.field == 2);
  CHECK(without_empty_segments({segments, {0}}, 0, orbit({3.9, 0.1})).segments.size() == 2);
}

TEST_CASE("rotation and repetition") {
  const SegmentList segments = segments_of(impacting_settings());
  CHECK(signature(rotated(segments, 1)) == Signature{{2, 2, 2}, {1, 1, 1}});
  CHECK(signature(rotated(segments, -1)) == Signature{{2, 2, 2}, {1, 1, 1}});
  CHECK(signature(rotated(segments, 4)) == mems_orbits::impacting);
  CHECK(signature(repeated(segments)) == Signature{{1, 1, 1}, {2, 2, 2}, {1, 1, 1}, {2, 2, 2}});
  CHECK(repeated(SegmentList(300, segments[0])).size() == 600);
}

TEST_CASE("constants follow the pieces: weights, test functions, free parameters") {
  const RunSettings old = impacting_settings();
  const CutList cut = cut_at({segments_of(old), {}}, {ContactPoint::inside, 0, 1, 0.325}, 2);
  const RunSettings impacting = new_settings(old, cut.segments, {180, 1, 1}, mems());
  CHECK(impacting.signature() == mems_orbits::secondary_grazing);
  CHECK(impacting.free_parameters == std::vector<int>{1, 61, 62, 63});
  REQUIRE(impacting.parameter_weights.size() == 3);
  CHECK(impacting.parameter_weights[1].value == 0.25);
  CHECK(impacting.parameter_weights[2].value == 0.5);
  CHECK(impacting.test_functions == std::vector<int>{1, 2, 4});  // event 2 on the last segment was not located before
  CHECK(impacting.segments[0].type == 0);
  CHECK(impacting.segments[1].type == 1);
  REQUIRE(impacting.user_values.size() == 1);
  CHECK(impacting.user_values[0].parameter == 1);
  CHECK(impacting.stop_rules.empty());
  CHECK(impacting.start.number == 1);

  CutList grazing = cut;
  grazing.segments[0].grazes = true;
  const RunSettings curve = new_settings(old, grazing.segments, {150, 1, 1}, mems());
  CHECK(curve.free_parameters == std::vector<int>{1, 2, 61, 62, 63});
  CHECK(curve.test_functions == std::vector<int>{1, 2, 3, 4, 5});
  CHECK(curve.segments[0].type == 2);
}

TEST_CASE("the index jump function says what follows an impact of velocity zero") {
  const ParameterVector par = [] {
    ParameterVector p{ParameterLayout()};
    p(0) = 0.598, p(1) = 0.8;
    return p;
  }();
  Eigen::VectorXd contact(5);
  contact << 0.0, 0.5, 0.0, -0.0225309885, 0.9997461451;
  CHECK(segments_after_impact(mems(), {1, 1, 1}, contact, par, 1) == Signature{{2, 2, 2}});
  CHECK(segments_after_impact(mems(), {1, 1, 1}, contact, par, 2).empty());
  contact(0) = 1.0;  // the slip cannot end at once
  CHECK_THROWS_WITH(segments_after_impact(mems(), {1, 1, 1}, contact, par, 1), Contains("give the whole signature"));
}

TEST_CASE("signatures as users write them") {
  const Signature expected{{1, 1, 1}, {2, 2, 2}};
  for (const char* text : {"1,1,1;2,2,2", "1,1,1; 2,2,2;", "(1,1,1),(2,2,2)", "{(1,1,1), (2,2,2)}", "(1,1,1)(2,2,2)"})
    CHECK(parse_signature(text) == expected);
  const Signature cascade{{1, 1, 2}, {1, 2, 1}, {1, 1, 2}, {1, 2, 1}},
      uneven{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {2, 2, 2}};
  CHECK(to_string(cascade) == "{(1,1,2), (1,2,1)}^2");
  CHECK(to_string(uneven) == "{(1,1,1)^3, (2,2,2)}");
  CHECK(to_string(Signature(32, {1, 1, 1})) == "{(1,1,1)}^32");
  CHECK(to_string(expected) == "{(1,1,1), (2,2,2)}");
  for (const Signature& signature : {cascade, uneven, expected, Signature(32, {1, 1, 1})})
    CHECK(parse_signature(to_string(signature)) == signature);
  CHECK(parse_signature("1,1,1^3;2,2,2") == uneven);
  CHECK(parse_signature("{(1,1,2)(1,2,1)}^2") == cascade);
  for (const char* text : {"(1,1,1)^", "(1,1,1)^0", "(1,1,1)^-2", "^2", "(1,1,1)^100001", "{(1,1,1)^800}^900",
                           "{(1,1,1), {(2,2,2)}^2}^3", "(1,1,1)^99999999999"})
    CHECK_THROWS_AS(parse_signature(text), UserError);
  for (const char* text :
       {"", ";", "1,1", "1,1,1,2,2,2", "1,a,1", "0,1,1", "1,,1", "1.5,1,1", "-1,1,1", "99999999999,1,1"})
    CHECK_THROWS_AS(parse_signature(text), UserError);
}
