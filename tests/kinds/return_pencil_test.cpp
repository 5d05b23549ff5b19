// Multipliers of return maps against plain products, and where a product does not exist.
#include "kinds/orbit_check.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "linear/dense_matrix.hpp"
#include "support/multiplier_sets.hpp"

using namespace tchat;
using Eigen::MatrixXd;

namespace {

/// Segments of a problem with four states; `velocity` is h_x f of the second one's end.
std::vector<SegmentLink> links(double velocity) {
  std::srand(5);
  std::vector<SegmentLink> result;
  for (int s = 0; s < 3; ++s) {
    SegmentLink link{MatrixXd::Random(4, 4), Eigen::VectorXd::Random(4), Eigen::RowVectorXd::Random(4),
                     MatrixXd::Random(4, 4)};
    const double wanted = s == 1 ? velocity : -0.5;
    link.f += link.hx.transpose() * (wanted - link.hx.dot(link.f)) / link.hx.squaredNorm();
    result.push_back(link);
  }
  return result;
}

std::vector<std::complex<double>> of_product(const std::vector<SegmentLink>& all) {
  MatrixXd map = MatrixXd::Identity(4, 4);
  for (const SegmentLink& link : all)
    map = link.gx * (link.flow * map - link.f * (link.hx * link.flow * map) / link.hx.dot(link.f)).eval();
  const Eigen::VectorXcd values = eigenvalues(map);
  return {values.begin(), values.end()};
}

}  // namespace

TEST_CASE("multipliers are those of the product of segments, also near contact, where nothing is divided") {
  for (const double velocity : {-0.5, -1e-3, -1e-5, -1e-7}) {
    CAPTURE(velocity);
    const auto all = links(velocity);
    const ReturnPencil pencil(all);
    CHECK(pencil.determines_multipliers(1e-6));
    // The large one is the reciprocal of what rounding leaves of a small number, close to a zero.
    CHECK(test::mixed_distance(pencil.multipliers(), of_product(all)) < 1e-12 + 1e-15 / (velocity * velocity));
    for (const std::complex<double>& mu : of_product(all)) CHECK(pencil.backward_error(mu) < 1e-9);
    CHECK(pencil.backward_error({0.3, 0.7}) > 1e-4);
  }
}

TEST_CASE("in contact one multiplier is infinite, the others are limits") {
  const auto found = ReturnPencil(links(0.0)).multipliers();
  REQUIRE(found.size() == 4);
  CHECK(std::abs(found.front()) > 1e6);
  const auto near = ReturnPencil(links(-1e-9)).multipliers();
  for (std::size_t k = 1; k < 4; ++k) CHECK(std::abs(found[k] - near[k]) < 1e-6);
  CHECK(largest_difference(found, near) < 1e-6);
}

TEST_CASE("differences of sets: any order, the structural zero left out, large ones by their reciprocals") {
  CHECK(largest_difference({1e-5, 0.5, -2.0}, {-2.0, 0.0, 0.5}) == 0.0);
  CHECK(largest_difference({0.5, -2.0, 0.0}, {-2.2, 0.0, 0.5}) == Approx(0.1));
  CHECK(largest_difference({1e99, 0.5, 0.0}, {-3e8, 0.5, 0.0}) < 1e-8);
  CHECK(largest_difference({1e99, 0.5, 0.0}, {3.0, 0.5, 0.0}) > 0.1);
}
