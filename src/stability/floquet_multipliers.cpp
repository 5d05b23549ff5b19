#include "stability/floquet_multipliers.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "bvp/transversality.hpp"

namespace tchat {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

constexpr double stability_tolerance = 1e-5;
/// h_x f / (|h_x| |f|) below which a multiplier may be 0/0: with errors of `no_transversality` it is then off by 1e-5.
constexpr double near_grazing = 1e-4;
/// A multiplier that such an error moves further, as a chord of the Riemann sphere, is not known.
constexpr double unknown = 1e-2;
/// A larger one at h_x f = 0 is infinite.
constexpr double large = 1e6;

/// Distance on the Riemann sphere, where infinity is a point like others.
double chord(const std::complex<double>& a, const std::complex<double>& b) {
  return std::abs(a - b) / (std::hypot(1.0, std::abs(a)) * std::hypot(1.0, std::abs(b)));
}

/// Orthonormal basis of the complement of v, n x (n - 1); of the first unit vector's complement when v = 0.
Matrix complement(const Vector& v) {
  const Eigen::Index n = v.size();
  if (v.norm() == 0.0) return Matrix::Identity(n, n).rightCols(n - 1);
  Vector essential(n > 1 ? n - 1 : 0);
  double tau = 0.0;
  double beta = 0.0;
  v.makeHouseholder(essential, tau, beta);
  Matrix q = Matrix::Identity(n, n);
  Vector work(n);
  q.applyHouseholderOnTheLeft(essential, tau, work.data());
  return q.rightCols(n - 1);
}

}  // namespace

bool FloquetMultipliers::stable() const { return valid && stable_count() == static_cast<int>(values.size()); }

int FloquetMultipliers::stable_count() const {
  return static_cast<int>(std::count_if(values.begin(), values.end(),
                                        [](const auto& mu) { return std::abs(mu) <= 1.0 + stability_tolerance; }));
}

/// What the end of one segment contributes.
struct FloquetSolver::SegmentEnd {
  Matrix tangent;         // Z_s: n x (n - 1)
  Matrix jump_tangent;    // g_x Z_s: n x (n - 1)
  Matrix projection;      // F_s: n x (n - 1)
  double transversality;  // h_x f / (|h_x| |f|)
  double flow_defect;
};

FloquetSolver::FloquetSolver(const OrbitShape& shape)
    : shape_(shape),
      a_(static_cast<std::size_t>(shape.segments)),
      e_(a_.size()),
      a_sizes_(a_.size()),
      e_sizes_(a_.size()),
      qz_(shape.dimension - 1, shape.segments) {}

/// Of the product of E_s^-1 A'_s, whose entries are disturbed by this share of the blocks that they are projected from
/// (what is left of these at h_x f = 0 may be rounding); none when the iteration fails.
std::vector<std::complex<double>> FloquetSolver::eigenvalues(double disturbance) {
  double k = 0.0;
  const auto disturbed = [&](const Matrix& matrix, double size, int i, int j) {
    k += 1.0;
    return matrix(i, j) + size * std::cos(k * k);  // any fixed numbers without pattern
  };
  const int n = shape_.dimension - 1;
  for (int s = 0; s < shape_.segments; ++s) {
    const auto at = static_cast<std::size_t>(s);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        qz_.a(s, i, j) = disturbed(a_[at], disturbance * a_sizes_[at], i, j);
        qz_.e(s, i, j) = disturbed(e_[at], disturbance * e_sizes_[at], i, j);
      }
  }
  std::vector<std::complex<double>> values;
  if (!qz_.compute()) return values;
  for (const ScaledComplex& mu : qz_.eigenvalues()) values.push_back(mu.value(infinite_multiplier));
  conjugate_pairs(values);
  return values;
}

/// Those that are elsewhere when everything is known a little less well.
void FloquetSolver::leave_out_undetermined(FloquetMultipliers& result) {
  std::vector<std::complex<double>> others = eigenvalues(no_transversality);
  std::vector<std::complex<double>> known;
  for (const auto& mu : result.values) {
    const auto nearer = [&mu](const auto& a, const auto& b) { return chord(a, mu) < chord(b, mu); };
    const auto nearest = std::min_element(others.begin(), others.end(), nearer);
    if (nearest == others.end() || chord(*nearest, mu) > unknown) continue;
    known.push_back(mu);
    others.erase(nearest);
  }
  result.undetermined = static_cast<int>(result.values.size() - known.size());
  result.values = std::move(known);
}

FloquetMultipliers FloquetSolver::compute(const CondensedSystem& condensed, const Orbit& x) {
  const int n = shape_.dimension;
  const int m = shape_.segments;
  const HybridSystem& system = condensed.system().system();
  const double* par = x.par.data();
  std::vector<SegmentEnd> ends(static_cast<std::size_t>(m));
  double structural = 0.0;
  double least_transversality = 1.0;
  for (int s = 0; s < m; ++s) {
    const IndexVector& v = condensed.system().signature()[static_cast<std::size_t>(s)];
    SegmentEnd& end = ends[static_cast<std::size_t>(s)];
    Vector hx(n);
    Vector f0(n);
    Vector f1(n);
    Vector g(n);
    Matrix gx(n, n);
    system.value(FunctionKind::field, v.field, x.start(s), par, f0.data());
    system.value(FunctionKind::field, v.field, x.end(s), par, f1.data());
    condensed.system().section_gradient(s, x.end(s), par, hx.data());
    system.first(FunctionKind::jump, v.jump, x.end(s), par, {}, g.data(), gx.data(), nullptr);
    const RowMajorBlock first(condensed.first_block(s), n, n);
    const RowMajorBlock last(condensed.last_block(s), n, n);
    end.tangent = complement(hx);
    end.jump_tangent = gx * end.tangent;
    end.projection = complement(last * f1);
    const double sizes = hx.norm() * f1.norm();
    end.transversality = sizes > 0.0 ? hx.dot(f1) / sizes : 0.0;
    const Vector defect = Matrix(last).partialPivLu().solve(first * f0 + last * f1);
    end.flow_defect = f1.norm() > 0.0 ? defect.norm() / f1.norm() : defect.norm();
    structural = std::max(structural, end.flow_defect);
    least_transversality = std::min(least_transversality, std::abs(end.transversality));
  }
  for (int s = 0; s < m; ++s) {
    const SegmentEnd& end = ends[static_cast<std::size_t>(s)];
    const SegmentEnd& before = ends[static_cast<std::size_t>((s + m - 1) % m)];
    const RowMajorBlock first(condensed.first_block(s), n, n);
    const RowMajorBlock last(condensed.last_block(s), n, n);
    a_[static_cast<std::size_t>(s)] = -end.projection.transpose() * (first * before.jump_tangent);
    e_[static_cast<std::size_t>(s)] = end.projection.transpose() * (last * end.tangent);
    a_sizes_[static_cast<std::size_t>(s)] = first.norm() * before.jump_tangent.norm();
    e_sizes_[static_cast<std::size_t>(s)] = last.norm();
  }

  FloquetMultipliers result;
  result.structural = std::isfinite(structural) ? std::min(structural, infinite_multiplier) : infinite_multiplier;
  result.values = eigenvalues(0.0);
  result.valid = n == 1 || !result.values.empty();
  if (!result.valid) return result;
  if (least_transversality < near_grazing) leave_out_undetermined(result);
  if (least_transversality <= no_transversality && !result.values.empty()) {
    const auto by_size = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
    const auto largest = std::max_element(result.values.begin(), result.values.end(), by_size);
    if (std::abs(*largest) > large) *largest = infinite_multiplier;
  }
  result.values.emplace_back(result.structural);

  const auto nearest_one = [](const auto& a, const auto& b) { return std::abs(a - 1.0) < std::abs(b - 1.0); };
  std::iter_swap(result.values.begin(), std::min_element(result.values.begin(), result.values.end(), nearest_one));
  std::stable_sort(result.values.begin() + 1, result.values.end(), [](const auto& a, const auto& b) {
    return std::abs(std::abs(a) - 1.0) < std::abs(std::abs(b) - 1.0);
  });
  return result;
}

}  // namespace tchat
