// Lines of an invariant torus, compared with the torus: returns begin on a circle with its second harmonic, and an
// angle goes round with them.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "files/orbit_trace.hpp"
#include "model/parameter_vector.hpp"
#include "settings/problem_type.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using test_support::TemporaryFolder;

namespace {

constexpr double turn = 2.0 * 3.14159265358979323846;
constexpr int returns = 5;

/// On the torus at phase phi and scaled time tau; the third state is an angle.
Eigen::Vector3d on_torus(double phi, double tau) {
  const double a = turn * phi;
  return {std::cos(a) + 0.3 * std::sin(2.0 * a) + tau, std::sin(a) - tau * std::cos(a), a};
}

LabelledSolution torus() {
  LabelledSolution label;
  label.label = 2;
  label.problem_type = invariant_torus.number;
  label.dimension = 3;
  label.tau = {0.0, 0.5, 1.0};
  label.states.resize(3 * returns, 3);
  for (int i = 0; i < returns; ++i)
    for (int k = 0; k < 3; ++k)
      label.states.block<3, 1>(3 * i, k) = on_torus(static_cast<double>(i) / returns, 0.5 * k);
  label.parameters.assign(100, 0.0);
  for (int i = 0; i < returns; ++i)
    label.parameters[static_cast<std::size_t>(ParameterLayout().first_duration() - 1 + i)] = 2.0;
  return label;
}

std::string solutions_with_constants(const TemporaryFolder& folder) {
  folder.write("gc.x", "NDIM = 3, IPS = 182, ICP = [1, 2]\nGCFIND = [1], GCHIND = [1], GCGIND = [0]\n");
  return folder.write("q.x", "");
}

}  // namespace

TEST_CASE("the constants beside the file say how many segments a return has") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(segments_of_return(torus(), folder.file("q.x")), UserError);
  const std::string path = solutions_with_constants(folder);
  CHECK(segments_of_return(torus(), path) == 1);
  LabelledSolution two_returns = torus();
  two_returns.states.conservativeResize(6, 3);
  CHECK_THROWS_AS(segments_of_return(two_returns, path), UserError);
}

TEST_CASE("the curve on the section is the trigonometric polynomial through the returns, an angle goes round once") {
  const TemporaryFolder folder;
  const OrbitTrace trace = section_trace(torus(), "EP1", 0, solutions_with_constants(folder));
  REQUIRE(trace.segments.size() == 1);
  CHECK(trace.is_section);
  const TraceSegment& curve = trace.segments.front();
  for (std::size_t k = 0; k < curve.times.size(); ++k)
    CHECK((curve.states.col(static_cast<Eigen::Index>(k)) - on_torus(curve.times[k], 0.0)).norm() < 1e-12);
  CHECK(trace.section_points.cols() == returns);
}

TEST_CASE("further returns lie on the torus between those of the label") {
  const TemporaryFolder folder;
  const OrbitTrace trace = torus_bundle(torus(), "EP1", 0, solutions_with_constants(folder));
  const std::size_t count = trace.segments.size();
  REQUIRE(count >= 61);
  CHECK(count % returns == 0);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      CHECK((trace.segments[i].states.col(k) - on_torus(static_cast<double>(i) / static_cast<double>(count), 0.5 * k))
                .norm() < 1e-12);
}
