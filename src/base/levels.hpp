/// Levels below which a ratio counts as zero. They are the only thresholds of src, except for those that
/// tests/structure/thresholds.txt lists.
///
/// A level is a number without a unit. It is compared with a quantity divided by the size of its terms, never with a
/// state, a time, a parameter or the value of a function itself. Sizes are those of model/scales.hpp and
/// EventAt::scale(). Where a divisor may be zero, std::numeric_limits<double>::min() is its lower bound.
#pragma once

namespace tchat::level {

/// Rounding of a few operations, relative to the largest of their terms: some 50 units of the last digit.
inline constexpr double rounding = 1e-14;
/// Rounding of a sum over a mesh, or of the solution of a system of linear equations, relative to its terms.
inline constexpr double rounding_of_sums = 1e-13;
/// A part of a whole, such as an entry of a vector or a time within a segment, that rounding along an orbit produces.
inline constexpr double negligible = 1e-12;
/// The last correction of an iteration that converges quadratically, relative to the unknowns: the next one would be
/// rounding. Entries of a unit tangent are known to this.
inline constexpr double converged = 1e-10;
/// Error of a corrected orbit: Newton's method ends with 1e-12 to 1e-10, the discretisation adds its own. Whatever is
/// computed from the orbit is zero up to this share of its terms.
inline constexpr double orbit = 1e-9;
/// Noise of a difference quotient, relative to the derivative: about the root of rounding in double precision.
inline constexpr double differences = 1e-8;
/// A zero of multiplicity two (a double eigenvalue, an extremum), relative to its terms: the root of `rounding`.
inline constexpr double double_zero = 1e-7;
/// Default tolerance of Newton's method and of the location of points: EPSL, EPSU, EPSS.
inline constexpr double tolerance = 1e-7;
/// An iteration whose corrections no longer shrink is accepted if they are below this: they are noise of its equations.
inline constexpr double stalled = 1e-6;
/// What the location of a point leaves of a quantity that vanishes there, relative to its size: ten times `tolerance`.
inline constexpr double located = 1e-6;
/// Two computations of one thing (an orbit, a place on a branch) differ by less: ten times what a location leaves.
inline constexpr double same = 1e-5;
/// Distance of a multiplier's modulus from 1 up to which it counts as on the unit circle, as in the column PT.
inline constexpr double on_circle = 1e-5;
/// Error of numbers that were typed or printed with five digits.
inline constexpr double five_digits = 1e-4;
/// A ratio above this is not zero: neither differences nor the error of a located point reach it.
inline constexpr double visible = 1e-4;

/// Tolerances of one step of an integrator; a segment's error is about ten times `relative`. `absolute` is for states
/// of size 1, see size_for_tolerance().
struct Tolerances {
  double relative, absolute;
};
/// As far as double precision goes: multipliers near grazing need this much.
inline constexpr Tolerances finest_flow{1e-15, 1e-16};
/// For flows that other results are compared with or derived from.
inline constexpr Tolerances reference_flow{1e-13, 1e-14};
/// Where large derivatives leave fewer digits.
inline constexpr Tolerances relaxed_flow{1e-12, 1e-13};
/// For implicit methods, on stiff problems.
inline constexpr Tolerances stiff_flow{1e-11, 1e-13};

}  // namespace tchat::level
