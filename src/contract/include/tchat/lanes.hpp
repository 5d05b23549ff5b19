/// Four numbers side by side in vector registers: the same formula at four points, for a problem's functions at many
/// points in one call. Included by tchat/problem.hpp; a problem's code need not know of it.
///
/// Operations are those on doubles, in each lane, so that in one library values do not depend on the lanes to the last
/// bit. A comparison has one answer for all lanes, and so has plain(), the one number that they have. Where they
/// disagree it is the first lane's, and `parted()` tells afterwards that the others are of no use: whoever evaluates
/// puts one point into all four then, which always agree. Code that decides by anything else (errno) must ask for
/// plain() first.
#pragma once

#include <math.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

/// For operations of one or two instructions, of which g++ makes calls where a formula has many of them.
#define TCHAT_INLINE __attribute__((always_inline)) inline

namespace tchat {

/// Have lanes disagreed in a comparison of this thread since it was set to false?
inline bool& parted() {
  static thread_local bool disagreed = false;
  return disagreed;
}

class Lanes {  // NOLINT(cppcoreguidelines-special-member-functions): nothing but numbers
 public:
  static constexpr int count = 4;

  constexpr Lanes() : parts_{} {}
  // Copied register by register: g++ copies large arrays of what is trivial to copy by a call.
  TCHAT_INLINE Lanes(const Lanes& other) {
    for (int p = 0; p < part_count; ++p) parts_[p] = other.parts_[p];
  }
  TCHAT_INLINE Lanes& operator=(const Lanes& other) {  // NOLINT(bugprone-unhandled-self-assignment)
    for (int p = 0; p < part_count; ++p) parts_[p] = other.parts_[p];
    return *this;
  }
  // NOLINTBEGIN(google-explicit-constructor): constants convert without being asked, as with Dual
  template <class S, class = std::enable_if_t<std::is_arithmetic_v<S>>>
  Lanes(S constant) {
    for (Part& part : parts_) part = static_cast<double>(constant) - Part{};  // spreads it; less 0.0 keeps even -0.0
  }
  // NOLINTEND(google-explicit-constructor)

  Lanes(double a, double b, double c, double d) {
    const double values[count] = {a, b, c, d};
    __builtin_memcpy(parts_, values, sizeof(parts_));
  }

  /// `count` neighbours.
  static Lanes from(const double* values) {
    Lanes result;
    __builtin_memcpy(result.parts_, values, sizeof(parts_));
    return result;
  }
  void to(double* values) const { __builtin_memcpy(values, parts_, sizeof(parts_)); }

  /// The first `held`, with this distance from one to the next.
  __attribute__((noinline)) void scatter(double* values, std::ptrdiff_t step, int held) const {
    for (int l = 0; l < held; ++l) values[l * step] = lane(l);
  }

  double lane(int l) const { return parts_[l / part_lanes][l % part_lanes]; }

  Lanes operator-() const {
    Lanes result = *this;
    for (int p = 0; p < part_count; ++p) result.parts_[p] = -parts_[p];
    return result;
  }
  Lanes operator+() const { return *this; }

#define TCHAT_LANE_OPERATOR(OP)                                                             \
  TCHAT_INLINE friend Lanes operator OP(const Lanes& a, const Lanes& b) {                   \
    Lanes result = a;                                                                       \
    for (int p = 0; p < part_count; ++p) result.parts_[p] = a.parts_[p] OP b.parts_[p];     \
    return result;                                                                          \
  }                                                                                         \
  TCHAT_INLINE friend Lanes operator OP(const Lanes& a, double b) { return a OP Lanes(b); } \
  TCHAT_INLINE friend Lanes operator OP(double a, const Lanes& b) { return Lanes(a) OP b; } \
  Lanes& operator OP##=(const Lanes& b) { return *this = *this OP b; }
  TCHAT_LANE_OPERATOR(+)
  TCHAT_LANE_OPERATOR(-)
  TCHAT_LANE_OPERATOR(*)
  TCHAT_LANE_OPERATOR(/)
#undef TCHAT_LANE_OPERATOR

#define TCHAT_LANE_COMPARISON(OP)                                             \
  friend bool operator OP(const Lanes& a, const Lanes& b) {                   \
    const bool first = a.lane(0) OP b.lane(0);                                \
    for (int l = 1; l < count; ++l)                                           \
      if ((a.lane(l) OP b.lane(l)) != first) parted() = true;                 \
    return first;                                                             \
  }                                                                           \
  friend bool operator OP(const Lanes& a, double b) { return a OP Lanes(b); } \
  friend bool operator OP(double a, const Lanes& b) { return Lanes(a) OP b; }
  TCHAT_LANE_COMPARISON(<)
  TCHAT_LANE_COMPARISON(>)
  TCHAT_LANE_COMPARISON(<=)
  TCHAT_LANE_COMPARISON(>=)
  TCHAT_LANE_COMPARISON(==)
  TCHAT_LANE_COMPARISON(!=)
#undef TCHAT_LANE_COMPARISON

 private:
#ifdef __AVX2__
  static constexpr int part_lanes = 4;
#else
  static constexpr int part_lanes = 2;
#endif
  static constexpr int part_count = count / part_lanes;
  typedef double Part __attribute__((vector_size(sizeof(double) * part_lanes)));

  Part parts_[part_count];
};

/// Have all lanes the same number, to the last bit?
inline bool is_one_number(const Lanes& a) {
  const auto bits = [&](int l) { return std::bit_cast<std::uint64_t>(a.lane(l)); };
  return ((bits(1) ^ bits(0)) | (bits(2) ^ bits(0)) | (bits(3) ^ bits(0))) == 0;
}

/// That number. Four that differ have none, and the first lane's stands for them.
inline double plain(const Lanes& a) {
  if (!is_one_number(a)) parted() = true;
  return a.lane(0);
}

inline bool isfinite(const Lanes& a) {
  return a - a == 0.0;  // NOLINT(misc-redundant-expression)
}

/// phi(a) in each lane; once where it is the same in all, as for a single point.
template <class Function>
Lanes in_lanes(const Function& phi, const Lanes& a) {
  const double first = phi(a.lane(0));
  if (is_one_number(a)) return Lanes(first);
  return Lanes(first, phi(a.lane(1)), phi(a.lane(2)), phi(a.lane(3)));
}
template <class Function>
Lanes in_lanes(const Function& phi, const Lanes& a, const Lanes& b) {
  return Lanes(phi(a.lane(0), b.lane(0)), phi(a.lane(1), b.lane(1)), phi(a.lane(2), b.lane(2)),
               phi(a.lane(3), b.lane(3)));
}

#define TCHAT_LANE_FUNCTION(NAME)                              \
  inline Lanes NAME(const Lanes& a) {                          \
    return in_lanes([](double x) { return std::NAME(x); }, a); \
  }
TCHAT_LANE_FUNCTION(sin)
TCHAT_LANE_FUNCTION(cos)
TCHAT_LANE_FUNCTION(tan)
TCHAT_LANE_FUNCTION(asin)
TCHAT_LANE_FUNCTION(acos)
TCHAT_LANE_FUNCTION(atan)
TCHAT_LANE_FUNCTION(sinh)
TCHAT_LANE_FUNCTION(cosh)
TCHAT_LANE_FUNCTION(tanh)
TCHAT_LANE_FUNCTION(asinh)
TCHAT_LANE_FUNCTION(acosh)
TCHAT_LANE_FUNCTION(atanh)
TCHAT_LANE_FUNCTION(exp)
TCHAT_LANE_FUNCTION(exp2)
TCHAT_LANE_FUNCTION(expm1)
TCHAT_LANE_FUNCTION(log)
TCHAT_LANE_FUNCTION(log2)
TCHAT_LANE_FUNCTION(log10)
TCHAT_LANE_FUNCTION(log1p)
TCHAT_LANE_FUNCTION(sqrt)
TCHAT_LANE_FUNCTION(cbrt)
TCHAT_LANE_FUNCTION(erf)
TCHAT_LANE_FUNCTION(erfc)
TCHAT_LANE_FUNCTION(tgamma)
TCHAT_LANE_FUNCTION(lgamma)
TCHAT_LANE_FUNCTION(floor)
TCHAT_LANE_FUNCTION(ceil)
TCHAT_LANE_FUNCTION(trunc)
TCHAT_LANE_FUNCTION(round)
#undef TCHAT_LANE_FUNCTION

#define TCHAT_LANE_FUNCTION_OF_TWO(NAME)                                       \
  inline Lanes NAME(const Lanes& a, const Lanes& b) {                          \
    return in_lanes([](double x, double y) { return std::NAME(x, y); }, a, b); \
  }
TCHAT_LANE_FUNCTION_OF_TWO(pow)
TCHAT_LANE_FUNCTION_OF_TWO(atan2)
TCHAT_LANE_FUNCTION_OF_TWO(fmod)
TCHAT_LANE_FUNCTION_OF_TWO(hypot)
TCHAT_LANE_FUNCTION_OF_TWO(fmin)
TCHAT_LANE_FUNCTION_OF_TWO(fmax)
#undef TCHAT_LANE_FUNCTION_OF_TWO

inline Lanes fabs(const Lanes& a) {
  return in_lanes([](double x) { return std::fabs(x); }, a);
}
inline Lanes abs(const Lanes& a) { return fabs(a); }

/// What derivatives at many points are computed with: lanes where four numbers have a register.
#ifdef __AVX2__
using PointNumbers = Lanes;
#else
using PointNumbers = double;
#endif

}  // namespace tchat
