/// Sliding along a surface of discontinuity (Filippov), for problem authors: included by tchat/problem.hpp.
///
/// Two fields meet on the surface h = 0 of an event function: f- where h < 0, f+ where h > 0. Where both point at the
/// surface, h_x f- > 0 > h_x f+, orbits stay on it and follow
///
///     f = f- + lambda (f+ - f-),      lambda = h_x f- / (h_x f- - h_x f+),      h_x f = 0,
///
/// until lambda = 0, where h_x f- = 0 and they leave with f-, or lambda = 1, where h_x f+ = 0 and they leave with f+. A
/// class that says so,
///
///     static constexpr tchat::Sliding sliding{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3,
///                                             .to_plus = 4};
///
/// has that field as its field 3, and h_x f- and -h_x f+ as its event functions 3 and 4: these have the zeros and signs
/// of lambda and 1 - lambda, and no pole. `fields` and `events` count them; field() is then called with the other
/// fields only, event() with the other events. Several modes: static constexpr tchat::Sliding sliding[] = {{...},
/// {...}};
///
/// h_x f is the derivative of event() in the direction f, by one more level of dual numbers, so that all derivatives
/// are exact as those of field() and event() are. Hand-written derivatives are those of the other functions.
///
/// The field keeps h constant: a segment ends at the h at which it starts, to the accuracy of integration, and a
/// segment that begins where one ended on the surface stays there. An orbit that slides all the time has nothing that
/// says h = 0: there a jump must (tchat refuses such a problem as singular).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <type_traits>

#include "tchat/dual.hpp"
#include "tchat/problem.h"

namespace tchat {

/// Thrown where a function has no value: the state then counts as one at which nothing can be evaluated. (The standard
/// exceptions with texts come with std::string, which takes as long to compile as all else here.)
class NoValue : public std::exception {
 public:
  explicit NoValue(const char* why) : why_(why) {}
  const char* what() const noexcept override { return why_; }

 private:
  const char* why_;
};

/// Which functions a sliding mode is made of and which it adds: `field` between the fields `minus` and `plus` on the
/// surface of event function `surface`; the event function `to_minus` ends it at lambda = 0, `to_plus` at lambda = 1.
using Sliding = ::tchat_sliding;

/// The sliding modes of a problem class, as an array.
template <class Problem>
constexpr auto sliding_modes_of() {
  if constexpr (requires { Problem::sliding; }) {
    if constexpr (std::is_array_v<std::remove_cvref_t<decltype(Problem::sliding)>>)
      return std::to_array(Problem::sliding);
    else
      return std::array<Sliding, 1>{Problem::sliding};
  } else {
    return std::array<Sliding, 0>{};
  }
}

/// What is wrong with the numbers of sliding modes.
enum class SlidingFault { none, field_range, event_range, same_fields, same_events, made_twice };

/// The first fault of a range of modes in a problem of so many fields and event functions.
template <class Modes>
constexpr SlidingFault sliding_fault(const Modes& modes, int fields, int events) {
  const auto outside = [](int number, int count) { return number < 1 || number > count; };
  for (const Sliding& mode : modes) {
    if (outside(mode.field, fields) || outside(mode.minus, fields) || outside(mode.plus, fields))
      return SlidingFault::field_range;
    if (outside(mode.surface, events) || outside(mode.to_minus, events) || outside(mode.to_plus, events))
      return SlidingFault::event_range;
    if (mode.field == mode.minus || mode.field == mode.plus || mode.minus == mode.plus)
      return SlidingFault::same_fields;
    if (mode.surface == mode.to_minus || mode.surface == mode.to_plus || mode.to_minus == mode.to_plus)
      return SlidingFault::same_events;
  }
  for (std::size_t a = 0; a < modes.size(); ++a)
    for (std::size_t b = 0; b < modes.size(); ++b) {
      const auto uses_field = [&](int i) { return modes[b].field == i || modes[b].minus == i || modes[b].plus == i; };
      const auto uses_event = [&](int j) {
        return modes[b].surface == j || modes[b].to_minus == j || modes[b].to_plus == j;
      };
      if (a != b && (uses_field(modes[a].field) || uses_event(modes[a].to_minus) || uses_event(modes[a].to_plus)))
        return SlidingFault::made_twice;
    }
  return SlidingFault::none;
}

/// Both fields at a state, and how they meet the surface.
template <class T, std::size_t n>
struct SlidingSides {
  std::array<T, n> minus;  ///< f-
  std::array<T, n> plus;   ///< f+
  T minus_rate;            ///< h_x f-
  T plus_rate;             ///< h_x f+

  /// Not finite where both rates are equal: both fields tangent (a two-fold), or no jump of h_x f.
  T lambda() const { return minus_rate / (minus_rate - plus_rate); }
};

/// Both fields of a mode at x with their h_x f. NaN where the problem leaves them unset.
template <class Problem, class T>
auto sliding_sides(const Problem& problem, const Sliding& mode, const T* x, const T* par) {
  constexpr auto n = static_cast<std::size_t>(Problem::dimension);
  constexpr auto q = static_cast<std::size_t>(Problem::parameters);
  SlidingSides<T, n> sides;
  sides.minus.fill(T(NAN));
  sides.plus.fill(T(NAN));
  problem.field(mode.minus, x, par, sides.minus.data());
  problem.field(mode.plus, x, par, sides.plus.data());
  using Along = Dual<2, T>;  // the derivatives in the directions f- and f+
  std::array<Along, n> moved;
  std::array<Along, q + 1> fixed;
  for (std::size_t i = 0; i < n; ++i) {
    moved[i].value = x[i];
    moved[i].derivative = {sides.minus[i], sides.plus[i]};
  }
  for (std::size_t i = 0; i < q; ++i) fixed[i].value = par[i];
  const Along h =
      problem.event(mode.surface, static_cast<const Along*>(moved.data()), static_cast<const Along*>(fixed.data()));
  sides.minus_rate = h.derivative[0];
  sides.plus_rate = h.derivative[1];
  return sides;
}

/// Filippov's field of a mode: `dimension` values.
template <class Problem, class T>
void sliding_field(const Problem& problem, const Sliding& mode, const T* x, const T* par, T* f) {
  const auto sides = sliding_sides(problem, mode, x, par);
  const T share = sides.lambda();
  for (std::size_t i = 0; i < sides.minus.size(); ++i) f[i] = sides.minus[i] + share * (sides.plus[i] - sides.minus[i]);
}

/// The event function `index`, `to_minus` or `to_plus` of the mode.
template <class Problem, class T>
T sliding_end(const Problem& problem, const Sliding& mode, int index, const T* x, const T* par) {
  const auto sides = sliding_sides(problem, mode, x, par);
  return index == mode.to_minus ? sides.minus_rate : -sides.plus_rate;
}

/// An event function with its gradient.
template <class Problem>
auto event_with_gradient(const Problem& problem, int index, const double* x, const double* par) {
  constexpr int n = Problem::dimension;
  using Along = Dual<n>;
  std::array<Along, static_cast<std::size_t>(n)> moved;
  std::array<Along, static_cast<std::size_t>(Problem::parameters) + 1> fixed;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i] = Along(x[i]);
    moved[i].derivative[i] = 1.0;
  }
  for (std::size_t i = 0; i + 1 < fixed.size(); ++i) fixed[i] = Along(par[i]);
  return problem.event(index, static_cast<const Along*>(moved.data()), static_cast<const Along*>(fixed.data()));
}

/// Is event function `index` that of the surface, or a multiple of it, as -h is?
template <class Problem>
bool is_surface_event(const Problem& problem, const Sliding& mode, int index, const double* x, const double* par) {
  constexpr double rounding = 1e-12;
  if (index == mode.surface) return true;
  if (index < 1 || index > Problem::events || index == mode.to_minus || index == mode.to_plus) return false;
  const auto h = event_with_gradient(problem, mode.surface, x, par);
  const auto other = event_with_gradient(problem, index, x, par);
  double along = h.value * other.value, own = h.value * h.value, others = other.value * other.value;
  for (std::size_t i = 0; i < h.derivative.size(); ++i) {
    along += h.derivative[i] * other.derivative[i];
    own += h.derivative[i] * h.derivative[i];
    others += other.derivative[i] * other.derivative[i];
  }
  return along * along >= (1.0 - rounding) * own * others && others > 0.0;
}

/// For `successors`: the field that is followed from the state x on, after the segment `from` (all zero at a start).
/// After an event that ends sliding it is the field that this event leads to. After an event of the surface (h, or a
/// multiple of it such as -h) that a side's segment ended in, or on the surface to rounding: the sliding field where
/// both sides point at it, else the field that leads away. Elsewhere the field of the side. Throws NoValue
/// where both lead away, as there Filippov's solution is not unique.
template <class Problem>
int next_field(const Problem& problem, const Sliding& mode, std::array<int, 3> from, const double* x,
               const double* par) {
  constexpr double rounding = 1e-8;
  if (from[0] == mode.field && from[1] == mode.to_minus) return mode.minus;
  if (from[0] == mode.field && from[1] == mode.to_plus) return mode.plus;
  const bool meets =
      (from[0] == mode.minus || from[0] == mode.plus) && is_surface_event(problem, mode, from[1], x, par);
  if (!meets) {
    const auto h = event_with_gradient(problem, mode.surface, x, par);
    double scale = 1.0;
    for (std::size_t i = 0; i < h.derivative.size(); ++i) scale += std::fabs(h.derivative[i] * x[i]);
    if (h.value > rounding * scale) return mode.plus;
    if (h.value < -rounding * scale) return mode.minus;
  }
  const auto sides = sliding_sides(problem, mode, x, par);
  const bool up = sides.plus_rate >= 0.0, down = sides.minus_rate <= 0.0;
  // A side that the orbit comes from points at the surface.
  if (meets && from[0] == mode.plus) return down ? mode.minus : mode.field;
  if (meets) return up ? mode.plus : mode.field;
  if (up && down) throw NoValue("both fields lead away from the surface");
  return up ? mode.plus : down ? mode.minus : mode.field;
}

}  // namespace tchat
