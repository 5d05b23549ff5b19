#include "stability/periodic_qz.hpp"

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
using Scalar = PeriodicQz::Scalar;

double size1(const Scalar& z) { return std::abs(z.real()) + std::abs(z.imag()); }

// The operators of std::complex look after overflow and infinities, which there are none of in factors of size about 1
// with regular diagonals.
Scalar times(const Scalar& y, const Scalar& z) {
  return {y.real() * z.real() - y.imag() * z.imag(), y.real() * z.imag() + y.imag() * z.real()};
}

Scalar inverse(const Scalar& z) {
  const double inverse_square = 1.0 / std::norm(z);
  return {z.real() * inverse_square, -z.imag() * inverse_square};
}

Scalar times_power(const Scalar& z, long exponent) {
  constexpr long beyond = 4000;  // of any double
  const int e = static_cast<int>(std::clamp(exponent, -beyond, beyond));
  return {std::ldexp(z.real(), e), std::ldexp(z.imag(), e)};
}

/// The power of two to take out of numbers of this size; none where products of several can be formed as they are.
int exponent_of(double size) {
  constexpr double largest = 0x1p100;
  if (size < largest && size * largest > 1.0) return 0;
  if (size == 0.0 || !std::isfinite(size)) return 0;
  int exponent = 0;
  std::frexp(size, &exponent);
  return exponent;
}

/// Now and then a shift is no eigenvalue of any block, so that no iteration goes round in circles.
bool is_exceptional(int iteration) { return iteration % 10 == 9; }

void rescale(ScaledComplex& z) {
  const int exponent = exponent_of(size1(z.mantissa));
  if (exponent == 0) return;
  z.mantissa = times_power(z.mantissa, -exponent);
  z.exponent += exponent;
}

}  // namespace

std::complex<double> ScaledComplex::value(double cap) const {
  const double modulus = std::abs(mantissa);
  if (modulus == 0.0 || !std::isfinite(modulus)) return modulus == 0.0 ? 0.0 : cap;
  const double log2_modulus = std::log2(modulus) + static_cast<double>(exponent);
  if (log2_modulus > std::log2(cap)) return mantissa / modulus * cap;
  if (log2_modulus < -1000.0) return 0.0;
  const int e = static_cast<int>(exponent);
  return {std::ldexp(mantissa.real(), e), std::ldexp(mantissa.imag(), e)};
}

/// The unitary [c s; -conj(s) c] with c real.
struct PeriodicQz::Rotation {
  double c = 1.0;
  Scalar s = 0.0;

  void apply(Scalar& x, Scalar& y) const {
    const Scalar old = x;
    x = c * old + times(s, y);
    y = c * y - times(std::conj(s), old);
  }

  /// Maps (f, g) to (r, 0).
  static Rotation zero_second(const Scalar& f, const Scalar& g) {
    constexpr double least = 1e-280;
    if (g == 0.0) return {};
    const double square = std::norm(f);
    const double product = square * (square + std::norm(g));
    if (product < least) return zero_second_of_small(f, g);
    const double scale = 1.0 / std::sqrt(product);
    return {square * scale, scale * times(f, std::conj(g))};
  }

  /// Without squares, which may vanish.
  static Rotation zero_second_of_small(const Scalar& f, const Scalar& g) {
    const double af = std::abs(f);
    const double ag = std::abs(g);
    if (af == 0.0) return {0.0, std::conj(g) / ag};
    const double r = std::hypot(af, ag);
    return {af / r, (f / af) * std::conj(g) / r};
  }

  /// Maps the row (f, g) to (0, r) from the right, as rotate_columns() applies it.
  static Rotation zero_first(const Scalar& f, const Scalar& g) {
    const Rotation z = zero_second(std::conj(g), std::conj(f));
    return {z.c, -std::conj(z.s)};
  }
};

/// [first off; 0 last] * 2^exponent
struct PeriodicQz::TriangularBlock {
  Scalar first = 1.0;
  Scalar off = 0.0;
  Scalar last = 1.0;
  long exponent = 0;

  /// By [p q; 0 r] from the left.
  void multiply(const Scalar& p, const Scalar& q, const Scalar& r) {
    first = times(p, first);
    off = times(p, off) + times(q, last);
    last = times(r, last);
    const int shift = exponent_of(size1(first) + size1(off) + size1(last));
    if (shift == 0) return;
    for (Scalar* entry : {&first, &off, &last}) *entry = times_power(*entry, -shift);
    exponent += shift;
  }
};

PeriodicQz::PeriodicQz(int size, int factors)
    : n_(size),
      m_(factors),
      a_(static_cast<std::size_t>(size * size * factors)),
      e_(a_.size()),
      scale_(2 * static_cast<std::size_t>(factors)),
      eigenvalues_(static_cast<std::size_t>(size)) {}

bool PeriodicQz::compute() {
  if (!finite()) return false;
  normalise();
  triangularise();
  hessenberg();
  regularise();
  return iterate();
}

bool PeriodicQz::finite() const {
  const auto good = [](const Scalar& z) { return std::isfinite(z.real()) && std::isfinite(z.imag()); };
  return std::all_of(a_.begin(), a_.end(), good) && std::all_of(e_.begin(), e_.end(), good);
}

/// Scales every factor by a power of two to size about 1.
void PeriodicQz::normalise() {
  const std::size_t block = static_cast<std::size_t>(n_ * n_);
  const auto take_out = [&](std::vector<Scalar>& factor, int s) {
    const auto begin = factor.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(s) * block);
    double size = 0.0;
    for (auto z = begin; z != begin + static_cast<std::ptrdiff_t>(block); ++z) size = std::max(size, size1(*z));
    int exponent = 0;
    if (size > 0.0) std::frexp(size, &exponent);
    exponent = std::max(exponent, -1000);  // the power is to be a number
    const double power = std::ldexp(1.0, -exponent);
    for (auto z = begin; z != begin + static_cast<std::ptrdiff_t>(block); ++z) *z *= power;
    return static_cast<long>(exponent);
  };
  for (int s = 0; s < m_; ++s) {
    scale_[2 * static_cast<std::size_t>(s)] = take_out(a_, s);
    scale_[2 * static_cast<std::size_t>(s) + 1] = take_out(e_, s);
  }
}

/// Rows k-1, k of factor s from the left.
void PeriodicQz::rotate_rows(std::vector<Scalar>& matrix, int s, int k, const Rotation& r, const Range& columns) {
  Scalar* x = matrix.data() + at(s, k - 1, columns.first);
  for (int c = columns.first; c <= columns.last; ++c, x += n_) r.apply(x[0], x[1]);
}

/// Columns k-1, k of factor s from the right, by the conjugate transpose of what rotate_rows applies.
void PeriodicQz::rotate_columns(std::vector<Scalar>& matrix, int s, int k, const Rotation& r, const Range& rows) {
  const Rotation conjugate{r.c, std::conj(r.s)};
  Scalar* x = matrix.data() + at(s, rows.first, k - 1);
  for (int i = rows.first; i <= rows.last; ++i, ++x) conjugate.apply(x[0], x[n_]);
}

/// E_m, A_m, E_(m-1), ..., E_1 one after the other to upper triangular form; A_1 stays full.
void PeriodicQz::triangularise() {
  for (int s = m_ - 1; s >= 0; --s) {
    // Rows of the pair (A_s, E_s): E_s triangular, from the left.
    for (int c = 0; c < n_ - 1; ++c)
      for (int k = n_ - 1; k > c; --k) {
        const Rotation r = Rotation::zero_second(e(s, k - 1, c), e(s, k, c));
        rotate_rows(e_, s, k, r, {c, n_ - 1});
        rotate_rows(a_, s, k, r, all());
        e(s, k, c) = 0.0;
      }
    if (s == 0) break;
    // Columns of A_s and of E_(s-1): A_s triangular, from the right.
    for (int row = n_ - 1; row > 0; --row)
      for (int k = 1; k <= row; ++k) {
        const Rotation r = Rotation::zero_first(a(s, row, k - 1), a(s, row, k));
        rotate_columns(a_, s, k, r, {0, row});
        rotate_columns(e_, s - 1, k, r, all());
        a(s, row, k - 1) = 0.0;
      }
  }
}

/// A rotation of rows k-1, k of the pair (A_1, E_1) has filled E_1(k, k-1): carry it round the cycle, restoring every
/// triangular factor within the window, until it acts on columns k-1, k of A_1, which are zero below `last_row`.
void PeriodicQz::chase(int k, const Range& window, int last_row) {
  const Range rows{window.first, k};
  const Range columns{k - 1, window.last};
  for (int s = 0; s < m_; ++s) {
    const Rotation right = Rotation::zero_first(e(s, k, k - 1), e(s, k, k));
    rotate_columns(e_, s, k, right, rows);
    e(s, k, k - 1) = 0.0;
    const int next = (s + 1) % m_;
    rotate_columns(a_, next, k, right, next == 0 ? Range{window.first, last_row} : rows);
    if (next == 0) return;
    const Rotation left = Rotation::zero_second(a(next, k - 1, k - 1), a(next, k, k - 1));
    rotate_rows(a_, next, k, left, columns);
    rotate_rows(e_, next, k, left, columns);
    a(next, k, k - 1) = 0.0;
  }
}

void PeriodicQz::hessenberg() {
  for (int c = 0; c < n_ - 2; ++c)
    for (int k = n_ - 1; k > c + 1; --k) {
      const Rotation r = Rotation::zero_second(a(0, k - 1, c), a(0, k, c));
      rotate_rows(a_, 0, k, r, {c, n_ - 1});
      rotate_rows(e_, 0, k, r, {k - 1, n_ - 1});
      a(0, k, c) = 0.0;
      chase(k, all(), n_ - 1);
    }
}

/// Diagonal entries of triangular factors that are zero to rounding become rounding-level numbers.
void PeriodicQz::regularise() {
  static constexpr double floor = epsilon / 8;
  const auto lift = [](Scalar& z) {
    if (std::norm(z) >= floor * floor) return;
    const double size = std::abs(z);
    z = size > 0.0 ? z / size * floor : Scalar(floor);
  };
  for (int s = 0; s < m_; ++s)
    for (int k = 0; k < n_; ++k) {
      lift(e(s, k, k));
      if (s > 0) lift(a(s, k, k));
    }
}

/// The 2 x 2 diagonal block of T = E_m^-1 A_m ... E_1^-1 at rows k-1, k.
PeriodicQz::TriangularBlock PeriodicQz::triangular_block(int k) const {
  TriangularBlock t;
  for (int s = 0; s < m_; ++s) {
    if (s > 0) t.multiply(a(s, k - 1, k - 1), a(s, k - 1, k), a(s, k, k));
    const Scalar p = inverse(e(s, k - 1, k - 1));
    const Scalar r = inverse(e(s, k, k));
    t.multiply(p, -times(times(p, e(s, k - 1, k)), r), r);
  }
  return t;
}

/// Do the eigenvalues of T's block at rows k-1, k (`t`) times that of A_1 (T A_1's own where the window ends there)
/// differ so much that half of the digits of the smaller one are lost beside the larger?
bool PeriodicQz::graded(const TriangularBlock& t, int k) const {
  constexpr double share = level::double_zero;
  const double size = size1(a(0, k - 1, k - 1)) + size1(a(0, k - 1, k)) + size1(a(0, k, k - 1)) + size1(a(0, k, k));
  if (size < std::numeric_limits<double>::min()) return false;
  const double scale = 1.0 / size;  // squares of what is small may vanish
  const Scalar upper_left = scale * a(0, k - 1, k - 1);
  const Scalar lower_left = scale * a(0, k, k - 1);
  const Scalar lower_right = scale * a(0, k, k);
  const Scalar determinant =
      times(times(t.first, t.last), times(upper_left, lower_right) - times(scale * a(0, k - 1, k), lower_left));
  const Scalar sum = times(t.first, upper_left) + times(t.off, lower_left) + times(t.last, lower_right);
  return size1(determinant) < share * std::norm(sum);
}

/// The eigenvalue of the trailing block of T A_1 nearest to its last entry; now and then an exceptional one. `t` is the
/// block of T there.
ScaledComplex PeriodicQz::shift(const TriangularBlock& t, int high, int iteration) const {
  const Scalar first = times(t.first, a(0, high - 1, high - 1)) + times(t.off, a(0, high, high - 1));
  const Scalar upper = times(t.first, a(0, high - 1, high)) + times(t.off, a(0, high, high));
  const Scalar lower = times(t.last, a(0, high, high - 1));
  const Scalar last = times(t.last, a(0, high, high));
  ScaledComplex result{size1(lower) + size1(last), t.exponent};  // exceptional
  if (!is_exceptional(iteration)) {
    const Scalar half_difference = 0.5 * (first - last);
    const Scalar off = times(upper, lower);
    const Scalar root = std::sqrt(times(half_difference, half_difference) + off);
    const Scalar sum = half_difference + root;
    const Scalar difference = half_difference - root;
    const Scalar larger = size1(sum) > size1(difference) ? sum : difference;
    result.mantissa = larger == 0.0 ? last : last - off / larger;
  }
  rescale(result);
  return result;
}

/// Takes the first column of T A_1 - shift, of which two entries are not zero, to a multiple of the first unit vector.
/// `t` is the leading block of T.
PeriodicQz::Rotation PeriodicQz::first_rotation(const TriangularBlock& t, int low, const ScaledComplex& shift) const {
  Scalar first = times(t.first, a(0, low, low)) + times(t.off, a(0, low + 1, low));
  Scalar second = times(t.last, a(0, low + 1, low));
  Scalar subtracted = shift.mantissa;
  if (shift.exponent > t.exponent) {
    first = times_power(first, t.exponent - shift.exponent);
    second = times_power(second, t.exponent - shift.exponent);
  } else if (shift.exponent < t.exponent) {
    subtracted = times_power(subtracted, shift.exponent - t.exponent);
  }
  return Rotation::zero_second(first - subtracted, second);
}

/// A rotation of the space of x_1 acts on columns k-1, k of A_1 and of E_m; it is carried backwards through the cycle
/// by restoring E_m from the left, then A_m from the right, ... until E_1 has been restored from the left.
void PeriodicQz::chase_backwards(int k, const Range& window, const Rotation& r) {
  const Range rows{window.first, k};
  const Range columns{k - 1, window.last};
  rotate_columns(a_, 0, k, r, {window.first, std::min(k + 1, window.last)});
  rotate_columns(e_, m_ - 1, k, r, rows);
  for (int s = m_ - 1; s >= 0; --s) {
    const Rotation left = Rotation::zero_second(e(s, k - 1, k - 1), e(s, k, k - 1));
    rotate_rows(e_, s, k, left, columns);
    rotate_rows(a_, s, k, left, columns);
    e(s, k, k - 1) = 0.0;
    if (s == 0) return;
    const Rotation right = Rotation::zero_first(a(s, k, k - 1), a(s, k, k));
    rotate_columns(a_, s, k, right, rows);
    rotate_columns(e_, s - 1, k, right, rows);
    a(s, k, k - 1) = 0.0;
  }
}

/// One implicit single-shift step on the window's rows and columns of the Hessenberg factor: the first rotation makes a
/// bulge, which is chased down the diagonal. Where no shift is of use, one without.
void PeriodicQz::single_step(const Range& window, int iteration) {
  const auto [low, high] = window;
  const TriangularBlock trailing = triangular_block(high);
  const TriangularBlock leading = low + 1 < high ? triangular_block(low + 1) : trailing;
  // Where steps without a shift do not help, others may.
  const bool may_be_unshifted = iteration % 4 != 0 && !is_exceptional(iteration);
  if (may_be_unshifted && (graded(leading, low + 1) || graded(trailing, high))) return unshifted_step(window);
  chase_backwards(low + 1, window, first_rotation(leading, low, shift(trailing, high, iteration)));
  for (int k = low + 2; k <= high; ++k) {
    const Rotation r = Rotation::zero_second(a(0, k - 1, k - 2), a(0, k, k - 2));
    rotate_rows(a_, 0, k, r, {k - 2, high});
    rotate_rows(e_, 0, k, r, {k - 1, high});
    a(0, k, k - 2) = 0.0;
    chase(k, window, std::min(k + 1, high));
  }
}

/// A step without a shift: A_1 = Q R, and Q goes round the cycle to its other side. Where many factors make the
/// eigenvalues differ by orders of magnitude, it separates these at once; the rotation that a shifted step begins with,
/// read off a product in which the large ones hide all else, would say nothing. Row rotations of A_1 are one ahead: a
/// row is to be triangular before the columns that reach into it are combined.
void PeriodicQz::unshifted_step(const Range& window) {
  const int low = window.first;
  const int high = window.last;
  const auto triangularise_row = [&](int k) {
    const Rotation r = Rotation::zero_second(a(0, k - 1, k - 1), a(0, k, k - 1));
    rotate_rows(a_, 0, k, r, {k - 1, high});
    a(0, k, k - 1) = 0.0;
    return r;
  };
  Rotation next = triangularise_row(low + 1);
  for (int k = low + 1; k <= high; ++k) {
    const Rotation r = next;
    if (k < high) next = triangularise_row(k + 1);
    rotate_rows(e_, 0, k, r, {k - 1, high});
    chase(k, window, k);
  }
}

/// Eigenvalue k of the triangular product.
void PeriodicQz::deflate(int k) {
  ScaledComplex value{1.0, 0};
  for (int s = 0; s < m_; ++s) {
    value.mantissa = times(value.mantissa, a(s, k, k));
    rescale(value);
    value.mantissa = times(value.mantissa, inverse(e(s, k, k)));
    rescale(value);
    value.exponent += scale_[2 * static_cast<std::size_t>(s)] - scale_[2 * static_cast<std::size_t>(s) + 1];
  }
  eigenvalues_[static_cast<std::size_t>(k)] = value;
}

bool PeriodicQz::iterate() {
  int high = n_ - 1;
  int iteration = 0;
  while (high >= 0) {
    int low = high;
    while (low > 0) {
      const double neighbours = size1(a(0, low, low)) + size1(a(0, low - 1, low - 1));
      const double scale = neighbours > 0.0 ? neighbours : 1.0;
      if (size1(a(0, low, low - 1)) <= epsilon * scale) {
        a(0, low, low - 1) = 0.0;
        break;
      }
      --low;
    }
    if (low == high) {
      deflate(high);
      --high;
      iteration = 0;
      continue;
    }
    if (++iteration > 60) return false;
    single_step({low, high}, iteration);
    regularise();
  }
  return true;
}

void conjugate_pairs(std::vector<std::complex<double>>& values) {
  boost::container::small_vector<bool, 32> done(values.size(), false);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (done[i]) continue;
    std::size_t partner = i;
    double nearest = std::abs(values[i] - std::conj(values[i]));
    for (std::size_t j = i + 1; j < values.size(); ++j) {
      const double distance = std::abs(values[i] - std::conj(values[j]));
      if (!done[j] && distance < nearest) nearest = distance, partner = j;
    }
    done[i] = done[partner] = true;
    const std::complex<double> mean = 0.5 * (values[i] + std::conj(values[partner]));
    if (partner == i) {
      values[i] = mean.real();
    } else {
      values[i] = {mean.real(), std::abs(mean.imag())};
      values[partner] = std::conj(values[i]);
    }
  }
}

ScaledReal& ScaledReal::operator*=(double factor) {
  constexpr double largest = 0x1p100;
  const double product = mantissa_ * factor;
  if (std::abs(product) < largest && std::abs(product) * largest > 1.0) {  // nothing was lost
    mantissa_ = product;
    return *this;
  }
  int shift = 0;
  int factor_shift = 0;
  mantissa_ = std::frexp(mantissa_, &shift) * std::frexp(factor, &factor_shift);
  exponent_ += shift + factor_shift;
  return *this;
}

ScaledReal& ScaledReal::operator*=(const ScaledReal& other) {
  exponent_ += other.exponent_;
  return *this *= other.mantissa_;
}

ScaledReal& ScaledReal::operator/=(const ScaledReal& other) {
  exponent_ -= other.exponent_;
  return *this *= 1.0 / other.mantissa_;
}

double ScaledReal::value(double cap) const {
  constexpr long beyond = 4000;  // of any double
  const double size = std::ldexp(std::abs(mantissa_), static_cast<int>(std::clamp(exponent_, -beyond, beyond)));
  return std::copysign(std::min(size, cap), mantissa_);
}

namespace {

/// What the upper triangle of the first columns and the reflections that it took contribute.
void multiply_by_diagonal(ScaledReal& product, int reflections, const Eigen::MatrixXd& triangle, Eigen::Index columns) {
  product *= static_cast<double>(reflections);
  for (const double entry : triangle.diagonal().head(columns)) product *= entry;
}

}  // namespace

ScaledReal determinant_in_place(Eigen::MatrixXd& matrix) {
  ScaledReal result;
  const int reflections = triangularise(matrix, matrix.cols());
  multiply_by_diagonal(result, reflections, matrix, matrix.cols());
  return result;
}

/// With W^T [e; -A_s] = [R; 0], W orthogonal, the lower rows of W^T are free of c_{s-1}: what is left of e c_{s-1} =
/// a c_0 and E_s c_s = A_s c_{s-1} there is a relation of c_s and c_0 like the first one.
void CyclicDeterminant::eliminate(const std::vector<Eigen::MatrixXd>& e, const std::vector<Eigen::MatrixXd>& a) {
  eliminated_ = {};
  e_ = e.front();
  a_ = a.front();
  const Eigen::Index n = e_.rows();
  if (n == 0 || e.size() == 1) return;
  both_.resize(2 * n, 3 * n);  // of c_{s-1}, c_0, c_s
  for (std::size_t s = 1; s < e.size(); ++s) {
    both_.topRows(n) << e_, a_, Eigen::MatrixXd::Zero(n, n);
    both_.bottomRows(n) << -a[s], Eigen::MatrixXd::Zero(n, n), e[s];
    const int reflections = triangularise(both_, n);
    multiply_by_diagonal(eliminated_, reflections, both_, n);
    a_ = both_.block(n, n, n, n);
    e_ = both_.bottomRightCorner(n, n);
  }
}

ScaledReal CyclicDeterminant::at(double t) {
  difference_ = e_ - t * a_;
  ScaledReal result = determinant_in_place(difference_);
  result *= eliminated_;
  return result;
}

}  // namespace tchat
