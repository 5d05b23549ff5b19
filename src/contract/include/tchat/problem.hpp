/// The only header a problem author includes: write one class and a registration line.
///
///     #include <tchat/problem.hpp>
///     struct BouncingBall {
///       static constexpr int dimension = 2, parameters = 2;            // state (height, velocity); PAR: g, r
///       static constexpr int fields = 1, events = 1, jumps = 1;
///       template <class T> void field(int i, const T* x, const T* par, T* f) const { f[0] = x[1]; f[1] = -par[0]; }
///       template <class T> T    event(int j, const T* x, const T* par) const { return x[0]; }
///       template <class T> void jump (int k, const T* x, const T* par, T* g) const {
///         g[0] = x[0], g[1] = -par[1] * x[1];
///       }
///     };
///     TCHAT_PROBLEM(BouncingBall)
///
/// The indices i, j, k count from 1; x[0] is U(1) and par[0] is PAR(1); par has `parameters` entries. T is double or a
/// dual number, so constants and local variables that depend on x or par must be of type T (or auto), and the usual
/// mathematical functions are called unqualified: sin(x[0]), pow(x[1], 3), fmax(x[0], 0.0). Where a function cannot be
/// evaluated it gives NaN or throws; an output left unset is NaN. A smooth problem leaves events and jumps out.
///
/// Optional members of the class:
///     static constexpr const char* state_names[]      = {"x", "v"};      // and parameter_names, field_names,
///                                                                        // event_names, jump_names
///     static constexpr double initial_parameters[]    = {9.81, 0.8};
///     static constexpr double initial_state[]         = {1.0, 0.0};       // where simulations start
///     // index jump function iota, for `tchat simulate`: the index vectors that may follow the segment `from`, whose
///     // last state, before the jump, is x; from = {0, 0, 0}: those at a start x. x and par may be left out.
///     std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double* par) const;
///     static constexpr int user_values = 1;                               // PVLS, with user_value_names if wanted
///     void user_value(const double* x, const double* par, double* out) const;         // x is x_1(0)
///     // boundary value problems (IPS = 4): conditions on the ends of all segments, each zero, and functions whose
///     // integrals over time, added over the segments s = 1.., are zero:
///     static constexpr int boundary_conditions = 2;                       // NBC
///     template <class T> void boundary(const tchat::Ends<T>& orbit, const T* par, T* b) const {
///       b[0] = orbit.start(1)[0]; b[1] = orbit.end(1)[0];                 // and orbit.duration(1)
///     }
///     static constexpr int integral_conditions = 1;                       // NINT
///     template <class T> void integrand(int s, const T* x, const T* par, const T* durations, T* q) const {
///       q[0] = x[0] - par[1] / durations[0];                              // the durations may be left out
///     }
///     // sliding on the surface of event function 1 between field 2 (below it) and field 1 (above): field 3 and the
///     // event functions 3 and 4, where it ends, are made by tchat (tchat/sliding.hpp)
///     static constexpr tchat::Sliding sliding{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3,
///                                             .to_plus = 4};
///     // impacts of jump 1 at event 1 in field 1 that may accumulate: field 2 in contact, event function 2, where that
///     // ends, jump 3, the limit of infinitely many impacts, event function 3, zero where these cease to have one, and
///     // jump 4, after contact, are made by tchat (tchat/chatter.hpp)
///     static constexpr tchat::Chatter chatter{.field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2,
///                                             .limit = 3, .margin = 3, .leave = 4};
///     // modes of different dimension: field i has the states x[0] .. x[dimension_of(i) - 1] and sets as many, jump k
///     // leads to a mode of dimension_after(k) states and sets these. `dimension` is the largest:
///     static constexpr int dimension_of(int i) { return i == 1 ? 4 : 5; }
///     static constexpr int dimension_after(int k) { return k == 1 ? 5 : 4; }
///     // hand-written first derivatives instead of automatic ones, column-major, zero before the call:
///     void field_derivatives(int i, const double* x, const double* par, double* dfdx, double* dfdp) const;
///     void event_derivatives(int j, const double* x, const double* par, double* dhdx, double* dhdp) const;
///     void jump_derivatives (int k, const double* x, const double* par, double* dgdx, double* dgdp) const;
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "tchat/chatter.hpp"
#include "tchat/dual.hpp"
#include "tchat/problem.h"
#include "tchat/sliding.hpp"

namespace tchat {

/// The ends of the segments s = 1..m of an orbit and their durations, for boundary conditions. A segment that is not
/// there throws, so that the conditions count as not to be evaluated.
template <class T>
class Ends {
 public:
  Ends(int segments, int dimension, const T* starts, const T* ends, const T* durations)
      : segments_(segments), dimension_(dimension), starts_(starts), ends_(ends), durations_(durations) {}

  int segments() const { return segments_; }
  const T* start(int s) const { return starts_ + place(s) * dimension_; }  ///< x_s(0)
  const T* end(int s) const { return ends_ + place(s) * dimension_; }      ///< x_s(1)
  T duration(int s) const { return durations_[place(s)]; }

 private:
  int place(int s) const {
    if (s < 1 || s > segments_) throw NoValue("the orbit has no such segment");
    return s - 1;
  }

  int segments_;
  int dimension_;
  const T* starts_;
  const T* ends_;
  const T* durations_;
};

/// Fills the C table of problem.h from a problem class. The class is default-constructed once and is never changed.
/// `Numbers` are what derivatives at many points are computed with, Lanes or double; the values are the same.
template <class Problem, class Numbers = PointNumbers>
class ProblemTable {
 public:
  /// The table of a problem class; the same object at every call.
  static const tchat_problem* get(const char* name) {
    static const Problem problem{};
    static const tchat_problem table = make(name, problem);
    return &table;
  }

  // Each is the message for one slip; the words in backticks are looked up in the author's file.
  static_assert(
      requires { Problem::dimension; },
      "tchat: the number of states is missing, or is not public: write struct, and "
      "in it static constexpr int `dimension` = ...;");
  static_assert(
      requires { Problem::parameters; },
      "tchat: the number of parameters is missing, or is not public: write struct, "
      "and in it static constexpr int `parameters` = ...;");
  static_assert(
      requires { Problem::fields; },
      "tchat: the number of vector fields is missing, or is not public: write struct, "
      "and in it static constexpr int `fields` = ...;");

 private:
#define TCHAT_COUNT(FUNCTION, MEMBER)            \
  static constexpr int FUNCTION() {              \
    if constexpr (requires { Problem::MEMBER; }) \
      return Problem::MEMBER;                    \
    else                                         \
      return 0;                                  \
  }
  TCHAT_COUNT(event_count, events)
  TCHAT_COUNT(jump_count, jumps)
  TCHAT_COUNT(boundary_count, boundary_conditions)
  TCHAT_COUNT(integral_count, integral_conditions)
#undef TCHAT_COUNT

  template <class T>
  static constexpr bool has_field = requires(const Problem& p, const T* x, T* f) {
    p.field(1, x, x, f);
  };
  template <class T>
  static constexpr bool has_event = requires(const Problem& p, const T* x) {
    p.event(1, x, x);
  };
  template <class T>
  static constexpr bool has_jump = requires(const Problem& p, const T* x, T* g) {
    p.jump(1, x, x, g);
  };
  static_assert(
      requires { Problem::events; } || !has_event<double>,
      "tchat: the number of event functions is missing, or is not public: write "
      "struct, and in it static constexpr int `events` = ...;");
  static_assert(
      requires { Problem::jumps; } || !has_jump<double>,
      "tchat: the number of jump functions is missing, or is not public: write struct, "
      "and in it static constexpr int `jumps` = ...;");
  static_assert(has_field<double> && has_field<Dual<1>>,
                "tchat: `field` must be: template <class T> void field(int i, const T* x, const T* par, T* f) const");
  static_assert(event_count() == 0 || (has_event<double> && has_event<Dual<1>>),
                "tchat: `event` must be: template <class T> T event(int j, const T* x, const T* par) const");
  static_assert(jump_count() == 0 || (has_jump<double> && has_jump<Dual<1>>),
                "tchat: `jump` must be: template <class T> void jump(int k, const T* x, const T* par, T* g) const");

  template <class T>
  static constexpr bool has_boundary = requires(const Problem& p, const Ends<T>& orbit, const T* par, T* b) {
    p.boundary(orbit, par, b);
  };
  template <class T>
  static constexpr bool has_integrand_of_durations = requires(const Problem& p, const T* x, T* q) {
    p.integrand(1, x, x, x, q);
  };
  template <class T>
  static constexpr bool has_integrand = has_integrand_of_durations<T> || requires(const Problem& p, const T* x, T* q) {
    p.integrand(1, x, x, q);
  };
  static_assert(
      !has_boundary<double> || requires { Problem::boundary_conditions; },
      "tchat: the number of boundary conditions is missing, or is not public: write in the "
      "struct static constexpr int `boundary_conditions` = ...;");
  static_assert(
      !has_integrand<double> || requires { Problem::integral_conditions; },
      "tchat: the number of integral conditions is missing, or is not public: write in the "
      "struct static constexpr int `integral_conditions` = ...;");
  static constexpr bool has_user_value = requires(const Problem& p, const double* x, double* out) {
    p.user_value(x, x, out);
  };
  static_assert(
      has_user_value || !requires { Problem::user_values; },
      "tchat: `user_value` must be: void user_value(const double* x, const double* par, double* out) const");
  static_assert(integral_count() == 0 || boundary_count() > 0,
                "tchat: `integral_conditions` are those of boundary value problems: `boundary_conditions` must be at "
                "least 1");
  static_assert(boundary_count() == 0 || (has_boundary<double> && has_boundary<Dual<1>>),
                "tchat: `boundary` must be: template <class T> void boundary(const tchat::Ends<T>& orbit, const T* "
                "par, T* b) const");
  static_assert(
      integral_count() == 0 || (has_integrand<double> && has_integrand<Dual<1>>),
      "tchat: `integrand` must be: template <class T> void integrand(int s, const T* x, const T* par, const T* "
      "durations, T* q) const");

  static constexpr int n = Problem::dimension;
  static constexpr int q = Problem::parameters;

  static constexpr bool has_dimensions = requires { Problem::dimension_of(1); };
  static_assert(
      has_dimensions == requires { Problem::dimension_after(1); } || jump_count() == 0,
      "tchat: `dimension_of` and `dimension_after` belong together: static constexpr int dimension_of(int field), "
      "and static constexpr int dimension_after(int jump)");

  /// How many states a function sets; the others are not there.
  static constexpr int states_of([[maybe_unused]] std::int32_t kind, [[maybe_unused]] int index) {
    if constexpr (has_dimensions) {
      if (kind == TCHAT_FIELD) return Problem::dimension_of(index);
      if constexpr (jump_count() > 0)
        if (kind == TCHAT_JUMP) return Problem::dimension_after(index);
    }
    return n;
  }
  template <std::int32_t kind, int count>
  static constexpr auto dimensions_of_functions() {
    std::array<std::int32_t, static_cast<std::size_t>(count > 0 ? count : 1)> dimensions{};
    for (int i = 1; i <= count; ++i) dimensions[static_cast<std::size_t>(i - 1)] = states_of(kind, i);
    return dimensions;
  }
  static constexpr auto field_dimensions = dimensions_of_functions<TCHAT_FIELD, Problem::fields>();
  static constexpr auto jump_dimensions = dimensions_of_functions<TCHAT_JUMP, jump_count()>();
  static constexpr bool are_dimensions(const auto& dimensions, int count) {
    for (int i = 0; i < count; ++i)
      if (dimensions[static_cast<std::size_t>(i)] < 1 || dimensions[static_cast<std::size_t>(i)] > Problem::dimension)
        return false;
    return true;
  }
  static_assert(are_dimensions(field_dimensions, Problem::fields) && are_dimensions(jump_dimensions, jump_count()),
                "tchat: `dimension_of` and `dimension_after` must be between 1 and `dimension`, the largest");

  static constexpr auto modes = sliding_modes_of<Problem>();
  static_assert(sliding_fault(modes, Problem::fields, event_count()) != SlidingFault::field_range,
                "tchat: `sliding`: field, minus and plus must be numbers from 1 to `fields`");
  static_assert(sliding_fault(modes, Problem::fields, event_count()) != SlidingFault::event_range,
                "tchat: `sliding`: surface, to_minus and to_plus must be numbers from 1 to `events`");
  static_assert(sliding_fault(modes, Problem::fields, event_count()) != SlidingFault::same_fields,
                "tchat: `sliding`: field, minus and plus must be three different fields");
  static_assert(sliding_fault(modes, Problem::fields, event_count()) != SlidingFault::same_events,
                "tchat: `sliding`: surface, to_minus and to_plus must be three different event functions");
  static_assert(sliding_fault(modes, Problem::fields, event_count()) != SlidingFault::made_twice,
                "tchat: `sliding`: a field or an event function that one mode makes is also made by another, or is "
                "what another is made of");
  static constexpr bool slide_with_all_states() {
    for (const Sliding& mode : modes)
      for (const int field : {mode.field, mode.minus, mode.plus})
        if (states_of(TCHAT_FIELD, field) != n) return false;
    return true;
  }
  static_assert(slide_with_all_states(),
                "tchat: `sliding`: field, minus and plus must have all states: `dimension_of`");
  static_assert(n >= 1, "tchat: `dimension` must be at least 1");
  static_assert(q >= 0, "tchat: `parameters`, their number, must not be negative");
  static_assert(Problem::fields >= 1, "tchat: `fields`, the number of vector fields, must be at least 1");
  static_assert(boundary_count() >= 0, "tchat: `boundary_conditions`, their number, must not be negative");
  static_assert(integral_count() >= 0, "tchat: `integral_conditions`, their number, must not be negative");
  static_assert(
      event_count() >= 1 || boundary_count() > 0 || !requires { Problem::events; },
      "tchat: `events`, the number of event functions, must be at least 1");
  static_assert(
      jump_count() >= 1 || boundary_count() > 0 || !requires { Problem::jumps; },
      "tchat: `jumps`, the number of jump functions, must be at least 1");

  /// Derivatives carried at once: all states and two parameters where that is cheap, else eight at a time.
  static constexpr int width = n + 2 <= 10 ? n + 2 : 8;

  template <class T>
  using States = std::array<T, static_cast<std::size_t>(n)>;
  template <class T>
  using Values = std::array<T, static_cast<std::size_t>(n > integral_count() ? n : integral_count())>;
  template <class T>
  using Parameters = std::array<T, static_cast<std::size_t>(q > 0 ? q : 1)>;

  /// For integrands, which may depend on them.
  static constexpr int durations_begin = TCHAT_FIRST_DURATION(q);  // par[durations_begin] is T_1
  template <class T>
  using Durations = std::array<T, static_cast<std::size_t>(integral_count() > 0 ? 64 : 1)>;

  static const Problem& object(const void* self) { return *static_cast<const Problem*>(self); }

  static constexpr int rows(std::int32_t kind) {
    return kind == TCHAT_EVENT ? 1 : kind == TCHAT_INTEGRAND ? integral_count() : n;
  }

  /// The sliding mode that makes a function; null for the problem's own ones.
  static const Sliding* mode_of(std::int32_t kind, int index) {
    for (const Sliding& mode : modes)
      if ((kind == TCHAT_FIELD && index == mode.field) ||
          (kind == TCHAT_EVENT && (index == mode.to_minus || index == mode.to_plus)))
        return &mode;
    return nullptr;
  }

  static constexpr auto chatter = chatter_modes_of<Problem>();
  static_assert(chatter_fault(chatter, Problem::fields, event_count(), jump_count()) != ChatterFault::field_range,
                "tchat: `chatter`: field and contact must be numbers from 1 to `fields`");
  static_assert(chatter_fault(chatter, Problem::fields, event_count(), jump_count()) != ChatterFault::event_range,
                "tchat: `chatter`: event, release, margin and time must be numbers from 1 to `events`");
  static_assert(chatter_fault(chatter, Problem::fields, event_count(), jump_count()) != ChatterFault::jump_range,
                "tchat: `chatter`: impact, limit and leave must be numbers from 1 to `jumps`");
  static_assert(
      chatter_fault(chatter, Problem::fields, event_count(), jump_count()) != ChatterFault::made_of_itself,
      "tchat: `chatter`: contact, release, limit, margin, time and leave must be functions of their own, which no "
      "mode is made of");

  /// The chatter mode that makes a function; null for the problem's own ones.
  static const Chatter* chatter_of(std::int32_t kind, int index) {
    for (const Chatter& mode : chatter)
      if ((kind == TCHAT_FIELD && index == mode.contact) ||
          (kind == TCHAT_JUMP && (index == mode.limit || index == mode.leave)) ||
          (kind == TCHAT_EVENT && (index == mode.release || index == mode.margin || index == mode.time)))
        return &mode;
    return nullptr;
  }

  template <class T>
  static void evaluate_chatter(const Problem& problem, const Chatter& mode, std::int32_t kind, int index, const T* x,
                               const T* par, T* out) {
    const ChatterFunctions functions(problem, mode);
    if (kind == TCHAT_FIELD) functions.contact(x, par, out);
    if (kind == TCHAT_EVENT && index == mode.release) out[0] = functions.release(x, par);
    if (kind == TCHAT_EVENT && index == mode.margin) out[0] = functions.margin(x, par);
    if (kind == TCHAT_EVENT && index == mode.time) out[0] = functions.rest(x, par).time;
    if (kind == TCHAT_JUMP && index == mode.limit) functions.limit(x, par, out);
    if (kind == TCHAT_JUMP && index == mode.leave) functions.leave(x, par, out);
  }

  /// F(x, par), rows preset to NaN by the caller. A problem may throw where it cannot be evaluated: the callers are C
  /// code, so the exception ends here as NaN. Compiled once for each kind of numbers.
  template <class T>
  __attribute__((noinline)) static void evaluate(const void* self, std::int32_t kind, int index, const T* x,
                                                 const T* par, [[maybe_unused]] const T* durations, T* out) {
    const Problem& problem = object(self);
    try {
      if (const Sliding* const mode = mode_of(kind, index)) {
        if constexpr (!modes.empty()) {
          if (kind == TCHAT_FIELD) sliding_field(problem, *mode, x, par, out);
          if (kind == TCHAT_EVENT) out[0] = sliding_end(problem, *mode, index, x, par);
        }
        return;
      }
      if (const Chatter* const mode = chatter_of(kind, index)) {
        if constexpr (!chatter.empty()) evaluate_chatter(problem, *mode, kind, index, x, par, out);
        return;
      }
      if (kind == TCHAT_FIELD) problem.field(index, x, par, out);
      if constexpr (event_count() > 0)
        if (kind == TCHAT_EVENT) out[0] = problem.event(index, x, par);
      if constexpr (jump_count() > 0)
        if (kind == TCHAT_JUMP) problem.jump(index, x, par, out);
      if constexpr (integral_count() > 0)
        if (kind == TCHAT_INTEGRAND) {
          if constexpr (has_integrand_of_durations<T>)
            problem.integrand(index, x, par, durations, out);
          else
            problem.integrand(index, x, par, out);
        }
    } catch (...) {
      fill(out, rows(kind), T(NAN));
    }
    if constexpr (has_dimensions)
      if (kind == TCHAT_FIELD || kind == TCHAT_JUMP)
        for (int a = states_of(kind, index); a < n; ++a) out[a] = kind == TCHAT_FIELD ? T(-x[a]) : T(0.0);
  }

  static void value(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    fill(out, rows(kind), static_cast<double>(NAN));
    evaluate<double>(self, kind, index, x, par, par + durations_begin, out);
  }

  template <class T>
  static void fill(T* out, std::ptrdiff_t count, const T& value) {
    for (std::ptrdiff_t i = 0; i < count; ++i) out[i] = value;
  }

  /// Column c of the derivative belongs to state c, or to parameter active[c - n].
  static bool is_problem_parameter(int k) { return k >= 1 && k <= q; }

  static void first(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    const std::int32_t* active, std::int32_t active_count, double* out, double* dx, double* dp) {
    first_at_points(self, kind, index, 1, x, par, active, active_count, out, dx, dp);
  }

  static constexpr bool has_lanes = std::is_same_v<Numbers, Lanes>;
  /// How many points are evaluated together.
  static constexpr int together = has_lanes ? Lanes::count : 1;
  static_assert(Lanes::count == TCHAT_POINTS_OF_SET);

  /// Points first .. first + held - 1, which are evaluated together.
  struct PointSet {
    std::ptrdiff_t first;
    int held;
    const bool* disagreed;  ///< null for one point

    /// After the evaluation: has every comparison had one answer?
    bool is_of_use() const { return disagreed == nullptr || !*disagreed; }
  };

  /// Numbers of the points of a set, in an array with the numbers of all points. `D` is double, or constant.
  template <class D>
  struct Place {
    D* begin;
    std::ptrdiff_t number_step, point_step;
    int held;

    /// Number k of each point; the last one's is in all lanes that are left.
    Numbers load(std::ptrdiff_t k) const {
      const double* const from = begin + k * number_step;
      if constexpr (has_lanes) {
        if (held == 1) return Lanes(*from);
        if (held == Lanes::count && point_step == 1) return Lanes::from(from);
        const auto of_lane = [&](int l) { return from[(l < held ? l : held - 1) * point_step]; };
        return Lanes(of_lane(0), of_lane(1), of_lane(2), of_lane(3));
      } else {
        return *from;
      }
    }
    void store(std::ptrdiff_t k, const Numbers& numbers) const {
      D* const to = begin + k * number_step;
      if constexpr (has_lanes) {
        if (held == 1) {
          *to = numbers.lane(0);
          return;
        }
        if (held == Lanes::count && point_step == 1) return numbers.to(to);
        numbers.scatter(to, point_step, held);
      } else {
        *to = numbers;
      }
    }
  };

  /// Of each point `size` numbers, one point after the other.
  struct OneByOne {
    template <class D>
    static Place<D> place(D* all, std::ptrdiff_t size, const PointSet& set) {
      return {all + set.first * size, 1, size, set.held};
    }
  };
  /// Four points side by side, as first_in_lanes has them.
  struct SideBySide {
    template <class D>
    static Place<D> place(D* all, std::ptrdiff_t size, const PointSet& set) {
      const std::ptrdiff_t lane = set.first % TCHAT_POINTS_OF_SET;
      if (size == 0) return {all, 0, 0, 0};  // perhaps null
      return {all + (set.first - lane) * size + lane, TCHAT_POINTS_OF_SET, 1, set.held};
    }
  };

  /// work(set) for all points, as many as are evaluated together at a time. Where it is false, as the set is of no use,
  /// its points are worked on one by one.
  template <class Work>
  static void in_sets(std::ptrdiff_t points, const Work& work) {
    bool& disagreed = parted();
    int alone = 0;  // so many points are still to be worked on one by one
    for (std::ptrdiff_t first = 0; first < points;) {
      const int held = alone > 0 ? 1 : points - first < together ? static_cast<int>(points - first) : together;
      disagreed = false;
      if (work(PointSet{first, held, held > 1 ? &disagreed : nullptr})) {
        first += held;
        if (alone > 0) --alone;
      } else {
        alone = held;
      }
    }
  }

  /// Arrays of dual numbers are made and set to zero once for all points: for a field of a few terms that takes longer
  /// than the field.
  template <class Order>
  __attribute__((noinline)) static void first_of(const void* self, std::int32_t kind, std::int32_t index,
                                                 std::ptrdiff_t points, const double* x, const double* par,
                                                 const std::int32_t* active, std::int32_t active_count, double* out,
                                                 double* dx, double* dp) {
    using T = Dual<width, Numbers>;
    if (points <= 0) return;
    const int columns = n + active_count;
    for (int begin = 0; begin < columns; begin += width) {
      States<T> xs;
      Parameters<T> ps;
      Durations<T> ts;
      Values<T> ys;
      load(x, par, xs, ps, ts);
      for (int k = 0; k < width && begin + k < columns; ++k)
        if (T* seed = variable(begin + k, active, xs, ps, ts)) seed->derivative[static_cast<std::size_t>(k)] = 1.0;
      in_sets(points, [&](const PointSet& set) {
        const Place<const double> states = Order::place(x, n, set);
        for (int i = 0; i < n; ++i) xs[static_cast<std::size_t>(i)].value = states.load(i);
        for (T& y : ys) y.value = NAN;
        evaluate<T>(self, kind, index, xs.data(), ps.data(), ts.data(), ys.data());
        if (!set.is_of_use()) return false;
        const int r = rows(kind);
        const Place<double> values = Order::place(out, r, set);
        const Place<double> by_state = Order::place(dx, r * n, set);
        const Place<double> by_parameter = Order::place(dp, r * active_count, set);
        for (int i = 0; i < r; ++i) {
          const T& y = ys[static_cast<std::size_t>(i)];
          values.store(i, y.value);
          for (int k = 0; k < width && begin + k < columns; ++k) {
            const int c = begin + k;
            (c < n ? by_state : by_parameter)
                .store((c < n ? c : c - n) * r + i, y.derivative[static_cast<std::size_t>(k)]);
          }
        }
        return true;
      });
    }
  }

  static void first_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                              const double* x, const double* par, const std::int32_t* active, std::int32_t active_count,
                              double* out, double* dx, double* dp) {
    if (points <= 0 || hand_written_at_points(self, kind, index, points, x, par, active, active_count, out, dx, dp))
      return;
    first_of<OneByOne>(self, kind, index, points, x, par, active, active_count, out, dx, dp);
  }

  /// For problems without derivatives of their own.
  static void first_in_lanes(const void* self, std::int32_t kind, std::int32_t index, std::int32_t sets,
                             const double* x, const double* par, const std::int32_t* active, std::int32_t active_count,
                             double* out, double* dx, double* dp) {
    first_of<SideBySide>(self, kind, index, static_cast<std::ptrdiff_t>(sets) * TCHAT_POINTS_OF_SET, x, par, active,
                         active_count, out, dx, dp);
  }

  __attribute__((cold)) static void second(const void* self, std::int32_t kind, std::int32_t index, const double* x,
                                           const double* par, const std::int32_t* active, std::int32_t active_count,
                                           const double* direction, double* out, double* dx, double* dp) {
    using T = Dual<width, Dual<1, Numbers>>;
    const int r = rows(kind);
    const int columns = n + active_count;
    for (int begin = 0; begin < columns; begin += width) {
      States<T> xs;
      Parameters<T> ps;
      Durations<T> ts;
      Values<T> ys;
      load(x, par, xs, ps, ts);
      for (int c = 0; c < columns; ++c)
        if (T* moved = variable(c, active, xs, ps, ts)) moved->value.derivative[0] += direction[c];
      for (int k = 0; k < width && begin + k < columns; ++k)
        if (T* seed = variable(begin + k, active, xs, ps, ts)) seed->derivative[static_cast<std::size_t>(k)] = 1.0;
      preset(ys);
      evaluate<T>(self, kind, index, xs.data(), ps.data(), ts.data(), ys.data());
      for (int k = 0; k < width && begin + k < columns; ++k) {
        const int c = begin + k;
        double* const column = c < n ? dx + c * r : dp + (c - n) * r;
        for (int i = 0; i < r; ++i)
          column[i] = plain(ys[static_cast<std::size_t>(i)].derivative[static_cast<std::size_t>(k)].derivative[0]);
      }
      for (int i = 0; i < r; ++i) out[i] = plain(ys[static_cast<std::size_t>(i)].value.derivative[0]);
    }
  }

  using Product = Dual<1, Dual<1, Dual<1, Numbers>>>;
  /// That of the product e^m.
  template <class P>
  static auto& coefficient(P& of, int m) {
    auto& first = (m & 1) != 0 ? of.derivative[0] : of.value;
    auto& second = (m & 2) != 0 ? first.derivative[0] : first.value;
    return (m & 4) != 0 ? second.derivative[0] : second.value;
  }

  static void third(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    third_at_points(self, kind, index, 1, x, par, out);
  }

  static void third_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                              const double* x, const double* par, double* out) {
    if (points <= 0) return;
    States<Product> xs;
    Parameters<Product> ps;
    Durations<Product> ts;
    Values<Product> ys;
    load(x, par, xs, ps, ts);
    const int r = rows(kind);
    in_sets(points, [&](const PointSet& set) {
      const Place<const double> states = OneByOne::place(x, 8 * n, set);
      for (int m = 0; m < 8; ++m)
        for (int i = 0; i < n; ++i) coefficient(xs[static_cast<std::size_t>(i)], m) = states.load(m * n + i);
      preset(ys);
      evaluate<Product>(self, kind, index, xs.data(), ps.data(), ts.data(), ys.data());
      if (!set.is_of_use()) return false;
      const Place<double> values = OneByOne::place(out, 8 * r, set);
      for (int m = 0; m < 8; ++m)
        for (int i = 0; i < r; ++i) values.store(m * r + i, coefficient(ys[static_cast<std::size_t>(i)], m));
      return true;
    });
  }

  /// Directions one by one: two in one dual number are slower, and every kind of dual number has to be compiled.
  // NOLINTBEGIN(readability-non-const-parameter): written by way of WeightedPoints
  static void second_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                               std::int32_t directions, const double* x, const double* par, const std::int32_t* active,
                               std::int32_t active_count, const double* v, const double* q, const double* weights,
                               double* out, double* gradient) {
    const WeightedPoints at{self,   kind,         index, points, directions, x,   par,
                            active, active_count, v,     q,      weights,    out, gradient};
    if (directions <= 0) fill(gradient, static_cast<std::ptrdiff_t>(points) * (n + active_count), 0.0);
    for (int k = 0; k < directions; ++k) add_direction(at, k);
  }
  // NOLINTEND(readability-non-const-parameter)

  /// The arguments of second_at_points.
  struct WeightedPoints {
    const void* self;
    std::int32_t kind, index, points, directions;
    const double* x;
    const double* par;
    const std::int32_t* active;
    std::int32_t active_count;
    const double* v;
    const double* q;
    const double* weights;
    double* out;
    double* gradient;
  };

  /// The share of direction k in the gradients; u . F belongs to direction 0.
  static void add_direction(const WeightedPoints& at, int k) {
    using Along = Dual<1, Numbers>;
    using T = Dual<width, Along>;
    const int columns = n + at.active_count;
    for (int begin = 0; begin < columns; begin += width) {
      const int count = columns - begin < width ? columns - begin : width;
      States<T> xs;
      Parameters<T> ps;
      Durations<T> ts;
      Values<T> ys;
      load(at.x, at.par, xs, ps, ts);
      for (int c = n; c < columns; ++c)
        if (T* moved = variable(c, at.active, xs, ps, ts))
          moved->value.derivative[0] += at.q[k * at.active_count + c - n];
      for (int c = 0; c < count; ++c)
        if (T* seed = variable(begin + c, at.active, xs, ps, ts)) seed->derivative[static_cast<std::size_t>(c)] = 1.0;
      in_sets(at.points, [&](const PointSet& set) {
        const Place<const double> states = OneByOne::place(at.x, n, set);
        const Place<const double> directions = OneByOne::place(at.v, at.directions * n, set);
        for (int i = 0; i < n; ++i) {
          xs[static_cast<std::size_t>(i)].value.value = states.load(i);
          xs[static_cast<std::size_t>(i)].value.derivative[0] = directions.load(k * n + i);
        }
        for (T& y : ys) y.value = NAN;
        evaluate<T>(at.self, at.kind, at.index, xs.data(), ps.data(), ts.data(), ys.data());
        if (!set.is_of_use()) return false;
        const int r = rows(at.kind);
        const Place<const double> weights = OneByOne::place(at.weights, (at.directions + 1) * r, set);
        const Place<double> out = OneByOne::place(at.out, at.directions * r, set);
        const Place<double> gradient = OneByOne::place(at.gradient, columns, set);
        std::array<Numbers, static_cast<std::size_t>(width)> sums{};
        for (int c = 0; c < count && k > 0; ++c) sums[static_cast<std::size_t>(c)] = gradient.load(begin + c);
        for (int i = 0; i < r; ++i) {
          const T& y = ys[static_cast<std::size_t>(i)];
          const Numbers unknown = y.value.value - y.value.value;  // NaN where it cannot be evaluated
          const Numbers w = weights.load(k * r + i);
          const Numbers u = (k == 0 ? weights.load(at.directions * r + i) : Numbers(0.0)) + unknown;
          out.store(k * r + i, y.value.derivative[0] + unknown);
          for (std::size_t c = 0; c < sums.size(); ++c)
            sums[c] += u * y.derivative[c].value + w * y.derivative[c].derivative[0];
        }
        for (int c = 0; c < count; ++c) gradient.store(begin + c, sums[static_cast<std::size_t>(c)]);
        return true;
      });
    }
  }

  template <class T>
  __attribute__((noinline)) static void load(const double* x, const double* par, States<T>& xs, Parameters<T>& ps,
                                             Durations<T>& ts) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) xs[i] = T(x[i]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(q); ++i) ps[i] = T(par[i]);
    for (std::size_t i = 0; integral_count() > 0 && i < ts.size(); ++i) ts[i] = T(par[durations_begin + i]);
  }

  template <class T>
  static void preset(Values<T>& ys) {
    for (T& y : ys) y = T(NAN);
  }

  /// The variable that column c differentiates by; null for a PAR that the problem does not own.
  template <class T>
  static T* variable(int c, const std::int32_t* active, States<T>& xs, Parameters<T>& ps, Durations<T>& ts) {
    if (c < n) return &xs[static_cast<std::size_t>(c)];
    const int k = active[c - n];
    if (is_problem_parameter(k)) return &ps[static_cast<std::size_t>(k - 1)];
    const int s = k - durations_begin - 1;
    const bool is_duration = integral_count() > 0 && s >= 0 && s < static_cast<int>(ts.size());
    return is_duration ? &ts[static_cast<std::size_t>(s)] : nullptr;
  }

  /// Does the problem have derivatives of its own, of some kind of function?
  static constexpr bool gives_derivatives = requires(const Problem& problem, const double* x, double* dx) {
    problem.field_derivatives(1, x, x, dx, dx);
  }
  || requires(const Problem& problem, const double* x, double* dx) { problem.event_derivatives(1, x, x, dx, dx); }
  || requires(const Problem& problem, const double* x, double* dx) { problem.jump_derivatives(1, x, x, dx, dx); };

  static bool hand_written(const void* self, std::int32_t kind, int index, const double* x, const double* par,
                           const std::int32_t* active, std::int32_t active_count, double* dx, double* dp) {
    std::array<double, static_cast<std::size_t>(n * (q > 0 ? q : 1))> all{};
    const Problem& problem = object(self);
    bool given = false;
    if (mode_of(kind, index) != nullptr || chatter_of(kind, index) != nullptr) return false;
    fill(dx, rows(kind) * n, 0.0);
    if constexpr (requires { problem.field_derivatives(index, x, par, dx, dp); })
      if (kind == TCHAT_FIELD) problem.field_derivatives(index, x, par, dx, all.data()), given = true;
    if constexpr (requires { problem.event_derivatives(index, x, par, dx, dp); })
      if (kind == TCHAT_EVENT) problem.event_derivatives(index, x, par, dx, all.data()), given = true;
    if constexpr (requires { problem.jump_derivatives(index, x, par, dx, dp); })
      if (kind == TCHAT_JUMP) problem.jump_derivatives(index, x, par, dx, all.data()), given = true;
    if (!given) return false;
    const int r = rows(kind);
    for (int a = 0; a < active_count; ++a)
      for (int i = 0; i < r; ++i)
        dp[a * r + i] = is_problem_parameter(active[a]) ? all[static_cast<std::size_t>((active[a] - 1) * r + i)] : 0.0;
    if constexpr (has_dimensions)
      if (kind == TCHAT_FIELD || kind == TCHAT_JUMP)
        for (int i = states_of(kind, index); i < n; ++i) {
          for (int c = 0; c < n; ++c) dx[c * n + i] = kind == TCHAT_FIELD && c == i ? -1.0 : 0.0;
          for (int a = 0; a < active_count; ++a) dp[a * n + i] = 0.0;
        }
    return true;
  }

  /// False when there are none of this function, at any point.
  static bool hand_written_at_points(const void* self, std::int32_t kind, int index, std::int32_t points,
                                     const double* x, const double* par, const std::int32_t* active,
                                     std::int32_t active_count, double* out, double* dx, double* dp) {
    if constexpr (gives_derivatives) {
      const int r = rows(kind);
      for (std::int32_t k = 0; k < points; ++k, x += n, out += r, dx += r * n, dp += r * active_count) {
        if (!hand_written(self, kind, index, x, par, active, active_count, dx, dp)) return false;
        value(self, kind, index, x, par, out);
      }
      return true;
    }
    return false;
  }

  /// The boundary conditions, preset to NaN.
  template <class T>
  static void evaluate_boundary(const void* self, int segments, const std::vector<T>& starts,
                                const std::vector<T>& ends, const std::vector<T>& durations, const T* par, T* out) {
    fill(out, boundary_count(), T(NAN));
    if constexpr (boundary_count() > 0) try {
        object(self).boundary(Ends<T>(segments, n, starts.data(), ends.data(), durations.data()), par, out);
      } catch (...) {
        fill(out, boundary_count(), T(NAN));
      }
  }

  /// Variables of type T with these values. The memory is used again at the next call.
  template <class T>
  static std::vector<T>& variables(std::vector<T>& memory, const double* values, int count) {
    memory.assign(values, values + count);
    return memory;
  }

  static void boundary(const void* self, std::int32_t segments, const double* starts, const double* ends,
                       const double* par, double* out) {
    thread_local std::vector<double> memory[3];
    evaluate_boundary<double>(self, segments, variables(memory[0], starts, n * segments),
                              variables(memory[1], ends, n * segments),
                              variables(memory[2], par + durations_begin, segments), par, out);
  }

  static void boundary_first(const void* self, std::int32_t segments, const double* starts, const double* ends,
                             const double* par, const std::int32_t* active, std::int32_t active_count, double* out,
                             double* dstarts, double* dends, double* dp) {
    using T = Dual<width>;
    thread_local std::vector<T> memory[3];
    std::array<T, static_cast<std::size_t>(boundary_count() > 0 ? boundary_count() : 1)> values;
    const int states = n * segments;
    for (int begin = 0; begin < 2 * states + active_count; begin += width) {
      std::vector<T>& first = variables(memory[0], starts, states);
      std::vector<T>& last = variables(memory[1], ends, states);
      std::vector<T>& durations = variables(memory[2], par + durations_begin, segments);
      Parameters<T> ps;
      for (std::size_t i = 0; i < static_cast<std::size_t>(q); ++i) ps[i] = T(par[i]);
      const auto variable_of = [&](int c) -> T* {
        if (c < states) return &first[static_cast<std::size_t>(c)];
        if (c < 2 * states) return &last[static_cast<std::size_t>(c - states)];
        const int k = active[c - 2 * states];
        if (is_problem_parameter(k)) return &ps[static_cast<std::size_t>(k - 1)];
        const int s = k - durations_begin;
        return s >= 1 && s <= segments ? &durations[static_cast<std::size_t>(s - 1)] : nullptr;
      };
      for (int k = 0; k < width && begin + k < 2 * states + active_count; ++k)
        if (T* seed = variable_of(begin + k)) seed->derivative[static_cast<std::size_t>(k)] = 1.0;
      evaluate_boundary<T>(self, segments, first, last, durations, ps.data(), values.data());
      for (int k = 0; k < width && begin + k < 2 * states + active_count; ++k) {
        const int c = begin + k;
        double* column = c < states       ? dstarts + c * boundary_count()
                         : c < 2 * states ? dends + (c - states) * boundary_count()
                                          : dp + (c - 2 * states) * boundary_count();
        for (int i = 0; i < boundary_count(); ++i)
          column[i] = values[static_cast<std::size_t>(i)].derivative[static_cast<std::size_t>(k)];
      }
      for (int i = 0; i < boundary_count(); ++i) out[i] = values[static_cast<std::size_t>(i)].value;
    }
  }

  using IndexVectors = std::vector<std::array<int, 3>>;
  static constexpr bool names_successors = requires { &Problem::successors; };
  static constexpr bool successors_of_state = requires(const Problem& p, const double* v) {
    IndexVectors(p.successors(std::array<int, 3>{}, v, v));
  };
  static constexpr bool successors_of_x = requires(const Problem& p, const double* v) {
    IndexVectors(p.successors(std::array<int, 3>{}, v));
  };
  static constexpr bool successors_alone = requires(const Problem& p) {
    IndexVectors(p.successors(std::array<int, 3>{}));
  };
  static constexpr bool has_successors = successors_of_state || successors_of_x || successors_alone;
  static_assert(!names_successors || has_successors,
                "tchat: `successors` must be: std::vector<std::array<int, 3>> successors(std::array<int, 3> from, "
                "const double* x, "
                "const double* par) const");

  static std::int32_t successors(const void* self, const std::int32_t from[3], const double* x, const double* par,
                                 std::int32_t* to, std::int32_t capacity) {
    std::int32_t count = 0;
    try {
      const std::array<int, 3> last{from[0], from[1], from[2]};
      IndexVectors next = listed_successors(object(self), last, x, par);
      if constexpr (!chatter.empty())
        for (const Chatter& mode : chatter) allow_limit(object(self), mode, last, x, par, next);
      for (const auto& index_vector : next) {
        if (count < capacity)
          for (int k = 0; k < 3; ++k) to[3 * count + k] = index_vector[static_cast<std::size_t>(k)];
        ++count;
      }
    } catch (...) {
      return -1;
    }
    return count;
  }

  static IndexVectors listed_successors(const Problem& problem, const std::array<int, 3>& from, const double* x,
                                        const double* par) {
    if constexpr (successors_of_state)
      return problem.successors(from, x, par);
    else if constexpr (successors_of_x)
      return problem.successors(from, x);
    else if constexpr (successors_alone)
      return problem.successors(from);
    else
      return {};
  }

  /// After an impact from which on they accumulate, the next one may be the limit of all; it is where they are near
  /// that. Behind a section on the way there it is where the next one is. After the limit comes contact, which lasts
  /// until its release, whatever other events the problem lists for it.
  static void allow_limit(const Problem& problem, const Chatter& mode, const std::array<int, 3>& from, const double* x,
                          const double* par, IndexVectors& next) {
    const std::array<int, 3> impact{mode.field, mode.event, mode.impact};
    const std::array<int, 3> limit{mode.field, mode.event, mode.limit};
    const std::array<int, 3> release{mode.contact, mode.release, mode.leave};
    if (from == limit || (from[0] == mode.contact && from != release)) {
      const auto of_contact = [&](const IndexVectors& list) {
        IndexVectors found;
        for (const auto& index_vector : list)
          if (index_vector[0] == mode.contact && index_vector != release) found.push_back(index_vector);
        return found;
      };
      // Behind another event in contact what the problem lists for it, else what it lists after the limit.
      IndexVectors further = of_contact(next);
      if (further.empty() && from != limit) further = of_contact(listed_successors(problem, limit, x, par));
      next = std::move(further);
      next.push_back(release);
      return;
    }
    std::size_t place = 0;
    while (place < next.size() && next[place] != impact) ++place;
    if (place == next.size()) return;
    const ChatterFunctions functions(problem, mode);
    int before = -1;
    if (from == impact)
      before = functions.impacts_before_limit(x, par);
    else if (from[0] == mode.field)
      before = functions.impacts_before_limit_from(x, par);
    if (before >= 0) next.insert(next.begin() + static_cast<std::ptrdiff_t>(before == 0 ? place : place + 1), limit);
  }

  static void user_value(const void* self, const double* x, const double* par, double* out) {
    if constexpr (has_user_value) object(self).user_value(x, par, out);
  }

  static tchat_problem make(const char* name, const Problem& problem) {
    tchat_problem table{};
    table.abi_version = TCHAT_PROBLEM_ABI;
    table.struct_size = sizeof(tchat_problem);
    table.dimension = n;
    table.parameters = q;
    table.fields = Problem::fields;
    table.events = event_count();
    table.jumps = jump_count();
    table.derivative_order = 2;
    table.name = name;
    table.self = &problem;
    table.value = &value;
    table.first = &first;
    table.second = &second;
    table.third = &third;
    table.third_at_points = &third_at_points;
    table.first_at_points = &first_at_points;
    table.second_at_points = &second_at_points;
    if constexpr (has_lanes && !gives_derivatives) table.first_in_lanes = &first_in_lanes;
    table.user_value = &user_value;
    if constexpr (boundary_count() > 0) {
      table.boundary_conditions = boundary_count();
      table.boundary = &boundary;
      table.boundary_first = &boundary_first;
      table.integral_conditions = integral_count();
    }
    if constexpr (has_dimensions) {
      table.field_dimensions = field_dimensions.data();
      table.jump_dimensions = jump_dimensions.data();
    }
    table.sliding_modes = static_cast<std::int32_t>(modes.size());
    if constexpr (!modes.empty()) table.sliding = modes.data();
    table.chatter_modes = static_cast<std::int32_t>(chatter.size());
    if constexpr (!chatter.empty()) table.chatter = chatter.data();
    if constexpr (has_successors) table.successors = &successors;
    if constexpr (requires { Problem::user_values; }) table.user_values = Problem::user_values;

#define TCHAT_OPTIONAL_ARRAY(MEMBER, COUNT)                                         \
  if constexpr (requires { Problem::MEMBER; }) {                                    \
    static_assert(std::size(Problem::MEMBER) == Problem::COUNT,                     \
                  "tchat: `" #MEMBER "` needs as many entries as " #COUNT " says"); \
    table.MEMBER = std::data(Problem::MEMBER);                                      \
  }
    TCHAT_OPTIONAL_ARRAY(state_names, dimension)
    TCHAT_OPTIONAL_ARRAY(parameter_names, parameters)
    TCHAT_OPTIONAL_ARRAY(field_names, fields)
    TCHAT_OPTIONAL_ARRAY(event_names, events)
    TCHAT_OPTIONAL_ARRAY(jump_names, jumps)
    TCHAT_OPTIONAL_ARRAY(initial_parameters, parameters)
    TCHAT_OPTIONAL_ARRAY(initial_state, dimension)
    TCHAT_OPTIONAL_ARRAY(user_value_names, user_values)
#undef TCHAT_OPTIONAL_ARRAY
    return table;
  }
};

}  // namespace tchat

/// Tells tchat, before it calls anything, what the processor must have for this library.
#ifdef __AVX2__
#define TCHAT_PROBLEM_INSTRUCTIONS \
  extern "C" __attribute__((visibility("default"))) const char tchat_problem_instructions[] = "avx2";
#else
#define TCHAT_PROBLEM_INSTRUCTIONS
#endif

/// Makes the class PROBLEM the problem of this shared library. Once per library, at namespace scope.
#define TCHAT_PROBLEM(PROBLEM)                                                                       \
  TCHAT_PROBLEM_INSTRUCTIONS                                                                         \
  extern "C" __attribute__((visibility("default"))) const tchat_problem* tchat_problem_table(void) { \
    return ::tchat::ProblemTable<PROBLEM>::get(#PROBLEM);                                            \
  }
