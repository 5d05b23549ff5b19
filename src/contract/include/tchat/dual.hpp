/// Forward-mode automatic differentiation: Dual<N, Base> is a value with N first derivatives, exact to rounding.
///
/// Base is double, or another Dual for second derivatives: in Dual<N, Dual<1>> the inner dual carries one direction and
/// the outer ones the gradient of everything, so that the value's inner part is a directional derivative and the inner
/// parts of the outer derivatives are that directional derivative's gradient.
///
/// Nothing here allocates. Comparisons look at values only, so that `if (x > 0)` works in a problem's code; at a point
/// where a function is not differentiable (fabs at 0, the seam of min and max) the derivative is one of the one-sided
/// ones.
#pragma once

#include <math.h>    // unqualified sin(double) and, with
#include <stdlib.h>  // this one, abs(double): without it abs(0.5) is the integer one, 0

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "tchat/lanes.hpp"

namespace tchat {

template <int N, class Base = double>
struct Dual {  // NOLINT(cppcoreguidelines-special-member-functions): nothing but numbers
  Base value{};
  std::array<Base, N> derivative{};

  Dual() = default;
  // Number by number: g++ copies arrays of this size by a call, which takes longer than a multiplication.
  Dual(const Dual& other) : Dual(other, Numbers{}) {}
  Dual& operator=(const Dual& other) { return assign(other, Numbers{}); }

  // Constants convert without being asked, so that formulas read as with doubles.
  // NOLINTBEGIN(google-explicit-constructor)
  template <class S, class = std::enable_if_t<std::is_arithmetic_v<S>>>
  Dual(S constant) : value(static_cast<double>(constant)) {}
  template <class B = Base, class = std::enable_if_t<!std::is_arithmetic_v<B>>>
  Dual(const Base& constant) : value(constant) {}
  // NOLINTEND(google-explicit-constructor)

  Dual& operator+=(const Dual& b) {
    value += b.value;
    for (int k = 0; k < N; ++k) derivative[k] += b.derivative[k];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    for (int k = 0; k < N; ++k) derivative[k] -= b.derivative[k];
    return *this;
  }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  Dual operator-() const { return chain(*this, -value, Base(-1.0)); }
  Dual operator+() const { return *this; }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual c;
    c.value = a.value * b.value;
    for (int k = 0; k < N; ++k) c.derivative[k] = a.derivative[k] * b.value + a.value * b.derivative[k];
    return c;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual c;
    const Base inverse = Base(1.0) / b.value;
    c.value = a.value / b.value;
    for (int k = 0; k < N; ++k) c.derivative[k] = (a.derivative[k] - c.value * b.derivative[k]) * inverse;
    return c;
  }

  /// Mixed arithmetic with plain numbers, cheaper than with a constant Dual.
  friend Dual operator+(Dual a, double b) { return a.value += b, a; }
  friend Dual operator+(double a, Dual b) { return b.value += a, b; }
  friend Dual operator-(Dual a, double b) { return a.value -= b, a; }
  friend Dual operator-(double a, const Dual& b) { return -b + a; }
  friend Dual operator*(const Dual& a, double b) { return chain(a, a.value * b, Base(b)); }
  friend Dual operator*(double a, const Dual& b) { return chain(b, b.value * a, Base(a)); }
  friend Dual operator/(const Dual& a, double b) {
    Dual c;
    c.value = a.value / b;
    for (int k = 0; k < N; ++k) c.derivative[k] = a.derivative[k] / b;
    return c;
  }
  friend Dual operator/(double a, const Dual& b) {
    const Base quotient = a / b.value;
    return chain(b, quotient, -quotient / b.value);
  }

  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend bool operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }
  friend bool operator<(const Dual& a, double b) { return a.value < b; }
  friend bool operator>(const Dual& a, double b) { return a.value > b; }
  friend bool operator<=(const Dual& a, double b) { return a.value <= b; }
  friend bool operator>=(const Dual& a, double b) { return a.value >= b; }
  friend bool operator==(const Dual& a, double b) { return a.value == b; }
  friend bool operator!=(const Dual& a, double b) { return a.value != b; }
  friend bool operator<(double a, const Dual& b) { return a < b.value; }
  friend bool operator>(double a, const Dual& b) { return a > b.value; }
  friend bool operator<=(double a, const Dual& b) { return a <= b.value; }
  friend bool operator>=(double a, const Dual& b) { return a >= b.value; }

  /// phi(a) by the chain rule, given phi(a.value) and phi'(a.value).
  static Dual chain(const Dual& a, const Base& value, const Base& slope) {
    Dual c;
    c.value = value;
    for (int k = 0; k < N; ++k) c.derivative[k] = slope * a.derivative[k];
    return c;
  }

 private:
  using Numbers = std::make_index_sequence<N <= 16 ? N : 0>;  // none: many are copied as a whole
  template <std::size_t... K>
  Dual(const Dual& other, std::index_sequence<K...>) : value(other.value), derivative{other.derivative[K]...} {}
  Dual(const Dual& other, std::index_sequence<>) : value(other.value), derivative(other.derivative) {}
  template <std::size_t... K>
  Dual& assign(const Dual& other, std::index_sequence<K...>) {
    value = other.value;
    if constexpr (sizeof...(K) == 0)
      derivative = other.derivative;
    else
      ((derivative[K] = other.derivative[K]), ...);
    return *this;
  }
};

/// The innermost plain number of a scalar of any nesting.
inline double plain(double a) { return a; }
template <int N, class B>
double plain(const Dual<N, B>& a) {
  return plain(a.value);
}

// The functions below are found by argument-dependent lookup: a problem writes `using std::sin; sin(x[0])`, or just
// `sin(x[0])` inside a template.
#define TCHAT_DUAL_FUNCTION(NAME, VALUE, SLOPE)                                                                    \
  template <int N, class B>                                                                                        \
  Dual<N, B> NAME(const Dual<N, B>& a) {                                                                           \
    using std::sin, std::cos, std::tan, std::exp, std::log, std::sqrt, std::sinh, std::cosh, std::tanh, std::asin, \
        std::acos, std::atan, std::expm1, std::log1p, std::cbrt, std::asinh, std::acosh, std::atanh, std::log10,   \
        std::log2, std::exp2;                                                                                      \
    const B& x = a.value;                                                                                          \
    const B y = VALUE;                                                                                             \
    const B slope = SLOPE;                                                                                         \
    return Dual<N, B>::chain(a, y, slope);                                                                         \
  }

TCHAT_DUAL_FUNCTION(sin, sin(x), cos(x))
TCHAT_DUAL_FUNCTION(cos, cos(x), -sin(x))
TCHAT_DUAL_FUNCTION(tan, tan(x), y* y + 1.0)
TCHAT_DUAL_FUNCTION(asin, asin(x), 1.0 / sqrt(1.0 - x * x))
TCHAT_DUAL_FUNCTION(acos, acos(x), -1.0 / sqrt(1.0 - x * x))
TCHAT_DUAL_FUNCTION(atan, atan(x), 1.0 / (x * x + 1.0))
TCHAT_DUAL_FUNCTION(sinh, sinh(x), cosh(x))
TCHAT_DUAL_FUNCTION(cosh, cosh(x), sinh(x))
TCHAT_DUAL_FUNCTION(tanh, tanh(x), 1.0 - y * y)
TCHAT_DUAL_FUNCTION(asinh, asinh(x), 1.0 / sqrt(x * x + 1.0))
TCHAT_DUAL_FUNCTION(acosh, acosh(x), 1.0 / sqrt(x * x - 1.0))
TCHAT_DUAL_FUNCTION(atanh, atanh(x), 1.0 / (1.0 - x * x))
TCHAT_DUAL_FUNCTION(exp, exp(x), y)
TCHAT_DUAL_FUNCTION(exp2, exp2(x), y * 0.69314718055994530942)
TCHAT_DUAL_FUNCTION(expm1, expm1(x), y + 1.0)
TCHAT_DUAL_FUNCTION(log, log(x), 1.0 / x)
TCHAT_DUAL_FUNCTION(log2, log2(x), 1.4426950408889634074 / x)
TCHAT_DUAL_FUNCTION(log10, log10(x), 0.43429448190325182765 / x)
TCHAT_DUAL_FUNCTION(log1p, log1p(x), 1.0 / (x + 1.0))
TCHAT_DUAL_FUNCTION(sqrt, sqrt(x), 0.5 / y)
TCHAT_DUAL_FUNCTION(cbrt, cbrt(x), 1.0 / (3.0 * y * y))
#undef TCHAT_DUAL_FUNCTION

template <int N, class B>
Dual<N, B> fabs(const Dual<N, B>& a) {
  return a < 0.0 ? -a : a;
}
template <int N, class B>
Dual<N, B> abs(const Dual<N, B>& a) {
  return fabs(a);
}

/// a to a constant power. Negative bases are fine for integer exponents, as in std::pow; a zero base has zero
/// derivatives as far as the exponent allows.
template <int N, class B>
Dual<N, B> pow(const Dual<N, B>& a, double exponent) {
  using std::pow;
  if (exponent == 0.0) return Dual<N, B>(1.0);
  if (exponent == 1.0) return a;
  return Dual<N, B>::chain(a, pow(a.value, exponent), exponent * pow(a.value, exponent - 1.0));
}
template <int N, class B, class I, class = std::enable_if_t<std::is_integral_v<I>>>
Dual<N, B> pow(const Dual<N, B>& a, I exponent) {
  return pow(a, static_cast<double>(exponent));
}
template <int N, class B>
Dual<N, B> pow(double base, const Dual<N, B>& b) {
  using std::log, std::pow;
  const B y = pow(base, b.value);
  return Dual<N, B>::chain(b, y, base == 0.0 ? B(0.0) : y * log(base));
}
template <int N, class B>
Dual<N, B> pow(const Dual<N, B>& a, const Dual<N, B>& b) {
  using std::log, std::pow;
  Dual<N, B> c;
  c.value = pow(a.value, b.value);
  const bool constant = a == 0.0 && b == 0.0;  // 0 * 0^-1 below, where the derivative is 0
  const B by_base = constant ? B(0.0) : b.value * pow(a.value, b.value - 1.0);
  const bool has_log = a > 0.0;
  const B by_exponent = has_log ? c.value * log(a.value) : B(0.0);
  for (int k = 0; k < N; ++k) c.derivative[k] = by_base * a.derivative[k] + by_exponent * b.derivative[k];
  return c;
}

template <int N, class B>
Dual<N, B> atan2(const Dual<N, B>& y, const Dual<N, B>& x) {
  using std::atan2;
  Dual<N, B> c;
  const B inverse_square = 1.0 / (x.value * x.value + y.value * y.value);
  c.value = atan2(y.value, x.value);
  for (int k = 0; k < N; ++k)
    c.derivative[k] = (x.value * y.derivative[k] - y.value * x.derivative[k]) * inverse_square;
  return c;
}
template <int N, class B>
Dual<N, B> hypot(const Dual<N, B>& a, const Dual<N, B>& b) {
  return sqrt(a * a + b * b);
}
template <int N, class B>
Dual<N, B> min(const Dual<N, B>& a, const Dual<N, B>& b) {
  return b < a ? b : a;
}
template <int N, class B>
Dual<N, B> max(const Dual<N, B>& a, const Dual<N, B>& b) {
  return a < b ? b : a;
}
template <int N, class B>
Dual<N, B> fmin(const Dual<N, B>& a, const Dual<N, B>& b) {
  return min(a, b);
}
template <int N, class B>
Dual<N, B> fmax(const Dual<N, B>& a, const Dual<N, B>& b) {
  return max(a, b);
}
/// Whole numbers, which count as constants. In a namespace of their own: a problem's own functions of these names are
/// not to be taken for these.
namespace whole_numbers {
inline double floor(double a) { return std::floor(a); }
inline Lanes floor(const Lanes& a) { return tchat::floor(a); }
template <int M, class B>
Dual<M, B> floor(const Dual<M, B>& a) {
  return Dual<M, B>(whole_numbers::floor(a.value));
}
inline double trunc(double a) { return std::trunc(a); }
inline Lanes trunc(const Lanes& a) { return tchat::trunc(a); }
template <int M, class B>
Dual<M, B> trunc(const Dual<M, B>& a) {
  return Dual<M, B>(whole_numbers::trunc(a.value));
}
}  // namespace whole_numbers

/// a - m b, with the whole number m of std::fmod; m counts as a constant.
template <int N, class B>
Dual<N, B> fmod(const Dual<N, B>& a, const Dual<N, B>& b) {
  using std::fmod;
  const B m = whole_numbers::trunc(a.value / b.value);
  Dual<N, B> c = a - Dual<N, B>::chain(b, m * b.value, m);
  c.value = fmod(a.value, b.value);
  return c;
}
#define TCHAT_DUAL_MIXED(NAME)                     \
  template <int N, class B>                        \
  Dual<N, B> NAME(const Dual<N, B>& a, double b) { \
    return NAME(a, Dual<N, B>(b));                 \
  }                                                \
  template <int N, class B>                        \
  Dual<N, B> NAME(double a, const Dual<N, B>& b) { \
    return NAME(Dual<N, B>(a), b);                 \
  }
TCHAT_DUAL_MIXED(atan2)
TCHAT_DUAL_MIXED(hypot)
TCHAT_DUAL_MIXED(min)
TCHAT_DUAL_MIXED(max)
TCHAT_DUAL_MIXED(fmin)
TCHAT_DUAL_MIXED(fmax)
TCHAT_DUAL_MIXED(fmod)
#undef TCHAT_DUAL_MIXED

template <int N, class B>
bool isfinite(const Dual<N, B>& a) {
  using std::isfinite;
  return isfinite(a.value);
}

}  // namespace tchat
