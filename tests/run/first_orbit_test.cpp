// The first point of a branch, compared with closed forms: impacts of the linear oscillator, the circles of the Hopf
// normal form.
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "continuation/path_follower.hpp"
#include "run/branch_setup.hpp"
#include "run/hopf_switch.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double omega = 3.0;

/// z' = (p + i omega) z - z |z|^2: for p > 0 the circle |z|^2 = p, gone round in 2 pi / omega.
struct HopfNormalForm {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T growth = p[0] - x[0] * x[0] - x[1] * x[1];
    f[0] = growth * x[0] - T(omega) * x[1];
    f[1] = T(omega) * x[0] + growth * x[1];
  }
};

RunSettings settings_of(int dimension, SegmentSettings segment) {
  RunSettings settings;
  settings.dimension = dimension;
  settings.free_parameters = {1};
  settings.mesh_intervals = 40;
  settings.tolerance_parameters = settings.tolerance_states = 1e-11;
  settings.max_newton = 15;
  settings.segments = {std::move(segment)};
  return settings;
}

SelectedStart equilibrium_of_normal_form(double p) {
  const OrbitShape shape = OrbitShape::point(2);
  SelectedStart selected;
  selected.start.orbit = {shape, uniform_mesh(1), Eigen::MatrixXd::Zero(2, 2), parameters({p})};
  selected.source = "q.x";
  selected.from_solution = true;
  selected.problem_type = equilibrium.number;
  selected.type = static_cast<int>(PointType::hopf);
  selected.types = {selected.type};
  return selected;
}

}  // namespace

TEST_CASE("data beside the one-impact orbit are corrected to it at the same amplitude of the forcing") {
  const OscillatorOrbit exact = one_impact_orbit(2.0, 0.7);
  RunSettings settings = settings_of(linosc().dimension(), {1, {1, 1, 1}, {}});
  SelectedStart selected;
  selected.start.orbit =
      sampled_orbit({exact.piece(0.0, exact.constants.period())}, linosc().dimension(), 40, 4, exact.par());
  const Orbit closed_form = selected.start.orbit;
  selected.start.orbit.states.row(1).array() += 1e-3;
  selected.start.orbit.duration(0) *= 1.0 + 1e-3;
  selected.known_parameters = selected.start.orbit.par;

  const FirstPoint first = set_up_branch(linosc(), settings, selected).start;
  CHECK(first.point.orbit.par(0) == exact.alpha);
  CHECK(std::abs(first.point.orbit.duration(0) - exact.constants.period()) < 1e-9);
  CHECK(mesh_point_distance(first.point.orbit, closed_form) < 1e-8);
  CHECK(first.correction.size() > 1);
  CHECK(first.note.empty());
}

TEST_CASE("the orbits born at a Hopf bifurcation are the circles of its normal form") {
  RunSettings settings = settings_of(2, {0, {1, no_function, no_function}, {}});
  settings.branch_mode = branch_switch.branch_mode;
  settings.step = GENERATE(0.1, -0.05);
  const FirstPoint first =
      begin_periodic_orbits(system_of<HopfNormalForm>(), settings, equilibrium_of_normal_form(0.0)).start;
  const Orbit& x = first.point.orbit;
  CHECK(std::abs(x.duration(0) - 2.0 * pi / omega) < 1e-9);
  CHECK(x.par(0) > 1e-4);
  for (int k = 0; k < x.shape.nodes(); k += x.shape.collocation)
    CHECK(std::abs(x.states.col(k).squaredNorm() - x.par(0)) < 1e-9);
}

TEST_CASE("an equilibrium without eigenvalues on the imaginary axis is no Hopf bifurcation") {
  const RunSettings settings = settings_of(2, {0, {1, no_function, no_function}, {}});
  CHECK_THROWS_WITH(begin_periodic_orbits(system_of<HopfNormalForm>(), settings, equilibrium_of_normal_form(0.2)),
                    Catch::Contains("a Hopf point that is none"));
}
