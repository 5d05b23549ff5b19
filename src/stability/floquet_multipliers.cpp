#include "stability/floquet_multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

SegmentMap segment_map(const CondensedSystem& condensed, const Orbit& x, int s) {
  const DefiningSystem& defining = condensed.system();
  const HybridSystem& system = defining.system();
  const int n = x.shape.dimension;
  const IndexVector& index = defining.signature()[static_cast<std::size_t>(s)];
  const Eigen::MatrixXd a = Eigen::Map<const RowMajor>(condensed.first_block(s), n, n);
  const Eigen::MatrixXd c = Eigen::Map<const RowMajor>(condensed.last_block(s), n, n);
  const Eigen::MatrixXd flow = solve(c, -a);

  Eigen::VectorXd f(n);
  Eigen::VectorXd section(n);
  system.value(FunctionKind::field, index.field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), section.data());

  SegmentMap map;
  map.to_duration = change_of_time(f, section, flow);
  map.to_end = flow + f * map.to_duration;
  map.to_next = jump_at(system, index.jump, x.end(s), x.par.data()).derivative * map.to_end;
  return map;
}

Eigen::MatrixXd return_matrix(const CondensedSystem& condensed, const Orbit& x, int first, int last) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(x.shape.dimension, x.shape.dimension);
  for (int s = first; s < last; ++s) matrix = segment_map(condensed, x, s).to_next * matrix;
  return matrix;
}

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// h_x f / (|h_x| |f|) below which a multiplier may be 0/0: with errors of `no_transversality` it is then off by 1e-5.
constexpr double near_grazing = level::visible;
/// A multiplier that an error moves further, as a chord of the Riemann sphere where h_x f = 0, is not known.
constexpr double unknown = 1e-2;
/// A larger one at h_x f = 0 is infinite.
constexpr double large = 1e6;

/// Distance on the Riemann sphere, where infinity is a point like others.
double chord(const std::complex<double>& a, const std::complex<double>& b) {
  return std::abs(a - b) / (std::hypot(1.0, std::abs(a)) * std::hypot(1.0, std::abs(b)));
}

/// |a - b| within the unit circle, relative to the smaller one of the two beyond it.
double relative_distance(const std::complex<double>& a, const std::complex<double>& b) {
  return std::abs(a - b) / std::max(1.0, std::min(std::abs(a), std::abs(b)));
}

/// Determinant of [Z, v / |v|], but for (-1)^(n-1): the columns of Z are those but the first of a reflection that takes
/// v to `image` times the first unit vector. That vector stands for v / |v| when v = 0.
double orientation(double image) { return image > 0.0 ? -1.0 : 1.0; }

/// det E_s / a_s. [F, u]^T C [Z, f] with u = C f / |C f| is block triangular, with E_s and |C f| on its diagonal, and
/// det [Z, f] = det [Z, h_x / |h_x|] a_s |f|. `last` = C is overwritten, `speed` is |f|; the reflections that F and Z
/// are taken from make `flow_image` of C f and `section_image` of h_x.
ScaledReal determinant_share(Matrix& last, double speed, double section_image, double flow_image) {
  ScaledReal result = determinant_in_place(last);
  result *= orientation(section_image) * orientation(flow_image);
  if (flow_image != 0.0) result *= speed / std::abs(flow_image);
  return result;
}

/// Least change, relative to each, of f0 and f1 with which they satisfy first f0 + last f1 = 0. Where errors grow along
/// the segment it is f0 that they are measured at, where they decay f1: neither is divided by what the other lost.
double flow_defect(const RowMajorBlock& first, const Vector& f0, const RowMajorBlock& last, const Vector& f1,
                   Matrix& work) {
  const Eigen::Index n = f0.size();
  const double norm0 = f0.norm();
  const double norm1 = f1.norm();
  const double size0 = norm0 > 0.0 ? norm0 : 1.0;
  const double size1 = norm1 > 0.0 ? norm1 : 1.0;
  work.topLeftCorner(n, n) = size0 * first.transpose();
  work.bottomLeftCorner(n, n) = size1 * last.transpose();
  work.col(n).head(n) = f0 / size0;
  work.col(n).tail(n) = f1 / size1;
  return distance_to_null_space(work);
}

/// The t of least |first f0 + t image|, where image = last f1.
double trivial_multiplier(const RowMajorBlock& first, const Vector& f0, const Vector& image) {
  const double size = image.squaredNorm();
  return size > 0.0 ? -image.dot(first * f0) / size : 0.0;
}

/// The one closest to 1 first, then by the distance to the unit circle.
void sort_by_interest(std::vector<std::complex<double>>& values) {
  const auto nearest_one = [](const auto& a, const auto& b) { return std::abs(a - 1.0) < std::abs(b - 1.0); };
  std::iter_swap(values.begin(), std::min_element(values.begin(), values.end(), nearest_one));
  const auto nearer = [](const auto& a, const auto& b) {
    return std::abs(std::abs(a) - 1.0) < std::abs(std::abs(b) - 1.0);
  };
  // Stable; std::stable_sort allocates.
  for (auto next = values.begin() + 1; next != values.end(); ++next)
    std::rotate(std::upper_bound(values.begin() + 1, next, *next, nearer), next, next + 1);
}

/// Does contact segment s last no time, in a field that is continuous where it begins? Perturbations then pass it as if
/// it were not there.
bool is_passed(const DefiningSystem& defining, const Orbit& x, int s) {
  const int m = x.shape.segments;
  if (m < 2 || !defining.is_contact_segment(s) || !contact_lasts_no_time(x, s)) return false;
  const int before = defining.signature()[static_cast<std::size_t>((s + m - 1) % m)].field;
  const int own = defining.signature()[static_cast<std::size_t>(s)].field;
  Vector left(x.shape.dimension);
  Vector entered(x.shape.dimension);
  defining.system().value(FunctionKind::field, before, x.start(s), x.par.data(), left.data());
  defining.system().value(FunctionKind::field, own, x.start(s), x.par.data(), entered.data());
  return (entered - left).norm() <= level::located * left.norm();
}

/// The gradient of the section at the end of segment s; before and after a contact that is passed the orbit touches the
/// event's own, but not h_x f = 0.
void section_at_end(const DefiningSystem& defining, const Orbit& x, int s, Vector& gradient) {
  if (is_passed(defining, x, s) || is_passed(defining, x, (s + 1) % x.shape.segments)) {
    const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
    const EventAt at = event_at(defining.system(), v.event, v.field, x.end(s), x.par.data());
    gradient = rate_gradient(defining.system(), at, v.event, v.field, x.end(s), x.par.data());
    if (gradient.dot(at.f) > 0.0) gradient = -gradient;  // falling, as all sections
    return;
  }
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
}

}  // namespace

bool FloquetMultipliers::stable() const { return valid && stable_count() == static_cast<int>(values.size()); }

void FloquetMultipliers::leave_out() {
  const std::size_t kept = std::min(values.size(), static_cast<std::size_t>(known()));
  undetermined += static_cast<int>(values.size() - kept);
  values.resize(kept);
}

int FloquetMultipliers::stable_count() const {
  const auto list = nontrivial();
  double largest = 0.0;
  for (const auto& mu : list) largest = std::max(largest, std::abs(mu));
  const auto stable = std::count_if(list.begin(), list.end(), [&](const auto& mu) {
    return are_eigenvalues ? mu.real() <= level::negligible * largest : std::abs(mu) <= 1.0 + level::on_circle;
  });
  return static_cast<int>(stable + static_cast<std::ptrdiff_t>(values.size() - list.size()));
}

FloquetSolver::FloquetSolver(const OrbitShape& shape)
    : shape_(shape),
      ends_(static_cast<std::size_t>(shape.segments)),
      blocks_{std::vector<Matrix>(ends_.size()), std::vector<Matrix>(ends_.size())},
      a_sizes_(ends_.size()),
      e_sizes_(ends_.size()),
      qz_(shape.dimension - 1, shape.segments),
      f0_(shape.dimension),
      f1_(shape.dimension),
      image_(shape.dimension),
      square_(shape.dimension, shape.dimension),
      flow_rows_(2 * shape.dimension, shape.dimension + 1) {
  for (SegmentEnd& end : ends_) {
    end.tilt.setZero(shape.dimension - 1);
    end.e_across = end.a_across = end.tilt.transpose();
    end.section.resize(shape.dimension);
    end.jump.resize(shape.dimension, shape.dimension);
  }
}

void FloquetSolver::measure_end(const CondensedSystem& condensed, const Orbit& x, int s) {
  const int n = shape_.dimension;
  const DefiningSystem& defining = condensed.system();
  const HybridSystem& system = defining.system();
  const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
  const RowMajorBlock first(condensed.first_block(s), n, n);
  const RowMajorBlock last(condensed.last_block(s), n, n);
  SegmentEnd& end = ends_[static_cast<std::size_t>(s)];
  system.value(FunctionKind::field, v.field, x.start(s), x.par.data(), f0_.data());
  system.value(FunctionKind::field, v.field, x.end(s), x.par.data(), f1_.data());
  image_.noalias() = last * f1_;
  end.flow_defect = flow_defect(first, f0_, last, f1_, flow_rows_);
  if (!defining.has_event(s)) end.trivial_multiplier = trivial_multiplier(first, f0_, image_);

  section_at_end(defining, x, s, end.section);
  const double speed = f1_.norm();
  const double sizes = end.section.norm() * speed;
  end.transversality = sizes > 0.0 ? end.section.dot(f1_) / sizes : 0.0;
  const double section_image = make_reflection(end.section);
  end.projection = image_;
  const double flow_image = make_reflection(end.projection);
  image_.noalias() = first * f0_;
  reflect(end.projection, image_);
  end.tilt = image_.tail(n - 1) / image_(0);
  square_ = last;
  end.determinant_share = determinant_share(square_, speed, section_image, flow_image);

  system.first(FunctionKind::jump, v.jump, x.end(s), x.par.data(), {}, image_.data(), end.jump.data(), nullptr);
  defining.clear_absent(s, end.jump.data(), n);
  reflect(end.section, end.jump.transpose());
}

/// The blocks of segment s, from its end and that of the segment before.
void FloquetSolver::project_blocks(const CondensedSystem& condensed, int s) {
  const int n = shape_.dimension;
  const auto at = static_cast<std::size_t>(s);
  const RowMajorBlock first(condensed.first_block(s), n, n);
  const RowMajorBlock last(condensed.last_block(s), n, n);
  const SegmentEnd& end = ends_[at];
  const auto entering = ends_[at > 0 ? at - 1 : ends_.size() - 1].jump.rightCols(n - 1);
  a_sizes_[at] = first.norm() * entering.norm();
  e_sizes_[at] = last.norm();

  square_ = last;
  reflect(end.section, square_.transpose());
  reflect(end.projection, square_);
  blocks_.e[at] = square_.bottomRightCorner(n - 1, n - 1);
  ends_[at].e_across = square_.row(0).tail(n - 1);
  auto product = square_.rightCols(n - 1);
  product.noalias() = first * entering;
  reflect(end.projection, product);
  blocks_.a[at] = -product.bottomRows(n - 1);
  ends_[at].a_across = -product.row(0);
}

/// The blocks, with entries disturbed by this share of the blocks that they are projected from: what is left of these
/// at h_x f = 0 may be rounding. `way` chooses one of many such disturbances.
FloquetSolver::Blocks FloquetSolver::disturbed(double disturbance, int way) const {
  Blocks blocks = blocks_;
  double k = 0.0;
  const auto disturb = [&](Matrix& block, double size) {
    for (double& entry : block.reshaped()) {
      k += 1.0;
      entry += disturbance * size * std::cos((k + 0.1 * way) * k);  // any fixed numbers without pattern
    }
  };
  for (std::size_t s = 0; s < ends_.size(); ++s) {
    disturb(blocks.a[s], a_sizes_[s]);
    disturb(blocks.e[s], e_sizes_[s]);
  }
  return blocks;
}

/// Those of the other direction.
void FloquetSolver::tilt_blocks() {
  tilted_ = blocks_;
  for (std::size_t s = 0; s < ends_.size(); ++s) {
    tilted_.e[s].noalias() -= ends_[s].tilt * ends_[s].e_across;
    tilted_.a[s].noalias() -= ends_[s].tilt * ends_[s].a_across;
  }
}

/// May the two directions make a difference? Not where the flow stands still and there is none.
bool FloquetSolver::is_tilted() const {
  for (std::size_t s = 0; s < ends_.size(); ++s) {
    const double tilt = ends_[s].tilt.norm();
    const double share = std::max(ends_[s].e_across.norm() / blocks_.e[s].norm(),  //
                                  ends_[s].a_across.norm() / blocks_.a[s].norm());
    if (std::isinf(tilt) || tilt * share > level::tolerance) return true;
  }
  return false;
}

/// Of the product of E_s^-1 A'_s; none when the iteration fails.
void FloquetSolver::find_eigenvalues(const Blocks& blocks, std::vector<std::complex<double>>& values) {
  const int n = shape_.dimension - 1;
  for (int s = 0; s < shape_.segments; ++s) {
    const Matrix& a = blocks.a[static_cast<std::size_t>(s)];
    const Matrix& e = blocks.e[static_cast<std::size_t>(s)];
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        qz_.a(s, i, j) = a(i, j);
        qz_.e(s, i, j) = e(i, j);
      }
  }
  values.clear();
  if (!qz_.compute()) return;
  values.reserve(static_cast<std::size_t>(shape_.dimension) + 1);
  for (const ScaledComplex& mu : qz_.eigenvalues()) values.push_back(mu.value(infinite_multiplier));
  conjugate_pairs(values);
}

/// Leaves out multipliers that are farther than `most` from those among others_, and returns the largest distance of
/// the rest.
double FloquetSolver::keep_known(Distance distance, double most, FloquetMultipliers& result) {
  std::size_t known = 0;
  double largest = 0.0;
  for (const auto& mu : result.values) {
    const auto nearer = [&](const auto& a, const auto& b) { return distance(a, mu) < distance(b, mu); };
    const auto nearest = std::min_element(others_.begin(), others_.end(), nearer);
    if (nearest == others_.end()) continue;
    if (!(distance(*nearest, mu) <= most)) {
      constexpr double alike = 0.3, far_outside = 2.0;  // noise is anywhere
      const bool is_outside = std::min(std::abs(mu), std::abs(*nearest)) > far_outside;
      result.surely_outside += is_outside && relative_distance(*nearest, mu) <= alike;
      continue;
    }
    largest = std::max(largest, distance(*nearest, mu));
    others_.erase(nearest);
    result.values[known++] = mu;
  }
  result.undetermined += static_cast<int>(result.values.size() - known);
  result.values.resize(known);
  return largest;
}

/// Those that are elsewhere when everything is known a little less well, in any of several ways: what is noise may come
/// out near the same place once.
void FloquetSolver::leave_out_undetermined(FloquetMultipliers& result) {
  constexpr int ways = 5;
  for (int way = 1; way <= ways; ++way) {
    find_eigenvalues(disturbed(no_transversality, way), others_);
    keep_known(&chord, unknown, result);
  }
}

void FloquetSolver::compare_with_tilted(bool touches, FloquetMultipliers& result) {
  if (!is_tilted()) return;
  tilt_blocks();
  find_eigenvalues(tilted_, others_);
  const int before = result.undetermined;
  result.uncertainty =
      touches ? keep_known(&chord, unknown, result) : keep_known(&relative_distance, structural_bound, result);
  result.is_flow_lost = result.undetermined > before;
}

/// Zeros of states that a mode on the way has not.
void FloquetSolver::leave_out_absent(const DefiningSystem& defining, std::vector<std::complex<double>>& values) const {
  const std::ptrdiff_t absent = shape_.dimension - least_dimension(defining.system(), defining.signature());
  const auto larger = [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); };
  if (absent == 0 || static_cast<std::ptrdiff_t>(values.size()) < absent) return;
  std::nth_element(values.begin(), values.end() - absent, values.end(), larger);
  values.resize(values.size() - static_cast<std::size_t>(absent));
}

void FloquetSolver::form_products(bool touches, FloquetMultipliers& result) {
  ScaledReal regular;  // det E_1 ... det E_m / (a_1 ... a_m)
  for (const SegmentEnd& end : ends_) regular *= end.determinant_share;
  determinant_.eliminate(blocks_.e, blocks_.a);
  const auto value = [this, &regular](double t) {
    ScaledReal product = determinant_.at(t);
    product /= regular;
    return product.value(infinite_multiplier);
  };
  result.with_one = {value(1.0), 0.0};
  result.with_minus_one = {value(-1.0), 0.0};
  if (!touches) return;
  const Blocks blocks = disturbed(no_transversality, 1);
  determinant_.eliminate(blocks.e, blocks.a);
  result.with_one.uncertainty = std::abs(value(1.0) - result.with_one.value);
  result.with_minus_one.uncertainty = std::abs(value(-1.0) - result.with_minus_one.value);
}

FloquetMultipliers FloquetSolver::compute(const CondensedSystem& condensed, const Orbit& x) {
  FloquetMultipliers result;
  compute(condensed, x, result);
  return result;
}

void FloquetSolver::compute(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) {
  for (int s = 0; s < shape_.segments; ++s) measure_end(condensed, x, s);
  for (int s = 0; s < shape_.segments; ++s) project_blocks(condensed, s);
  double structural = 0.0;
  double least_transversality = 1.0;
  for (const SegmentEnd& end : ends_) {
    structural = std::max(structural, end.flow_defect);
    least_transversality = std::min(least_transversality, std::abs(end.transversality));
  }

  result.has_trivial = false;
  result.undetermined = 0;
  result.uncertainty = 0.0;
  result.is_flow_lost = result.is_mesh_coarse = false;
  result.surely_outside = 0;
  result.with_one = result.with_minus_one = {};
  result.structural = std::isfinite(structural) ? std::min(structural, infinite_multiplier) : infinite_multiplier;
  find_eigenvalues(blocks_, result.values);
  result.valid = shape_.dimension == 1 || !result.values.empty();
  if (!result.valid) return;
  leave_out_absent(condensed.system(), result.values);
  const bool touches = least_transversality < near_grazing;
  form_products(touches, result);
  if (touches) leave_out_undetermined(result);
  compare_with_tilted(touches, result);
  if (least_transversality <= no_transversality && !result.values.empty()) {
    const auto by_size = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
    const auto largest = std::max_element(result.values.begin(), result.values.end(), by_size);
    if (std::abs(*largest) > large) *largest = infinite_multiplier;
  }
  const DefiningSystem& defining = condensed.system();
  for (int s = shape_.segments - 1; s >= 0; --s) {
    if (defining.has_event(s)) continue;
    const double trivial = ends_[static_cast<std::size_t>(s)].trivial_multiplier;
    if (!result.values.empty()) sort_by_interest(result.values);
    result.has_trivial = true;
    result.structural = std::abs(trivial - 1.0);
    result.values.insert(result.values.begin(), trivial);
    return;
  }
  result.values.emplace_back(result.structural);
  sort_by_interest(result.values);
}

namespace {

constexpr int returns = 1000;
/// Before the mean is taken, for the frame to turn into the directions it stays in.
constexpr int transient = 100;

/// Modified Gram-Schmidt, twice; the lengths of what is left of each column. Columns of no length are left zero.
Eigen::VectorXd orthonormalise(Eigen::MatrixXd& frame) {
  Eigen::VectorXd lengths = Eigen::VectorXd::Ones(frame.cols());
  for (Eigen::Index k = 0; k < frame.cols(); ++k)
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index j = 0; j < k; ++j) frame.col(k) -= frame.col(j).dot(frame.col(k)) * frame.col(j);
      const double length = frame.col(k).norm();
      lengths(k) *= length;
      if (length > 0.0) frame.col(k) /= length;
    }
  return lengths;
}

/// The derivatives of the return map at the N phases, each a column.
Eigen::MatrixXd return_matrices(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x) {
  const int n = x.shape.dimension;
  const int m = system.segments_per_return();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(n) * n, system.orbits());
  for (int i = 0; i < system.orbits(); ++i) {
    const Eigen::MatrixXd a = return_matrix(condensed, x, i * m, (i + 1) * m);
    columns.col(i) = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
  }
  return columns;
}

/// That along the curve u first.
Eigen::VectorXd exponents(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve, const Eigen::VectorXd& w,
                          double rho, int states) {
  const Eigen::Index n = curve.rows();
  const auto count = static_cast<int>(matrices.cols());
  const Eigen::Index kept = states - 1;  // the direction of the flow goes to zero at once
  Eigen::MatrixXd frame = Eigen::MatrixXd::Identity(n, kept);
  for (Eigen::Index k = 0; k < frame.size(); ++k) frame.data()[k] += 0.3 * std::sin(1.0 + 2.3 * static_cast<double>(k));
  orthonormalise(frame);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kept);
  double weights = 0.0;
  for (int j = 0; j < transient + returns; ++j) {
    const double phi = j * rho - std::floor(j * rho);
    const Eigen::VectorXd a = matrices * interpolation_weights(count, phi).transpose();
    frame.col(0) = curve * interpolation_weights(count, phi, 1).transpose() + w;
    orthonormalise(frame);
    frame = Eigen::Map<const Eigen::MatrixXd>(a.data(), n, n) * frame;
    const Eigen::VectorXd lengths = orthonormalise(frame);
    if (j < transient) continue;
    const double t = (j - transient + 0.5) / returns;
    const double weight = std::exp(-1.0 / (t * (1.0 - t)));
    sum += weight * lengths.cwiseMax(std::numeric_limits<double>::min()).array().log().matrix();
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

Eigen::VectorXd moduli_along_rotation(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve,
                                      const Eigen::VectorXd& w, double rho, int states) {
  return exponents(matrices, curve, w, rho, states).array().exp();
}

FloquetMultipliers torus_multipliers(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x) {
  FloquetMultipliers result;
  const Eigen::MatrixXd matrices = return_matrices(system, condensed, x);
  const int states = least_dimension(system.system(), system.signature());
  if (!matrices.allFinite() || states < 2) return result;
  Eigen::VectorXd moduli = moduli_along_rotation(matrices, periodic_section_curve(system, x), system.winding().curve,
                                                 TorusSystem::rotation(x), states);
  std::sort(moduli.begin() + 1, moduli.end(), [](double a, double b) { return std::abs(a - 1.0) < std::abs(b - 1.0); });
  result.values.assign(moduli.begin(), moduli.end());
  result.values.emplace_back(0.0);
  result.has_trivial = true;
  result.structural = std::abs(moduli(0) - 1.0);
  result.valid = moduli.allFinite();
  return result;
}

}  // namespace tchat
