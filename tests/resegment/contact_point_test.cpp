// Which contact a label stands for.
#include "resegment/contact_point.hpp"

#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "support/mems_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

struct Labelled {
  LabelledSolution solution;
  RunSettings settings;
  Orbit x;
};

/// Constant segments that end in `end`.
Labelled labelled(const Signature& signature, const UserPointKind& kind, const Eigen::VectorXd& end) {
  Labelled result;
  result.solution.type = -4;
  result.solution.kind = kind;
  result.settings.dimension = 5;
  for (const IndexVector& index : signature) result.settings.segments.push_back({1, index, {1}});
  result.x.shape = {5, static_cast<int>(signature.size()), 1, 2};
  result.x.states = end.replicate(1, result.x.shape.columns());
  result.x.par = ParameterVector(ParameterLayout());
  return result;
}

Eigen::VectorXd state(double frame_velocity, double velocity) {
  Eigen::VectorXd x(5);
  x << frame_velocity, 0.5, velocity, 0.0, 1.0;
  return x;
}

ContactPoint find(const Labelled& l) { return contact_point(l.solution, l.x, mems(), l.settings, "label 1 of q.test"); }

constexpr auto contact = UserPointKind::contact;

}  // namespace

TEST_CASE("contact inside a segment, and on a section at either end") {
  const ContactPoint inside = find(labelled(mems_orbits::impacting, {contact, 1, 1, 0.325}, state(0, 0)));
  CHECK(inside.where == ContactPoint::inside);
  CHECK(inside.tau == 0.325);

  const ContactPoint end = find(labelled(mems_orbits::nonimpacting, {contact, 1, 1, 1.0}, state(0, 0)));
  CHECK(end.where == ContactPoint::section);
  CHECK(end.segment == 0);

  // The start of segment 1 is the end of the last one.
  const ContactPoint start = find(labelled({{1, 1, 2}, {1, 3, 3}}, {contact, 1, 1, 1e-9}, state(0, 0)));
  CHECK(start.where == ContactPoint::section);
  CHECK(start.segment == 1);
}

TEST_CASE("contact at the end of a segment whose own event matters") {
  CHECK_THROWS_WITH(find(labelled({{1, 3, 3}}, {contact, 1, 1, 1.0}, state(0.5, 0))), Contains("changes the state"));
  CHECK_THROWS_WITH(find(labelled({{1, 3, 3}, {2, 2, 2}}, {contact, 1, 1, 1.0}, state(0, 0))),
                    Contains("changes the vector field"));
}

TEST_CASE("an impact of velocity zero, and a label of a grazing curve") {
  const ContactPoint impact =
      find(labelled(mems_orbits::impacting, {UserPointKind::impact_velocity, 1, 1, 1.0}, state(0, 0)));
  CHECK(impact.where == ContactPoint::impact);

  Labelled curve = labelled(mems_orbits::secondary_grazing, {}, state(0, 0));
  curve.solution.problem_type = 150;
  curve.settings.segments[1].type = 2;
  const ContactPoint on_curve = find(curve);
  CHECK(on_curve.where == ContactPoint::grazing_curve);
  CHECK(on_curve.segment == 1);
}

TEST_CASE("labels that are no grazing points, and labels of another problem") {
  Labelled fold = labelled(mems_orbits::impacting, {}, state(0, 0));
  fold.solution.type = 5;
  CHECK_THROWS_WITH(find(fold), Contains("no grazing point but of type LP"));
  CHECK_THROWS_WITH(find(labelled(mems_orbits::impacting, {contact, 7, 1, 0.5}, state(0, 0))), Contains("segment 7"));
  CHECK_THROWS_WITH(find(labelled(mems_orbits::impacting, {contact, 1, 9, 0.5}, state(0, 0))),
                    Contains("event function 9"));
}

TEST_CASE("the jump at a contact is that of the index jump function, else GRJUMP") {
  Labelled l = labelled({{1, 3, 3}}, {contact, 1, 1, 0.4}, state(0.0, 0.0));
  l.settings.grazing_jump = 2;
  CHECK(jump_at_contact(mems(), l.settings, l.x, find(l)) == 1);
  // An event that is not watched on this segment.
  CHECK(jump_at_contact(mems(), l.settings, l.x, {ContactPoint::inside, 0, 2, 0.4}) == 2);
}
