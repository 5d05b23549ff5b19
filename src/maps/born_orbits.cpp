#include "maps/born_orbits.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"
#include "maps/grazing_verdict.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double none = 1e-9;  // of the sizes of what is summed: zero to rounding

/// What both kinds of map need: A, b, h_x, h_p of one parameter.
struct LinearReturn {
  MatrixXd A;
  VectorXd b;
  VectorXd hx;
  double hp;
};

LinearReturn return_of(const HybridSystem& system, const GrazingOrbit& orbit) {
  const GrazingPoint& at = orbit.point;
  SurfaceRate surface(system.dimension(), 1);
  surface.evaluate(system, {at.field, at.event, at.jump}, at.x.data(), at.par.data(), {orbit.parameter});
  return {orbit.A, orbit.by_parameters.col(orbit.parameter - 1), at.event_gradient, surface.hp(0)};
}

int sign(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

BornOrbit with_square_root(const GrazingPoint& at, const LinearReturn& smooth, double clearance, int k) {
  const Eigen::Index n = at.x.size();
  MatrixXd power = MatrixXd::Identity(n, n);
  std::vector<VectorXd> turned{at.impact.beta};  // A^j beta
  for (int j = 1; j <= k; ++j) {
    power = smooth.A * power;
    turned.push_back(smooth.A * turned.back());
  }
  const MatrixXd repeated = MatrixXd::Identity(n, n) - power;
  const auto sum = [&](int j) { return -smooth.hx.dot(solve(repeated, turned[static_cast<std::size_t>(j)]).col(0)); };
  const double stretch = std::sqrt(2.0 / at.a);
  const double last = sum(k);
  BornOrbit born{k};
  if (!std::isfinite(last) || std::abs(last) <= none * smooth.hx.norm() * at.impact.beta.norm()) return born;
  const double slope = -clearance / (stretch * last);  // y = slope delta
  born.side = sign(slope);
  born.beyond_contact = last > 0.0;
  born.rate = std::abs(slope);
  const double xi = -smooth.hx.dot(turned.back());
  if (born.rate > 0.0) born.multiplier = -stretch * xi / (2.0 * born.rate);
  for (int j = 1; j < k && born.hits_at == 0; ++j)
    if (sum(j) <= last) born.hits_at = j;
  return born;
}

/// With contact d1 = L d0 + G delta.
BornOrbit without_square_root(const GrazingOrbit& orbit, const DiscontinuityMap& map, const LinearReturn& smooth,
                              double clearance, int k) {
  const Eigen::Index n = orbit.A.rows();
  const MatrixXd L = linear_contact(map);
  const VectorXd G = map.expansion().dp.col(orbit.parameter - 1) - map.expansion().yy * smooth.hp;
  std::vector<MatrixXd> powers{MatrixXd::Identity(n, n)};
  std::vector<VectorXd> sums{VectorXd::Zero(n)};
  for (int j = 1; j <= k; ++j) {
    sums.push_back(smooth.A * sums.back() + smooth.b);
    powers.push_back(smooth.A * powers.back());
  }
  const MatrixXd turn = powers.back() * L;
  const VectorXd right = powers.back() * G + sums.back();
  const VectorXd d0 = solve(MatrixXd::Identity(n, n) - turn, right);
  const double slope = -(smooth.hx.dot(d0) + smooth.hp);  // y^2 = slope delta
  BornOrbit born{k};
  if (!std::isfinite(slope) || std::abs(slope) <= none * std::abs(clearance)) return born;
  born.side = sign(slope);
  born.beyond_contact = slope * clearance < 0.0;
  born.rate = std::abs(slope);
  const Eigen::VectorXcd values = eigenvalues(turn);
  Eigen::Index largest = 0;
  values.cwiseAbs().maxCoeff(&largest);
  born.multiplier = values(largest);
  const VectorXd d1 = L * d0 + G;
  for (int j = 1; j < k && born.hits_at == 0; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double h = smooth.hx.dot(powers[i] * d1 + sums[i]) + smooth.hp;
    if (h * born.side <= 0.0) born.hits_at = j;
  }
  return born;
}

}  // namespace

BornOrbits born_orbits(const HybridSystem& system, const GrazingOrbit& orbit, const DiscontinuityMap& map, int most) {
  const LinearReturn smooth = return_of(system, orbit);
  const Eigen::Index n = orbit.A.rows();
  BornOrbits result;
  result.has_square_root = orbit.point.has_square_root();
  result.clearance = smooth.hx.dot(solve(MatrixXd::Identity(n, n) - smooth.A, smooth.b).col(0)) + smooth.hp;
  for (int k = 1; k <= most; ++k)
    result.orbits.push_back(result.has_square_root ? with_square_root(orbit.point, smooth, result.clearance, k)
                                                   : without_square_root(orbit, map, smooth, result.clearance, k));
  return result;
}

}  // namespace tchat
