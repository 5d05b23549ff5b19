#include "stability/return_map_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/levels.hpp"
#include "model/scales.hpp"

namespace tchat {

Product product(const Eigen::VectorXcd& w, const Eigen::VectorXcd& rows) {
  return {(w.transpose() * rows)(0), w.cwiseAbs().dot(rows.cwiseAbs())};
}

double error_of_sums(const HybridSystem& system) {
  if (system.has_third()) return level::rounding_of_sums;
  constexpr double of_second = 1e-6, of_third = 1e-7;
  return system.table().derivative_order < 2 ? of_second : of_third;
}

std::optional<CriticalStart> critical_start(const Eigen::MatrixXd& k, double mu_0, std::complex<double> wanted) {
  const std::optional<Eigenvectors> all = eigenvectors(k);
  if (!all) return std::nullopt;
  Eigen::Index at = 0;
  (all->values.array() - 1.0 / (mu_0 - wanted)).abs().minCoeff(&at);
  constexpr double near = 1e-2;
  CriticalStart found{mu_0 - 1.0 / all->values(at), all->right.col(at), all->left.col(at)};
  if (!(std::abs(found.multiplier - wanted) < near)) return std::nullopt;
  Eigen::Index largest = 0;
  found.right.cwiseAbs().maxCoeff(&largest);
  found.right *= std::abs(found.right(largest)) / found.right(largest) / found.right.norm();
  found.left /= (found.left.transpose() * found.right).value();
  return found.left.allFinite() ? std::optional(std::move(found)) : std::nullopt;
}

namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;

/// cos(phi_k) and sin(phi_k), and of 2 phi_k.
constexpr double half_root = 0.86602540378443864676;
constexpr std::array<double, 3> cosine = {1.0, 0.5, -0.5}, sine = {0.0, half_root, half_root};
constexpr std::array<double, 3> cosine_twice = {1.0, -0.5, -0.5}, sine_twice = {0.0, half_root, -half_root};

const std::array<Complex, 2> one_and_i = {1.0, Complex(0.0, 1.0)};

void add(double factor, const std::vector<double>& from, std::vector<double>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

void add(double factor, const RowWeights& from, RowWeights& to) {
  add(factor, from.collocation, to.collocation);
  add(factor, from.ends, to.ends);
}

void set_zero(RowWeights& rows) {
  std::fill(rows.collocation.begin(), rows.collocation.end(), 0.0);
  std::fill(rows.ends.begin(), rows.ends.end(), 0.0);
}

void add(double factor, const OrbitVector& from, OrbitVector& to) {
  to.states += factor * from.states;
  to.durations += factor * from.durations;
}

Product contract(const RowWeights& w, const RowWeights& rows) {
  Product sum;
  double value = 0.0;
  const auto add_terms = [&](const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) value += a[i] * b[i], sum.size += std::abs(a[i] * b[i]);
  };
  add_terms(w.collocation, rows.collocation);
  add_terms(w.ends, rows.ends);
  sum.value = value;
  return sum;
}

Product contract(const OrbitVector& row, const OrbitVector& v) { return {dot(row, v), dot_of_sizes(row, v)}; }

void add(Complex factor, const Product& from, Product& to) {
  to.value += factor * from.value;
  to.size += std::abs(factor) * from.size;
}

std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

}  // namespace

ReturnMapForms::ReturnMapForms(const DefiningSystem& system, const OrbitShape& shape, bool pair)
    : system_(system),
      shape_(shape),
      n_(shape.dimension),
      map_(system, shape),
      lu_(map_.size(), map_.rows(), map_.columns()),
      expansion_(system, shape),
      condensed_rows_(index(shape.segments * n_)),
      rhs_(map_.size()),
      ends_(map_.size()),
      other_ends_(map_.size()),
      closing_(map_.size(), n_),
      matrix_(n_, n_),
      factors_(n_),
      change_(n_),
      f_(n_),
      fx_(n_, n_),
      fp_(n_, system.free_count()),
      vectors_(pair ? 2 : 1, OrbitVector(shape, system.free_count())),
      weights_(vectors_.size(), expansion_.make_rows()),
      rows_(vectors_.size() * vectors_.size(), vectors_.front()),
      second_(pair ? 3 : 1, weights_.front()),
      third_(second_),
      turned_(pair ? 2 : 0, weights_.front()),
      squares_(pair ? 3 : 0, weights_.front()),
      solutions_(second_.size(), vectors_.front()),
      scratch_(vectors_.front()),
      other_scratch_(scratch_) {
  for (OrbitVector* const v : {&scratch_, &other_scratch_}) v->set_zero();
  for (std::vector<OrbitVector>* const list : {&vectors_, &rows_, &solutions_})
    for (OrbitVector& v : *list) v.set_zero();
}

bool ReturnMapForms::factorize(CondensedSystem& condensed, const Orbit& x, double mu_0) {
  condensed_ = &condensed;
  x_ = &x;
  shift_ = mu_0;
  map_.values(condensed, x, mu_0, values_);
  if (!lu_.factorize(values_)) return false;
  put_closing();
  return closing_.allFinite();
}

void ReturnMapForms::put_closing() {
  rhs_.setZero();
  for (Eigen::Index k = 0; k < n_; ++k) {
    rhs_(map_.last_connectivity_row() + k) = 1.0;
    lu_.solve(rhs_.data(), closing_.col(k).data());
    rhs_(map_.last_connectivity_row() + k) = 0.0;
  }
}

bool ReturnMapForms::find_critical(Complex mu, CriticalVectors& found) {
  const std::optional<CriticalStart> start = critical_start(closing_.topRows(n_), shift_, mu);
  if (!start) return false;
  found.multiplier = start->multiplier;
  found.right = closing_ * start->right;
  rhs_.setZero();
  rhs_.head(n_) = start->left.real();
  lu_.solve_transposed(rhs_.data(), ends_.data());
  rhs_.head(n_) = start->left.imag();
  lu_.solve_transposed(rhs_.data(), other_ends_.data());
  found.left = ends_ + Complex(0.0, 1.0) * other_ends_;
  return normalise(found);
}

bool ReturnMapForms::normalise(CriticalVectors& vectors) const {
  const auto start = vectors.right.head(n_);
  const HybridSystem& system = system_.system();
  const Complex entry = start(largest_in_users_units(system, start));
  vectors.right *= std::abs(entry) / entry / length_in_users_units(system, start);
  const Complex overlap = (vectors.left.tail(n_).transpose() * vectors.right.head(n_)).value();
  vectors.left *= 1.0 / overlap;
  return vectors.right.allFinite() && vectors.left.allFinite();
}

Product ReturnMapForms::coefficient(const CriticalVectors& vectors, Complex critical) {
  set_vectors(vectors);
  find_rows();
  if (critical == 1.0) return square();
  find_products();
  return second_.size() == 1 ? cube() : cube_of_pair(critical);
}

/// Along all directions u_k.
void ReturnMapForms::find_products() {
  for (std::size_t k = 0; k < second_.size(); ++k) {
    scratch_.set_zero();
    add(cosine[k], vectors_.front(), scratch_);
    if (k > 0) add(sine[k], vectors_.back(), scratch_);
    expansion_.find(*x_, scratch_, second_[k], third_[k]);
  }
}

/// From the ends of segments to all nodes and rows.
void ReturnMapForms::set_vectors(const CriticalVectors& vectors) {
  for (std::size_t part = 0; part < vectors_.size(); ++part) {
    if (part == 0) ends_ = vectors.right.real(), other_ends_ = vectors.left.real();
    if (part == 1) ends_ = vectors.right.imag(), other_ends_ = vectors.left.imag();
    condensed_->extend(ends_.data(), vectors_[part]);
    const double* from = other_ends_.data();
    auto condensed = condensed_rows_.begin();
    auto ends = weights_[part].ends.begin();
    for (int s = 0; s < shape_.segments; ++s, from += 2 * n_ + 1) {
      condensed = std::copy_n(from, n_, condensed);
      ends = std::copy_n(from + n_, n_ + 1, ends);
    }
    condensed_->extend_adjoint(condensed_rows_.data(), weights_[part].collocation);
  }
}

void ReturnMapForms::find_rows() {
  const std::size_t parts = vectors_.size();
  for (std::size_t w = 0; w < parts; ++w)
    for (std::size_t v = 0; v < parts; ++v) differentiate(weights_[w], vectors_[v], rows_[w * parts + v]);
}

/// -w B(v, .); a plane across the flow does not move.
void ReturnMapForms::differentiate(const RowWeights& weights, const OrbitVector& v, OrbitVector& row) {
  row.set_zero();
  map_.subtract_derivative(*x_, weights, v, row);
  keep_planes(weights, v, 1.0, row);
}

/// Takes out of -w B(v, .), times a factor, what moves the planes across the flow.
void ReturnMapForms::keep_planes(const RowWeights& weights, const OrbitVector& v, double factor, OrbitVector& row) {
  for (int s = 0; s < shape_.segments; ++s) {
    if (system_.has_event(s)) continue;
    const Eigen::Index end = shape_.last_node(s);
    system_.system().first(FunctionKind::field, system_.signature()[index(s)].field, x_->end(s), x_->par.data(),
                           system_.free_parameters(), f_.data(), fx_.data(), fp_.data());
    const double weight = factor * weights.ends[index(s * (1 + n_))];
    row.states.col(end).noalias() += weight * (fx_.transpose() * v.states.col(end));
    row.globals.noalias() += weight * (fp_.transpose() * v.states.col(end));
  }
}

/// S(mu_0)^-1 times the condensed rows, whose sign is changed.
void ReturnMapForms::solve_ends(const RowWeights& rows, Vector& ends) {
  condensed_->condense_right_hand_side(rows.collocation, condensed_rows_.data());
  double* to = rhs_.data();
  for (int s = 0; s < shape_.segments; ++s) {
    to = std::copy_n(&condensed_rows_[index(s * n_)], n_, to);
    for (Eigen::Index a = 0; a <= n_; ++a) *to++ = -rows.ends[index(s * (1 + n_) + a)];
  }
  lu_.solve(rhs_.data(), ends.data());
}

void ReturnMapForms::solve(const RowWeights& rows, OrbitVector& h) {
  solve_ends(rows, ends_);
  condensed_->extend_condensed(ends_.data(), h);
}

/// From solutions with S(mu_0), for a right-hand side (`ends`) and for a column, to the one of S(1) ends + factor
/// column = right-hand side with q' v_1(0) = 0: returns the factor.
double ReturnMapForms::put_bordered(const Vector& column, const Vector& q, Vector& ends) const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n_ + 1, n_ + 1);
  matrix.topLeftCorner(n_, n_) = Eigen::MatrixXd::Identity(n_, n_) + (1.0 - shift_) * closing_.topRows(n_);
  matrix.topRightCorner(n_, 1) = column.head(n_);
  matrix.bottomLeftCorner(1, n_) = q.transpose();
  Vector start = Vector::Zero(n_ + 1);
  start.head(n_) = ends.head(n_);
  start = tchat::solve(matrix, start);
  ends -= start(n_) * column + (1.0 - shift_) * (closing_ * start.head(n_));
  return start(n_);
}

void ReturnMapForms::solve_across(const RowWeights& rows, const Vector& q, Eigen::Index k, OrbitVector& h) {
  map_.parameter_column(*condensed_, *x_, static_cast<int>(k), rhs_.data());
  Vector by_parameter(map_.size());
  lu_.solve(rhs_.data(), by_parameter.data());
  solve_ends(rows, ends_);
  h.globals.setZero();
  h.globals(k) = put_bordered(by_parameter, q, ends_);
  condensed_->extend_condensed(ends_.data(), h);
}

double ReturnMapForms::solve_beside(const RowWeights& rows, OrbitVector& h) {
  const Vector q = right_vector().states.col(0);
  solve_ends(rows, ends_);
  const double zeta = put_bordered(closing_ * q, q, ends_);
  h.globals.setZero();
  condensed_->extend_condensed(ends_.data(), h);
  return zeta;
}

double ReturnMapForms::solve_along_parameter(OrbitVector& h) {
  const Vector q = right_vector().states.col(0);
  map_.parameter_column(*condensed_, *x_, 0, rhs_.data());
  rhs_ = -rhs_;
  lu_.solve(rhs_.data(), ends_.data());
  const double zeta = put_bordered(closing_ * q, q, ends_);
  h.globals.setZero();
  h.globals(0) = 1.0;
  condensed_->extend(ends_.data(), h);
  return zeta;
}

ReturnMapForms::AlongVector ReturnMapForms::find_along_vector() {
  find_products();
  return {second_.front(), contract(weights_.front(), third_.front())};
}

Eigen::Index ReturnMapForms::parameter_across(const CriticalVectors& vectors) {
  Vector sizes(system_.free_count());
  for (Eigen::Index k = 0; k < sizes.size(); ++k) {
    map_.parameter_column(*condensed_, *x_, static_cast<int>(k), rhs_.data());
    sizes(k) = std::abs((vectors.left.transpose() * rhs_).value());
  }
  Eigen::Index k = 0;
  sizes.maxCoeff(&k);
  return k;
}

/// a = -W (the rows' second derivative) / 2.
Product ReturnMapForms::square() {
  Product sum;
  add(0.5, contract(rows_.front(), vectors_.front()), sum);
  return sum;
}

/// c = -W (C(V,V,V) + 3 B(V,h)) / 6.
Product ReturnMapForms::cube() {
  solve(second_.front(), solutions_.front());
  Product sum;
  add(-1.0 / 6.0, contract(weights_.front(), third_.front()), sum);
  add(0.5, contract(rows_.front(), solutions_.front()), sum);
  return sum;
}

void ReturnMapForms::combine_squares() {
  for (RowWeights& rows : squares_) set_zero(rows);
  for (std::size_t k = 0; k < second_.size(); ++k) {
    add(2.0 / 3.0, second_[k], squares_[0]);
    add(4.0 / 3.0 * cosine_twice[k], second_[k], squares_[1]);
    add(4.0 / 3.0 * sine_twice[k], second_[k], squares_[2]);
  }
}

/// The parts of the solution with mu, from those with mu_0 and a change of the start.
void ReturnMapForms::solve_twice(Complex mu) {
  const Complex distance = mu - shift_;
  for (std::size_t part = 1; part < 3; ++part) solve(squares_[part], solutions_[part]);
  matrix_ = distance * closing_.topRows(n_);
  matrix_.diagonal().array() += 1.0;
  factors_.factorize(matrix_);
  change_.real() = solutions_[1].states.col(0);
  change_.imag() = solutions_[2].states.col(0);
  factors_.solve_in_place(change_);
  change_ *= -distance;
  f_ = change_.real();
  ends_.noalias() = closing_ * f_;
  f_ = change_.imag();
  other_ends_.noalias() = closing_ * f_;
  condensed_->extend_both(ends_.data(), scratch_, other_ends_.data(), other_scratch_);
  add(1.0, scratch_, solutions_[1]);
  add(1.0, other_scratch_, solutions_[2]);
}

/// The share of third derivatives in d, from squares with their solutions.
Product ReturnMapForms::cubes_of_pair(Complex critical) {
  combine_squares();
  solve(squares_.front(), solutions_.front());
  solve_twice(critical * critical);
  Product sum;
  for (std::size_t k = 0; k < third_.size(); ++k)
    for (std::size_t w = 0; w < 2; ++w)
      add(-4.0 / 9.0 / critical * Complex(cosine[k], sine[k]) * one_and_i[w], contract(weights_[w], third_[k]), sum);
  return sum;
}

/// d = -e^(-i theta) W (C(V,V,V*) + 2 B(V,h_0) + B(V*,h_2)) / 2.
Product ReturnMapForms::cube_of_pair(Complex critical) {
  Product sum = cubes_of_pair(critical);
  for (std::size_t w = 0; w < 2; ++w)
    for (std::size_t v = 0; v < 2; ++v) {
      const OrbitVector& row = rows_[2 * w + v];  // with the other sign
      const Complex of_row = 0.5 / critical * one_and_i[w], along = one_and_i[v], against = std::conj(along);
      add(2.0 * along * of_row, contract(row, solutions_[0]), sum);
      add(against * of_row, contract(row, solutions_[1]), sum);
      add(against * one_and_i[1] * of_row, contract(row, solutions_[2]), sum);
    }
  return sum;
}

Product ReturnMapForms::on_curve(const CriticalVectors& vectors, Complex critical, const OrbitVector& growth,
                                 double factor) {
  set_vectors(vectors);
  find_products();
  OrbitVector& row = rows_.front();
  row.states = factor * growth.states;
  row.durations = factor * growth.durations;
  row.globals.setZero();
  if (second_.size() > 1) return real_cube_of_pair(critical);
  keep_planes(weights_.front(), vectors_.front(), 1.0, row);
  return cube();
}

/// With e^(-i theta) W = r + i t and V = a + i b the real part of W B(V,h_0) is g h_0 and that of W B(V*,h_2) is (g + 2
/// t B(b,.)) Re h_2 + ((r - t) B(a + b,.) - g) Im h_2, g = r B(a,.) - t B(b,.).
Product ReturnMapForms::real_cube_of_pair(Complex critical) {
  Product sum = cubes_of_pair(critical);
  for (RowWeights& weights : turned_) set_zero(weights);
  const Complex turn = 1.0 / critical;
  add(turn.real(), weights_[0], turned_[0]), add(-turn.imag(), weights_[1], turned_[0]);
  add(turn.imag(), weights_[0], turned_[1]), add(turn.real(), weights_[1], turned_[1]);
  OrbitVector& growth = rows_[0];
  keep_planes(turned_[0], vectors_[0], 1.0, growth);
  keep_planes(turned_[1], vectors_[1], -1.0, growth);
  differentiate(turned_[1], vectors_[1], rows_[1]);
  add(-1.0, turned_[1], turned_[0]);
  add(1.0, vectors_[1], vectors_[0]);
  differentiate(turned_[0], vectors_[0], rows_[2]);
  add(1.0, contract(growth, solutions_[0]), sum);
  add(0.5, contract(growth, solutions_[1]), sum);
  add(1.0, contract(rows_[1], solutions_[1]), sum);
  add(0.5, contract(rows_[2], solutions_[2]), sum);
  add(-0.5, contract(growth, solutions_[2]), sum);
  return sum;
}

}  // namespace tchat
