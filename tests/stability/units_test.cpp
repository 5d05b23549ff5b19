// Special points do not depend on the units of parameters and event functions: no level is absolute.
#include <catch2/catch.hpp>
#include <cmath>

#include "normal_forms.hpp"
#include "recorded_branch.hpp"
#include "stability/grazing_tests.hpp"
#include "stability/test_function.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// The fold's normal form with PAR(1) = unit mu and the wall's function in the same unit.
template <int Exponent>
struct InUnits : NormalForms {
  static double unit() { return std::pow(10.0, Exponent); }
  template <class T>
  void field(int i, const T* u, const T* p, T* f) const {
    const T scaled[] = {p[0] / unit(), p[1]};
    NormalForms::field(i, u, scaled, f);
  }
  template <class T>
  T event(int j, const T* u, const T* p) const {
    return j == 1 ? NormalForms::event(j, u, p) : T(unit() * NormalForms::event(j, u, p));
  }
};

/// From z = sqrt(mu) = 0.3 both ways: the wall p = 1.2 is touched where mu = 0.04, a user value lies at mu = 0.06.
template <int Exponent>
void check_in_units() {
  CAPTURE(Exponent);
  using Problem = InUnits<Exponent>;
  Orbit start = NormalForms::orbit(pi, 0.3, 0.09 * Problem::unit(), 1.4);
  int contacts = 0, values = 0;
  for (const double ds : {0.02, -0.02}) {
    for (const double p : {1.4, 1.2}) {
      start.par(1) = p;
      PeriodicOrbits orbits(system_of<Problem>(), {{2, 1, 1}}, 1, start.shape, {12, 4, 1e-10, 1e-10});
      const PathPoint point = orbits.corrected(start);
      REQUIRE(orbits.result.converged());
      ContinuationSettings settings = branch_settings(start.shape, 1, ds, 0.05, 9);
      settings.location_tolerance = 1e-10;
      settings.max_location = 20;
      Tests tests;
      tests.push_back(std::make_unique<ContactTest>(orbits.system, 0, 2, false));
      tests.push_back(std::make_unique<UserValueTest>(1, 0.06 * Problem::unit(), false, "mu"));
      const RecordedBranch branch = record(orbits.follower, orbits.system, point, settings, std::move(tests));
      for (const RecordedPoint* special : branch.special()) {
        const double mu = special->orbit.par(0) / Problem::unit();
        const double z = special->orbit.start(0)[2];
        if (special->special.kind.kind == UserPointKind::contact) {
          ++contacts;
          CHECK(z == Approx(p - 1.0).margin(1e-8));
        } else {
          ++values;
          CHECK(special->special.kind.kind == UserPointKind::user_value);
          CHECK(mu == Approx(0.06).epsilon(1e-8));
        }
      }
    }
  }
  // Towards larger z the wall p = 1.4 is met once, towards smaller z the wall p = 1.2 and the user value.
  CHECK(contacts == 2);
  CHECK(values == 2);
}

}  // namespace

TEST_CASE("contacts and user values in small units") {
  check_in_units<0>();
  check_in_units<-10>();
  check_in_units<-4>();
}
