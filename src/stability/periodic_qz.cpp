#include "stability/periodic_qz.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tchat {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
using Scalar = PeriodicQz::Scalar;

double size1(const Scalar& z) { return std::abs(z.real()) + std::abs(z.imag()); }

void rescale(ScaledComplex& z) {
  const double size = size1(z.mantissa);
  if (size == 0.0 || !std::isfinite(size)) return;
  int exponent = 0;
  std::frexp(size, &exponent);
  z.mantissa = {std::ldexp(z.mantissa.real(), -exponent), std::ldexp(z.mantissa.imag(), -exponent)};
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

/// An upper triangular or full 2 x 2 block times a power of two.
struct PeriodicQz::Block2 {
  std::array<Scalar, 4> x;  // row-major

  void rescale_entries() {
    double size = 0.0;
    for (const Scalar& z : x) size = std::max(size, size1(z));
    if (size == 0.0 || !std::isfinite(size)) return;
    for (Scalar& z : x) z /= size;
  }
};

/// The unitary [c s; -conj(s) c] with c real.
struct PeriodicQz::Rotation {
  double c = 1.0;
  Scalar s = 0.0;

  /// Maps (f, g) to (r, 0).
  static Rotation zero_second(const Scalar& f, const Scalar& g) {
    const double af = std::abs(f);
    const double ag = std::abs(g);
    if (ag == 0.0) return {};
    if (af == 0.0) return {0.0, std::conj(g) / ag};
    const double r = std::hypot(af, ag);
    return {af / r, (f / af) * std::conj(g) / r};
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
    for (auto z = begin; z != begin + static_cast<std::ptrdiff_t>(block); ++z)
      *z = {std::ldexp(z->real(), -exponent), std::ldexp(z->imag(), -exponent)};
    return static_cast<long>(exponent);
  };
  for (int s = 0; s < m_; ++s) {
    scale_[2 * static_cast<std::size_t>(s)] = take_out(a_, s);
    scale_[2 * static_cast<std::size_t>(s) + 1] = take_out(e_, s);
  }
}

/// Rows k-1, k of factor s from the left.
void PeriodicQz::rotate_rows(std::vector<Scalar>& matrix, int s, int k, const Rotation& r) {
  for (int c = 0; c < n_; ++c) {
    Scalar& x = matrix[at(s, k - 1, c)];
    Scalar& y = matrix[at(s, k, c)];
    const Scalar old = x;
    x = r.c * old + r.s * y;
    y = r.c * y - std::conj(r.s) * old;
  }
}

/// Columns k-1, k of factor s from the right, by the conjugate transpose of what rotate_rows applies.
void PeriodicQz::rotate_columns(std::vector<Scalar>& matrix, int s, int k, const Rotation& r) {
  for (int i = 0; i < n_; ++i) {
    Scalar& x = matrix[at(s, i, k - 1)];
    Scalar& y = matrix[at(s, i, k)];
    const Scalar old = x;
    x = r.c * old + std::conj(r.s) * y;
    y = r.c * y - r.s * old;
  }
}

/// E_m, A_m, E_(m-1), ..., E_1 one after the other to upper triangular form; A_1 stays full.
void PeriodicQz::triangularise() {
  for (int s = m_ - 1; s >= 0; --s) {
    // Rows of the pair (A_s, E_s): E_s triangular, from the left.
    for (int c = 0; c < n_ - 1; ++c)
      for (int k = n_ - 1; k > c; --k) {
        const Rotation r = Rotation::zero_second(e(s, k - 1, c), e(s, k, c));
        rotate_rows(e_, s, k, r);
        rotate_rows(a_, s, k, r);
        e(s, k, c) = 0.0;
      }
    if (s == 0) break;
    // Columns of A_s and of E_(s-1): A_s triangular, from the right.
    for (int row = n_ - 1; row > 0; --row)
      for (int k = 1; k <= row; ++k) {
        // Zero (row, k-1) against (row, k): the pair taken in reverse order, conjugated.
        const Rotation z = Rotation::zero_second(std::conj(a(s, row, k)), std::conj(a(s, row, k - 1)));
        const Rotation r{z.c, -std::conj(z.s)};
        rotate_columns(a_, s, k, r);
        rotate_columns(e_, s - 1, k, r);
        a(s, row, k - 1) = 0.0;
      }
  }
}

/// A rotation of rows k-1, k of the pair (A_1, E_1) has filled E_1(k, k-1): carry it round the cycle, restoring every
/// triangular factor, until it acts on columns k-1, k of A_1.
void PeriodicQz::chase(int k) {
  for (int s = 0; s < m_; ++s) {
    const Rotation z = Rotation::zero_second(std::conj(e(s, k, k)), std::conj(e(s, k, k - 1)));
    const Rotation columns{z.c, -std::conj(z.s)};
    rotate_columns(e_, s, k, columns);
    e(s, k, k - 1) = 0.0;
    const int next = (s + 1) % m_;
    rotate_columns(a_, next, k, columns);
    if (next == 0) return;
    const Rotation rows = Rotation::zero_second(a(next, k - 1, k - 1), a(next, k, k - 1));
    rotate_rows(a_, next, k, rows);
    rotate_rows(e_, next, k, rows);
    a(next, k, k - 1) = 0.0;
  }
}

void PeriodicQz::hessenberg() {
  for (int c = 0; c < n_ - 2; ++c)
    for (int k = n_ - 1; k > c + 1; --k) {
      const Rotation r = Rotation::zero_second(a(0, k - 1, c), a(0, k, c));
      rotate_rows(a_, 0, k, r);
      rotate_rows(e_, 0, k, r);
      a(0, k, c) = 0.0;
      chase(k);
    }
}

/// Diagonal entries of triangular factors that are zero to rounding become rounding-level numbers.
void PeriodicQz::regularise() {
  static constexpr double floor = epsilon / 8;
  const auto lift = [](Scalar& z) {
    const double size = std::abs(z);
    if (size < floor) z = size > 0.0 ? z / size * floor : Scalar(floor);
  };
  for (int k = 0; k < n_; ++k)
    for (int s = 0; s < m_; ++s) {
      lift(e(s, k, k));
      if (s > 0) lift(a(s, k, k));
    }
}

/// The 2 x 2 diagonal block of T = E_m^-1 A_m ... E_1^-1 at rows k-1, k, up to a scalar factor.
PeriodicQz::Block2 PeriodicQz::triangular_block(int k) const {
  Block2 t{{1.0, 0.0, 0.0, 1.0}};
  const auto multiply_left = [&](const Scalar& p, const Scalar& q, const Scalar& r) {  // [p q; 0 r] t
    t.x = {p * t.x[0] + q * t.x[2], p * t.x[1] + q * t.x[3], r * t.x[2], r * t.x[3]};
    t.rescale_entries();
  };
  for (int s = 0; s < m_; ++s) {
    if (s > 0) multiply_left(a(s, k - 1, k - 1), a(s, k - 1, k), a(s, k, k));
    multiply_left(e(s, k, k), -e(s, k - 1, k), e(s, k - 1, k - 1));  // adjugate: the inverse up to a factor
  }
  return t;
}

/// The block times that of the Hessenberg factor A_1 at rows and columns k-1, k.
PeriodicQz::Block2 PeriodicQz::times_hessenberg(const Block2& t, int k) const {
  Block2 h;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      h.x[2 * i + j] =
          t.x[2 * i] * a(0, k - 1, k - 1 + static_cast<int>(j)) + t.x[2 * i + 1] * a(0, k, k - 1 + static_cast<int>(j));
  return h;
}

/// The diagonal entry k of T, with its scale.
ScaledComplex PeriodicQz::triangular_entry(int k) const {
  ScaledComplex product{1.0, 0};
  const auto multiply = [&product](const Scalar& factor) {
    product.mantissa *= factor;
    rescale(product);
  };
  for (int s = 0; s < m_; ++s) {
    if (s > 0) multiply(a(s, k, k));
    multiply(1.0 / e(s, k, k));
  }
  return product;
}

/// The eigenvalue of the trailing block nearest to its last entry; now and then an exceptional one. The blocks are
/// known up to factors only, so it is carried as a ratio to the block's last entry, whose scale is known.
ScaledComplex PeriodicQz::shift(int high, int iteration) const {
  const Block2 t = triangular_block(high);
  const Block2 trailing = times_hessenberg(t, high);
  const Scalar half_difference = 0.5 * (trailing.x[0] - trailing.x[3]);
  const Scalar off = trailing.x[1] * trailing.x[2];
  const Scalar root = std::sqrt(half_difference * half_difference + off);
  const Scalar larger =
      size1(half_difference + root) > size1(half_difference - root) ? half_difference + root : half_difference - root;
  Scalar nearest = larger == 0.0 ? trailing.x[3] : trailing.x[3] - off / larger;
  if (iteration % 10 == 9) nearest = size1(trailing.x[2]) + size1(trailing.x[3]);  // exceptional
  const ScaledComplex scale = triangular_entry(high);
  ScaledComplex result{t.x[3] == 0.0 ? Scalar(0.0) : nearest / t.x[3], 0};
  result.mantissa *= scale.mantissa;
  result.exponent += scale.exponent;
  rescale(result);
  return result;
}

/// Takes the first column of T A_1 - shift, of which two entries are not zero, to a multiple of the first unit vector.
PeriodicQz::Rotation PeriodicQz::first_rotation(int low, const ScaledComplex& shift) const {
  const ScaledComplex scale = triangular_entry(low);
  const Block2 t = triangular_block(low + 1);
  const Block2 leading = times_hessenberg(t, low + 1);
  const Scalar unit = t.x[0] == 0.0 ? Scalar(1.0) : scale.mantissa / t.x[0];
  ScaledComplex first{leading.x[0] * unit, scale.exponent};
  ScaledComplex second{leading.x[2] * unit, scale.exponent};
  rescale(first);
  rescale(second);
  const long reference = std::max({first.exponent, second.exponent, shift.exponent});
  const auto aligned = [&](const ScaledComplex& z) {
    const long difference = std::max(z.exponent - reference, -2000L);
    return Scalar{std::ldexp(z.mantissa.real(), static_cast<int>(difference)),
                  std::ldexp(z.mantissa.imag(), static_cast<int>(difference))};
  };
  return Rotation::zero_second(aligned(first) - aligned(shift), aligned(second));
}

/// A rotation of the space of x_1 acts on columns k-1, k of A_1 and of E_m; it is carried backwards through the cycle
/// by restoring E_m from the left, then A_m from the right, ... until E_1 has been restored from the left.
void PeriodicQz::chase_backwards(int k, const Rotation& r) {
  rotate_columns(a_, 0, k, r);
  rotate_columns(e_, m_ - 1, k, r);
  for (int s = m_ - 1; s >= 0; --s) {
    const Rotation rows = Rotation::zero_second(e(s, k - 1, k - 1), e(s, k, k - 1));
    rotate_rows(e_, s, k, rows);
    rotate_rows(a_, s, k, rows);
    e(s, k, k - 1) = 0.0;
    if (s == 0) return;
    const Rotation z = Rotation::zero_second(std::conj(a(s, k, k)), std::conj(a(s, k, k - 1)));
    const Rotation columns{z.c, -std::conj(z.s)};
    rotate_columns(a_, s, k, columns);
    rotate_columns(e_, s - 1, k, columns);
    a(s, k, k - 1) = 0.0;
  }
}

/// One implicit single-shift step on rows and columns low..high of the Hessenberg factor: the first rotation makes a
/// bulge, which is chased down the diagonal.
void PeriodicQz::single_step(int low, int high, int iteration) {
  chase_backwards(low + 1, first_rotation(low, shift(high, iteration)));
  for (int k = low + 2; k <= high; ++k) {
    const Rotation r = Rotation::zero_second(a(0, k - 1, k - 2), a(0, k, k - 2));
    rotate_rows(a_, 0, k, r);
    rotate_rows(e_, 0, k, r);
    a(0, k, k - 2) = 0.0;
    chase(k);
  }
}

/// Eigenvalue k of the triangular product.
void PeriodicQz::deflate(int k) {
  ScaledComplex value{1.0, 0};
  for (int s = 0; s < m_; ++s) {
    value.mantissa *= a(s, k, k);
    rescale(value);
    value.mantissa /= e(s, k, k);
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
    single_step(low, high, iteration);
    regularise();
  }
  return true;
}

void conjugate_pairs(std::vector<std::complex<double>>& values) {
  std::vector<bool> done(values.size(), false);
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
      values[i] = mean;
      values[partner] = std::conj(mean);
    }
  }
}

}  // namespace tchat
