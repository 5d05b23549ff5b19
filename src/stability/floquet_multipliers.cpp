#include "stability/floquet_multipliers.hpp"

#include <Eigen/Householder>
#include <algorithm>
#include <cmath>
#include <optional>

#include "bvp/no_duration.hpp"
#include "bvp/transversality.hpp"
#include "hybrid/contact_segment.hpp"
#include "hybrid/event_at.hpp"
#include "linear_algebra/dense_matrix.hpp"

namespace tchat {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

constexpr double stability_tolerance = 1e-5;
/// Of the largest modulus.
constexpr double eigenvalue_rounding = 1e-14;
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

/// Least change, relative to each, of f0 and f1 with which they satisfy first f0 + last f1 = 0. Where errors grow along
/// the segment it is f0 that they are measured at, where they decay f1: neither is divided by what the other lost.
double flow_defect(const RowMajorBlock& first, const Vector& f0, const RowMajorBlock& last, const Vector& f1) {
  const Eigen::Index n = f0.size();
  const double size0 = f0.norm() > 0.0 ? f0.norm() : 1.0;
  const double size1 = f1.norm() > 0.0 ? f1.norm() : 1.0;
  Matrix rows(n, 2 * n);
  rows << size0 * first, size1 * last;
  Vector both(2 * n);
  both << f0 / size0, f1 / size1;
  return distance_to_null_space(rows, both);
}

/// The t of least |first f0 + t last f1|.
double trivial_multiplier(const RowMajorBlock& first, const Vector& f0, const RowMajorBlock& last, const Vector& f1) {
  const Vector image = last * f1;
  const double size = image.squaredNorm();
  return size > 0.0 ? -image.dot(first * f0) / size : 0.0;
}

/// The one closest to 1 first, then by the distance to the unit circle.
void sort_by_interest(std::vector<std::complex<double>>& values) {
  const auto nearest_one = [](const auto& a, const auto& b) { return std::abs(a - 1.0) < std::abs(b - 1.0); };
  std::iter_swap(values.begin(), std::min_element(values.begin(), values.end(), nearest_one));
  std::stable_sort(values.begin() + 1, values.end(), [](const auto& a, const auto& b) {
    return std::abs(std::abs(a) - 1.0) < std::abs(std::abs(b) - 1.0);
  });
}

/// Does contact segment s last no time, in a field that is continuous where it begins? Perturbations then pass it as if
/// it were not there.
bool is_passed(const DefiningSystem& defining, const Orbit& x, int s) {
  constexpr double continuous = 1e-6;
  const int m = x.shape.segments;
  if (m < 2 || !contact_lasts_no_time(x, s) || !is_contact_segment(defining.system(), defining.signature(), s))
    return false;
  const int before = defining.signature()[static_cast<std::size_t>((s + m - 1) % m)].field;
  const int own = defining.signature()[static_cast<std::size_t>(s)].field;
  Vector left(x.shape.dimension);
  Vector entered(x.shape.dimension);
  defining.system().value(FunctionKind::field, before, x.start(s), x.par.data(), left.data());
  defining.system().value(FunctionKind::field, own, x.start(s), x.par.data(), entered.data());
  return (entered - left).norm() <= continuous * left.norm();
}

/// The gradient of the section at the end of segment s; before and after a contact that is passed the orbit touches the
/// event's own, but not h_x f = 0.
Vector section_at_end(const DefiningSystem& defining, const Orbit& x, int s) {
  Vector gradient(x.shape.dimension);
  if (is_passed(defining, x, s) || is_passed(defining, x, (s + 1) % x.shape.segments)) {
    const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
    const EventAt at = event_at(defining.system(), v.event, v.field, x.end(s), x.par.data());
    gradient = rate_gradient(defining.system(), at, v.event, v.field, x.end(s), x.par.data());
    return gradient.dot(at.f) > 0.0 ? Vector(-gradient) : gradient;  // falling, as all sections
  }
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return gradient;
}

}  // namespace

bool FloquetMultipliers::stable() const { return valid && stable_count() == static_cast<int>(values.size()); }

int FloquetMultipliers::stable_count() const {
  const auto list = telling();
  double largest = 0.0;
  for (const auto& mu : list) largest = std::max(largest, std::abs(mu));
  const auto stable = std::count_if(list.begin(), list.end(), [&](const auto& mu) {
    return are_eigenvalues ? mu.real() <= eigenvalue_rounding * largest : std::abs(mu) <= 1.0 + stability_tolerance;
  });
  return static_cast<int>(stable) + (has_trivial ? 1 : 0);
}

/// What the end of one segment contributes.
struct FloquetSolver::SegmentEnd {
  Matrix tangent;                // Z_s: n x (n - 1)
  Matrix jump_tangent;           // g_x Z_s: n x (n - 1)
  Matrix projection;             // F_s: n x (n - 1)
  double transversality;         // a_s = h_x f / (|h_x| |f|)
  ScaledReal determinant_share;  // det E_s / a_s
  double flow_defect;
};

/// det E_s / a_s. [F, u]^T C [Z, f] with u = C f / |C f| is block triangular, with E_s and |C f| on its diagonal, and
/// det [Z, f] = det [Z, h_x / |h_x|] a_s |f|.
ScaledReal FloquetSolver::determinant_share(const SegmentEnd& end, const Matrix& last, const Vector& hx,
                                            const Vector& f) {
  const auto unit = [](const Vector& v) {
    return v.norm() > 0.0 ? Vector(v / v.norm()) : Vector(Vector::Unit(v.size(), 0));
  };
  Matrix rows(hx.size(), hx.size());
  Matrix columns(hx.size(), hx.size());
  rows << end.projection, unit(last * f);
  columns << end.tangent, unit(hx);
  ScaledReal result = determinant(last);
  result *= determinant(rows);
  result *= determinant(columns);
  const double flow = (last * f).norm();
  if (flow > 0.0) result *= f.norm() / flow;
  return result;
}

FloquetSolver::FloquetSolver(const OrbitShape& shape)
    : shape_(shape),
      a_(static_cast<std::size_t>(shape.segments)),
      e_(a_.size()),
      a_sizes_(a_.size()),
      e_sizes_(a_.size()),
      qz_(shape.dimension - 1, shape.segments) {}

/// The blocks, with entries disturbed by this share of the blocks that they are projected from: what is left of these
/// at h_x f = 0 may be rounding. `way` chooses one of many such disturbances.
FloquetSolver::Blocks FloquetSolver::disturbed(double disturbance, int way) const {
  Blocks blocks{e_, a_};
  if (disturbance == 0.0) return blocks;
  double k = 0.0;
  const auto disturb = [&](Matrix& block, double size) {
    for (double& entry : block.reshaped()) {
      k += 1.0;
      entry += disturbance * size * std::cos((k + 0.1 * way) * k);  // any fixed numbers without pattern
    }
  };
  for (std::size_t s = 0; s < a_.size(); ++s) {
    disturb(blocks.a[s], a_sizes_[s]);
    disturb(blocks.e[s], e_sizes_[s]);
  }
  return blocks;
}

/// Of the product of E_s^-1 A'_s, disturbed; none when the iteration fails.
std::vector<std::complex<double>> FloquetSolver::eigenvalues(double disturbance, int way) {
  const Blocks blocks = disturbed(disturbance, way);
  const int n = shape_.dimension - 1;
  for (int s = 0; s < shape_.segments; ++s) {
    const auto at = static_cast<std::size_t>(s);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        qz_.a(s, i, j) = blocks.a[at](i, j);
        qz_.e(s, i, j) = blocks.e[at](i, j);
      }
  }
  std::vector<std::complex<double>> values;
  if (!qz_.compute()) return values;
  for (const ScaledComplex& mu : qz_.eigenvalues()) values.push_back(mu.value(infinite_multiplier));
  conjugate_pairs(values);
  return values;
}

/// Those that are elsewhere when everything is known a little less well, in any of several ways: what is noise may come
/// out near the same place once.
void FloquetSolver::leave_out_undetermined(FloquetMultipliers& result) {
  constexpr int ways = 5;
  const std::size_t all = result.values.size();
  for (int way = 1; way <= ways; ++way) {
    std::vector<std::complex<double>> others = eigenvalues(no_transversality, way);
    std::vector<std::complex<double>> known;
    for (const auto& mu : result.values) {
      const auto nearer = [&mu](const auto& a, const auto& b) { return chord(a, mu) < chord(b, mu); };
      const auto nearest = std::min_element(others.begin(), others.end(), nearer);
      if (nearest == others.end() || chord(*nearest, mu) > unknown) continue;
      known.push_back(mu);
      others.erase(nearest);
    }
    result.values = std::move(known);
  }
  result.undetermined = static_cast<int>(all - result.values.size());
}

void FloquetSolver::form_products(const std::vector<SegmentEnd>& ends, bool touches, FloquetMultipliers& result) const {
  ScaledReal regular;  // det E_1 ... det E_m / (a_1 ... a_m)
  for (const SegmentEnd& end : ends) regular *= end.determinant_share;
  const CyclicDeterminant exact(e_, a_);
  const auto value = [&regular](const CyclicDeterminant& determinant, double t) {
    ScaledReal product = determinant.at(t);
    product /= regular;
    return product.value(infinite_multiplier);
  };
  result.with_one.value = value(exact, 1.0);
  result.with_minus_one.value = value(exact, -1.0);
  if (!touches) return;
  const Blocks blocks = disturbed(no_transversality, 1);
  const CyclicDeterminant nearby(blocks.e, blocks.a);
  result.with_one.uncertainty = std::abs(value(nearby, 1.0) - result.with_one.value);
  result.with_minus_one.uncertainty = std::abs(value(nearby, -1.0) - result.with_minus_one.value);
}

FloquetMultipliers FloquetSolver::compute(const CondensedSystem& condensed, const Orbit& x) {
  const int n = shape_.dimension;
  const int m = shape_.segments;
  const HybridSystem& system = condensed.system().system();
  const double* par = x.par.data();
  std::vector<SegmentEnd> ends(static_cast<std::size_t>(m));
  double structural = 0.0;
  double least_transversality = 1.0;
  std::optional<double> trivial;
  for (int s = 0; s < m; ++s) {
    const IndexVector& v = condensed.system().signature()[static_cast<std::size_t>(s)];
    SegmentEnd& end = ends[static_cast<std::size_t>(s)];
    const Vector hx = section_at_end(condensed.system(), x, s);
    Vector f0(n);
    Vector f1(n);
    Vector g(n);
    Matrix gx(n, n);
    system.value(FunctionKind::field, v.field, x.start(s), par, f0.data());
    system.value(FunctionKind::field, v.field, x.end(s), par, f1.data());
    system.first(FunctionKind::jump, v.jump, x.end(s), par, {}, g.data(), gx.data(), nullptr);
    const RowMajorBlock first(condensed.first_block(s), n, n);
    const RowMajorBlock last(condensed.last_block(s), n, n);
    end.tangent = complement(hx);
    end.jump_tangent = gx * end.tangent;
    end.projection = complement(last * f1);
    const double sizes = hx.norm() * f1.norm();
    end.transversality = sizes > 0.0 ? hx.dot(f1) / sizes : 0.0;
    end.flow_defect = flow_defect(first, f0, last, f1);
    if (!condensed.system().has_event(s)) trivial = trivial_multiplier(first, f0, last, f1);
    end.determinant_share = determinant_share(end, last, hx, f1);
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
  result.values = eigenvalues(0.0, 0);
  result.valid = n == 1 || !result.values.empty();
  if (!result.valid) return result;
  const bool touches = least_transversality < near_grazing;
  form_products(ends, touches, result);
  if (touches) leave_out_undetermined(result);
  if (least_transversality <= no_transversality && !result.values.empty()) {
    const auto by_size = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
    const auto largest = std::max_element(result.values.begin(), result.values.end(), by_size);
    if (std::abs(*largest) > large) *largest = infinite_multiplier;
  }
  if (trivial) {
    if (!result.values.empty()) sort_by_interest(result.values);
    result.has_trivial = true;
    result.structural = std::abs(*trivial - 1.0);
    result.values.insert(result.values.begin(), *trivial);
    return result;
  }
  result.values.emplace_back(result.structural);
  sort_by_interest(result.values);
  return result;
}

}  // namespace tchat
