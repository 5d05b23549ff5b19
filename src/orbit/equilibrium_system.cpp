#include "orbit/equilibrium_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "orbit/condensed_system.hpp"

namespace tchat {

EquilibriumSystem::EquilibriumSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : DefiningSystem(system, std::move(signature), std::move(free_parameters)),
      by_state_(static_cast<std::size_t>(dimension() * dimension())),
      by_parameter_(static_cast<std::size_t>(dimension() * free_count())) {}

void EquilibriumSystem::coupling_pattern(int s, CouplingPattern& pattern) const {
  pattern.duration(0, 1, s);
  pattern.end(1, dimension(), s);
  pattern.globals(1, dimension());
}

void EquilibriumSystem::coupling_values(int s, const Orbit& x, double* values) const {
  *values++ = x.duration(s);
  system().value(FunctionKind::field, field(), x.end(s), x.par.data(), values);
}

double* EquilibriumSystem::coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const {
  const int n = dimension();
  *values++ = x.duration(s);
  *entries++ = 1.0;
  system().first(FunctionKind::field, field(), x.end(s), x.par.data(), free_parameters(), values, by_state_.data(),
                 by_parameter_.data());
  const auto put = [&](const std::vector<double>& by_columns, int columns) {
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < columns; ++b) *entries++ = by_columns[static_cast<std::size_t>(b * n + a)];
  };
  put(by_state_, n);
  put(by_parameter_, free_count());
  return entries;
}

std::string EquilibriumSystem::coupling_name(int, int r) const {
  return r == 0 ? "the duration, which is 0" : fmt::format("rate of {}", system().state_name(r));
}

std::string EquilibriumSystem::coupling_failure(int s, const Orbit& x) const {
  const std::string name = system().function_name(FunctionKind::field, field());
  std::vector<double> values(static_cast<std::size_t>(coupling_rows(s)));
  std::vector<double> entries(1 + by_state_.size() + by_parameter_.size());
  coupling_derivatives(s, x, values.data(), entries.data());
  for (int r = 0; r < coupling_rows(s); ++r)
    if (!all_finite(&values[static_cast<std::size_t>(r)], 1))
      return fmt::format("the {} by field {} ({}) is not finite", coupling_name(s, r), field(), name);
  const bool finite = all_finite(entries.data(), static_cast<int>(entries.size()));
  return finite ? "" : fmt::format("a derivative of field {} ({}) is not finite", field(), name);
}

namespace {

/// [f_x f_p; t^T] with rows divided by |r| + (1 + |x| + |p|) |dr/ds|, p and t in units of the parameter's size.
Eigen::MatrixXd bordered_by_tangent(const DefiningSystem& system, const Orbit& x, const OrbitVector& tangent) {
  const int n = system.dimension();
  const HybridSystem& problem = system.system();
  const int field = system.signature().front().field;
  const std::vector<int>& free = system.free_parameters();
  const double* state = x.end(0);
  const double unit = parameter_size(system, x, 0);
  Eigen::VectorXd t(n + 1), along(n + 1);
  t << tangent.states.col(0), tangent.globals(0) / unit;
  t.normalize();
  along << t.head(n), unit * t(n);
  Eigen::VectorXd f(n);
  Eigen::MatrixXd rows(n, n + 1);
  Eigen::MatrixXd slopes(n, n + 1);  // d rows / ds
  problem.first(FunctionKind::field, field, state, x.par.data(), free, f.data(), rows.data(), rows.col(n).data());
  problem.second(FunctionKind::field, field, state, x.par.data(), free, along.data(), f.data(), slopes.data(),
                 slopes.col(n).data());
  rows.col(n) *= unit;
  slopes.col(n) *= unit;
  const double size =
      1.0 + Eigen::Map<const Eigen::VectorXd>(state, n).norm() + std::abs(x.par(free.front() - 1)) / unit;
  Eigen::MatrixXd matrix(n + 1, n + 1);
  matrix << rows, t.transpose();
  for (int a = 0; a < n; ++a)
    if (const double scale = rows.row(a).norm() + size * slopes.row(a).norm(); scale > 0.0) matrix.row(a) /= scale;
  return matrix;
}

}  // namespace

std::optional<double> EquilibriumSystem::singular_distance(const Orbit& x, const OrbitVector& tangent) const {
  const Eigen::MatrixXd matrix = bordered_by_tangent(*this, x, tangent);
  if (!matrix.allFinite()) return 0.0;
  const PivotedLu lu(matrix);
  int sign = lu.parity();
  for (const double pivot : lu.pivots()) sign *= pivot > 0.0 ? 1 : pivot < 0.0 ? -1 : 0;
  return sign * least_singular_value(matrix.cast<std::complex<double>>());
}

std::vector<OrbitVector> EquilibriumSystem::crossing_directions(const Orbit& x, const OrbitVector& tangent) const {
  constexpr double as_near = 100.0;  // as the first is to a null vector: those of a symmetry are equally near
  const int n = dimension();
  const Eigen::MatrixXd matrix = bordered_by_tangent(*this, x, tangent);
  Eigen::MatrixXd normal = matrix.transpose() * matrix;
  const double size = normal.norm();
  double nearest = level::rounding * matrix.norm();
  std::vector<OrbitVector> directions;
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd v = eigenvector(normal, 0.0).real().normalized();
    const double distance = (matrix * v).norm();
    if (k == 0)
      nearest = std::min(std::max(nearest, as_near * distance), level::visible * matrix.norm());
    else if (!(distance <= nearest))
      break;
    OrbitVector direction = tangent;
    direction.set_zero();
    direction.states = v.head(n).replicate(1, direction.states.cols());
    direction.globals(0) = v(n) * parameter_size(*this, x, 0);
    directions.push_back(std::move(direction));
    normal += size * v * v.transpose();
  }
  return directions;
}

EquilibriumFold::EquilibriumFold(const DefiningSystem& system, const OrbitShape& shape)
    : system_(system),
      direction_(static_cast<std::size_t>(shape.dimension + system.free_count()), 0.0),
      field_(shape.dimension),
      jacobian_(shape.dimension, shape.dimension),
      by_state_(shape.dimension, shape.dimension),
      by_parameter_(shape.dimension, system.free_count()),
      column_(shape.dimension),
      row_(shape.dimension),
      gradient_(shape, system.free_count()) {
  begin_border();
}

/// Any border that leaves the matrix regular.
void EquilibriumFold::begin_border() {
  for (Eigen::Index i = 0; i < column_.size(); ++i) {
    column_(i) = std::sin(1.0 + 0.7 * static_cast<double>(i));
    row_(i) = std::cos(0.3 + 0.9 * static_cast<double>(i));
  }
  column_.normalize();
  row_.normalize();
}

void EquilibriumFold::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), column_.begin(), column_.end());
  memory.insert(memory.end(), row_.begin(), row_.end());
}

void EquilibriumFold::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return begin_border();
  std::copy_n(memory.begin(), column_.size(), column_.begin());
  std::copy_n(memory.begin() + column_.size(), row_.size(), row_.begin());
}

bool EquilibriumFold::solve_bordered() {
  const Eigen::Index n = column_.size();
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 1, n + 1);
  bordered.topLeftCorner(n, n) = jacobian_;
  bordered.topRightCorner(n, 1) = column_;
  bordered.bottomLeftCorner(1, n) = row_.transpose();
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n + 1, n);
  const Eigen::VectorXd right = solve(bordered, unit);
  const Eigen::VectorXd left = solve(bordered.transpose(), unit);
  v_ = right.head(n);
  w_ = left.head(n);
  value_ = right(n);
  return right.allFinite() && left.allFinite();
}

bool EquilibriumFold::evaluate(CondensedSystem&, const Orbit& x) {
  const int field = system_.signature().front().field;
  const HybridSystem& problem = system_.system();
  problem.first(FunctionKind::field, field, x.end(0), x.par.data(), {}, field_.data(), jacobian_.data(), nullptr);
  // The border follows the null vectors; the first time it takes some rounds to find them.
  for (int round = started_ ? 3 : 0; round < 4; ++round) {
    if (!solve_bordered()) return false;
    column_ = w_.normalized();
    row_ = v_.normalized();
  }
  started_ = true;
  std::copy(v_.begin(), v_.end(), direction_.begin());
  problem.second(FunctionKind::field, field, x.end(0), x.par.data(), system_.free_parameters(), direction_.data(),
                 field_.data(), by_state_.data(), by_parameter_.data());
  gradient_.set_zero();
  gradient_.states.col(gradient_.states.cols() - 1) = -by_state_.transpose() * w_;
  gradient_.globals = -by_parameter_.transpose() * w_;
  cusp_ = column_.dot(by_state_ * row_) / v_.norm();
  return by_state_.allFinite() && by_parameter_.allFinite();
}

HopfPair::HopfPair(const DefiningSystem& system, const OrbitShape& shape, std::optional<double> omega)
    : system_(system),
      first_omega_(omega),
      jacobian_(shape.dimension, shape.dimension),
      by_state_(shape.dimension, shape.dimension),
      by_parameter_(shape.dimension, system.free_count()),
      field_(shape.dimension),
      direction_(static_cast<std::size_t>(shape.dimension + system.free_count()), 0.0),
      pair_(Eigen::Matrix2d::Zero()),
      plane_(shape.dimension, 2),
      gradient_(shape, system.free_count()) {}

void HopfPair::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), pair_.data(), pair_.data() + pair_.size());
  memory.insert(memory.end(), plane_.data(), plane_.data() + plane_.size());
}

void HopfPair::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return;
  std::copy_n(memory.begin(), pair_.size(), pair_.data());
  std::copy_n(memory.begin() + pair_.size(), plane_.size(), plane_.data());
}

std::string HopfPair::beyond_end() const {
  return square() < 0.0 ? "the pair of eigenvalues has become real: a curve of Hopf bifurcations ends, and neutral "
                          "saddles follow"
                        : "";
}

/// At a double eigenvalue 0, which rounding may have made two real ones: the plane that f_x f_x maps to nearly nothing.
bool HopfPair::begin_at_double_zero() {
  const auto beyond = [size = level::visible * jacobian_.norm()](const auto& value) { return std::abs(value) > size; };
  const Eigen::VectorXcd values = eigenvalues(jacobian_);
  if (values.size() - std::count_if(values.begin(), values.end(), beyond) != 2) return false;
  const Eigen::MatrixXd square = jacobian_ * jacobian_;
  plane_ = singular_vectors(square).right.rightCols<2>();
  pair_ = plane_.transpose() * jacobian_ * plane_;
  return started_ = true;
}

/// The plane of the eigenvector of the chosen pair.
bool HopfPair::begin() {
  constexpr double about_critical = 0.1;
  const auto distance = [this](const std::complex<double>& value) {
    return first_omega_ ? std::abs(value - std::complex<double>(0.0, *first_omega_))
                        : std::abs(value.real() / value.imag());
  };
  const Eigen::VectorXcd values = eigenvalues(jacobian_);
  const std::complex<double>* nearest = nullptr;
  for (const auto& value : values)
    if (value.imag() > 0.0 && (nearest == nullptr || distance(value) < distance(*nearest))) nearest = &value;
  const bool is_critical = nearest != nullptr && std::abs(nearest->real()) < about_critical * nearest->imag();
  if (!is_critical && begin_at_double_zero()) return true;
  if (nearest == nullptr) return false;
  const std::complex<double> chosen = *nearest;
  const Eigen::VectorXcd vector = eigenvector(jacobian_, chosen);
  plane_.col(0) = vector.real();
  plane_.col(1) = vector.imag();
  // f_x (u + i v) = (a + i b) (u + i v)
  pair_ << chosen.real(), chosen.imag(), -chosen.imag(), chosen.real();
  orthonormalise();
  started_ = true;
  return plane_.allFinite();
}

/// V = Q R: Q for V, R L R^-1 for L.
void HopfPair::orthonormalise() {
  Eigen::Matrix2d r = Eigen::Matrix2d::Zero();
  r(0, 0) = plane_.col(0).norm();
  plane_.col(0) /= r(0, 0);
  r(0, 1) = plane_.col(0).dot(plane_.col(1));
  plane_.col(1) -= r(0, 1) * plane_.col(0);
  r(1, 1) = plane_.col(1).norm();
  plane_.col(1) /= r(1, 1);
  Eigen::Matrix2d inverse;
  inverse << 1.0 / r(0, 0), -r(0, 1) / (r(0, 0) * r(1, 1)), 0.0, 1.0 / r(1, 1);
  pair_ = r * pair_ * inverse;
}

/// Of (V, L), both column by column.
Eigen::MatrixXd HopfPair::newton_matrix(const Plane& border) const {
  const Eigen::Index n = plane_.rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n + 4, 2 * n + 4);
  for (int k = 0; k < 2; ++k) {
    matrix.block(k * n, k * n, n, n) = jacobian_;
    for (int j = 0; j < 2; ++j) {
      matrix.block(k * n, j * n, n, n).diagonal().array() -= pair_(j, k);
      matrix.block(k * n, 2 * n + 2 * k + j, n, 1) = -plane_.col(j);
    }
    matrix.block(2 * n + 2 * k, k * n, 2, n) = border.transpose();
  }
  return matrix;
}

bool HopfPair::find_plane() {
  constexpr int most_iterations = 12;
  const Eigen::Index n = plane_.rows();
  const Plane border = plane_;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    Eigen::VectorXd defect(2 * n + 4);
    const Plane rest = jacobian_ * plane_ - plane_ * pair_;
    const Eigen::Matrix2d distance = border.transpose() * plane_ - Eigen::Matrix2d::Identity();
    defect << rest.col(0), rest.col(1), distance.col(0), distance.col(1);
    const Eigen::VectorXd change = solve(newton_matrix(border), -defect);
    if (!change.allFinite()) return false;
    plane_.col(0) += change.segment(0, n);
    plane_.col(1) += change.segment(n, n);
    pair_.col(0) += change.segment(2 * n, 2);
    pair_.col(1) += change.segment(2 * n + 2, 2);
    const double size = change.head(2 * n).norm() + change.tail(4).norm() / jacobian_.norm();
    if (size < level::rounding_of_sums) return true;
    if (size < level::stalled && iteration + 1 == most_iterations) return true;
  }
  return false;
}

/// -w^T (d f_x) v.
void HopfPair::add_gradient(const Orbit& x, const Eigen::VectorXd& v, const Eigen::VectorXd& w) {
  std::copy(v.begin(), v.end(), direction_.begin());
  system_.system().second(FunctionKind::field, system_.signature().front().field, x.end(0), x.par.data(),
                          system_.free_parameters(), direction_.data(), field_.data(), by_state_.data(),
                          by_parameter_.data());
  gradient_.states.col(gradient_.states.cols() - 1) -= by_state_.transpose() * w;
  gradient_.globals -= by_parameter_.transpose() * w;
}

bool HopfPair::evaluate(CondensedSystem&, const Orbit& x) {
  const Eigen::Index n = plane_.rows();
  system_.system().first(FunctionKind::field, system_.signature().front().field, x.end(0), x.par.data(), {},
                         field_.data(), jacobian_.data(), nullptr);
  if (!jacobian_.allFinite() || (!started_ && !begin()) || !find_plane()) return false;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n + 4);
  right(2 * n) = 1.0;
  right(2 * n + 3) = 1.0;
  const Eigen::VectorXd w = solve(newton_matrix(plane_).transpose(), right);
  gradient_.set_zero();
  for (int k = 0; k < 2; ++k) add_gradient(x, plane_.col(k), w.segment(k * n, n));
  orthonormalise();
  return gradient_.states.allFinite() && gradient_.globals.allFinite();
}

std::optional<NearbyEquilibrium> find_equilibrium(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                                  const double* par, const std::vector<Eigen::Index>& ignored,
                                                  const Eigen::VectorXd& sizes) {
  constexpr int most_steps = 20;
  constexpr double smallest = level::rounding / level::converged;  // of the largest size: rounding of it is no change
  const Eigen::Index n = near.size();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i)
    if (std::find(ignored.begin(), ignored.end(), i) == ignored.end()) kept.push_back(i);
  Eigen::VectorXd x = near, f(n);
  Eigen::MatrixXd fx(n, n);
  for (int step = 0; step < most_steps; ++step) {
    system.first(FunctionKind::field, field, x.data(), par, {}, f.data(), fx.data(), nullptr);
    if (!f.allFinite() || !fx.allFinite()) return std::nullopt;
    const Eigen::MatrixXd jacobian = fx(kept, kept);
    Eigen::VectorXd value(jacobian.rows());
    for (Eigen::Index i = 0; i < value.size(); ++i) value(i) = f(kept[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd dx = least_squares(jacobian, -value);
    if (!dx.allFinite()) return std::nullopt;
    for (Eigen::Index i = 0; i < dx.size(); ++i) x(kept[static_cast<std::size_t>(i)]) += dx(i);
    const Eigen::VectorXd all = sizes.cwiseMax(x.cwiseAbs());
    const Eigen::VectorXd size = all(kept).cwiseMax(smallest * all(kept).maxCoeff());
    if ((dx.array().abs() > level::converged * size.array()).any()) continue;
    // Where f_x is singular the shortest step may leave f as it is.
    const Eigen::VectorXd left = jacobian * dx + value, terms = jacobian.cwiseAbs() * size;
    if ((left.array().abs() > level::converged * terms.array()).any()) return std::nullopt;
    return NearbyEquilibrium{x, jacobian};
  }
  return std::nullopt;
}

std::optional<NearbyFold> find_fold(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                    const Eigen::VectorXd& start, int active, const Eigen::VectorXd& sizes) {
  constexpr int most_steps = 30;
  constexpr double converged = level::differences;  // f's double zero leaves half of the digits
  const Eigen::Index n = near.size();
  const int parameters[] = {active};
  Eigen::VectorXd x = near, par = start, f(n), fv(n), fp(n), fvp(n), rows, of_parameter;
  Eigen::MatrixXd fx(n, n), fvx(n, n);
  double curvature = 0.0;  // at the start
  for (int step = 0; step < most_steps; ++step) {
    system.first(FunctionKind::field, field, x.data(), par.data(), parameters, f.data(), fx.data(), fp.data());
    if (!f.allFinite() || !fx.allFinite()) return std::nullopt;
    if (step == 0) {
      rows = (fx.cwiseAbs() * sizes).cwiseMax(f.cwiseAbs()).cwiseInverse();
      if (!rows.allFinite()) return std::nullopt;
      of_parameter = rows.asDiagonal() * fp.cwiseAbs();
    }
    const Eigen::MatrixXd scaled = rows.asDiagonal() * fx * sizes.asDiagonal();
    const SingularVectors least = singular_vectors(scaled);
    const Eigen::VectorXd v = sizes.asDiagonal() * least.right.col(n - 1);
    const Eigen::VectorXd w = rows.asDiagonal() * least.left.col(n - 1);
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n + 1);
    direction.head(n) = v;
    system.second(FunctionKind::field, field, x.data(), par.data(), parameters, direction.data(), fv.data(), fvx.data(),
                  fvp.data());
    if (step == 0) curvature = std::abs(w.dot(fvx * v));
    Eigen::MatrixXd matrix(n + 1, n + 1);
    matrix << scaled, rows.asDiagonal() * fp, w.transpose() * fvx * sizes.asDiagonal(), w.dot(fvp);
    Eigen::VectorXd value(n + 1);
    value << rows.asDiagonal() * f, w.dot(fx * v);
    const Eigen::VectorXd change = solve(matrix, -value);
    if (!change.allFinite()) return std::nullopt;
    x += sizes.asDiagonal() * change.head(n);
    double& p = par(active - 1);
    p += change(n);
    const bool stays = change.head(n).norm() <= converged && (of_parameter * change(n)).norm() <= converged;
    if (!stays) continue;
    // Where w^T f_p = 0 the equilibria do not end; where the curvature is lost, f as a whole has become zero.
    const double least_share = level::visible * least.left.col(n - 1).cwiseAbs().dot(of_parameter);
    const bool is_fold = std::abs(w.dot(fp)) > least_share && std::abs(w.dot(fvx * v)) > level::visible * curvature;
    return is_fold ? std::optional(NearbyFold{x, p, fx}) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace tchat
