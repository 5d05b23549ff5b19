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
/// evaluated it gives NaN or throws; an output left unset is NaN.
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
///     // hand-written first derivatives instead of automatic ones, column-major, zero before the call:
///     void field_derivatives(int i, const double* x, const double* par, double* dfdx, double* dfdp) const;
///     void event_derivatives(int j, const double* x, const double* par, double* dhdx, double* dhdp) const;
///     void jump_derivatives (int k, const double* x, const double* par, double* dgdx, double* dgdp) const;
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <vector>

#include "tchat/dual.hpp"
#include "tchat/problem.h"

namespace tchat {

/// Fills the C table of problem.h from a problem class. The class is default-constructed once and is never changed.
template <class Problem>
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
  static_assert(
      requires { Problem::events; },
      "tchat: the number of event functions is missing, or is not public: write "
      "struct, and in it static constexpr int `events` = ...;");
  static_assert(
      requires { Problem::jumps; },
      "tchat: the number of jump functions is missing, or is not public: write struct, "
      "and in it static constexpr int `jumps` = ...;");

 private:
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
  static_assert(has_field<double> && has_field<Dual<1>>,
                "tchat: `field` must be: template <class T> void field(int i, const T* x, const T* par, T* f) const");
  static_assert(has_event<double> && has_event<Dual<1>>,
                "tchat: `event` must be: template <class T> T event(int j, const T* x, const T* par) const");
  static_assert(has_jump<double> && has_jump<Dual<1>>,
                "tchat: `jump` must be: template <class T> void jump(int k, const T* x, const T* par, T* g) const");

  static constexpr int n = Problem::dimension;
  static constexpr int q = Problem::parameters;
  static_assert(n >= 1, "tchat: `dimension` must be at least 1");
  static_assert(q >= 0 && q <= 60, "tchat: `parameters` must be between 0 and 60");
  static_assert(Problem::fields >= 1, "tchat: `fields`, the number of vector fields, must be at least 1");
  static_assert(Problem::events >= 1, "tchat: `events`, the number of event functions, must be at least 1");
  static_assert(Problem::jumps >= 1, "tchat: `jumps`, the number of jump functions, must be at least 1");

  /// Derivatives carried at once: all states and two parameters where that is cheap, else eight at a time.
  static constexpr int width = n + 2 <= 10 ? n + 2 : 8;

  template <class T>
  using States = std::array<T, static_cast<std::size_t>(n)>;
  template <class T>
  using Parameters = std::array<T, static_cast<std::size_t>(q > 0 ? q : 1)>;

  static const Problem& object(const void* self) { return *static_cast<const Problem*>(self); }

  static constexpr int rows(std::int32_t kind) { return kind == TCHAT_EVENT ? 1 : n; }

  /// F(x, par), rows preset to NaN by the caller. A problem may throw where it cannot be evaluated: the callers are C
  /// code, so the exception ends here as NaN.
  template <class T>
  static void evaluate(const void* self, std::int32_t kind, int index, const T* x, const T* par, T* out) {
    const Problem& problem = object(self);
    try {
      if (kind == TCHAT_FIELD)
        problem.field(index, x, par, out);
      else if (kind == TCHAT_EVENT)
        out[0] = problem.event(index, x, par);
      else
        problem.jump(index, x, par, out);
    } catch (...) {
      std::fill(out, out + rows(kind), T(NAN));
    }
  }

  static void value(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    std::fill(out, out + rows(kind), NAN);
    evaluate<double>(self, kind, index, x, par, out);
  }

  /// Column c of the derivative belongs to state c, or to parameter active[c - n].
  static bool is_problem_parameter(int k) { return k >= 1 && k <= q; }

  static void first(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    const std::int32_t* active, std::int32_t active_count, double* out, double* dx, double* dp) {
    if (hand_written(self, kind, index, x, par, active, active_count, dx, dp)) {
      value(self, kind, index, x, par, out);
      return;
    }
    using T = Dual<width>;
    const int columns = n + active_count;
    for (int begin = 0; begin < columns; begin += width) {
      States<T> xs;
      Parameters<T> ps;
      States<T> ys;
      load(x, par, xs, ps);
      for (int k = 0; k < width && begin + k < columns; ++k)
        if (T* seed = variable(begin + k, active, xs, ps)) seed->derivative[static_cast<std::size_t>(k)] = 1.0;
      preset(ys);
      evaluate<T>(self, kind, index, xs.data(), ps.data(), ys.data());
      const int r = rows(kind);
      for (int k = 0; k < width && begin + k < columns; ++k) {
        const int c = begin + k;
        double* column = c < n ? dx + c * r : dp + (c - n) * r;
        for (int i = 0; i < r; ++i) column[i] = ys[static_cast<std::size_t>(i)].derivative[static_cast<std::size_t>(k)];
      }
      for (int i = 0; i < r; ++i) out[i] = ys[static_cast<std::size_t>(i)].value;
    }
  }

  static void second(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                     const std::int32_t* active, std::int32_t active_count, const double* direction, double* out,
                     double* dx, double* dp) {
    using T = Dual<width, Dual<1>>;
    const int columns = n + active_count;
    for (int begin = 0; begin < columns; begin += width) {
      States<T> xs;
      Parameters<T> ps;
      States<T> ys;
      load(x, par, xs, ps);
      for (int c = 0; c < columns; ++c)
        if (T* moved = variable(c, active, xs, ps)) moved->value.derivative[0] += direction[c];
      for (int k = 0; k < width && begin + k < columns; ++k)
        if (T* seed = variable(begin + k, active, xs, ps)) seed->derivative[static_cast<std::size_t>(k)] = 1.0;
      preset(ys);
      evaluate<T>(self, kind, index, xs.data(), ps.data(), ys.data());
      const int r = rows(kind);
      for (int k = 0; k < width && begin + k < columns; ++k) {
        const int c = begin + k;
        double* column = c < n ? dx + c * r : dp + (c - n) * r;
        for (int i = 0; i < r; ++i)
          column[i] = ys[static_cast<std::size_t>(i)].derivative[static_cast<std::size_t>(k)].derivative[0];
      }
      for (int i = 0; i < r; ++i) out[i] = ys[static_cast<std::size_t>(i)].value.derivative[0];
    }
  }

  template <class T>
  static void load(const double* x, const double* par, States<T>& xs, Parameters<T>& ps) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) xs[i] = T(x[i]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(q); ++i) ps[i] = T(par[i]);
  }

  template <class T>
  static void preset(States<T>& ys) {
    for (T& y : ys) y = T(NAN);
  }

  /// The variable that column c differentiates by; null for a PAR that the problem does not own.
  template <class T>
  static T* variable(int c, const std::int32_t* active, States<T>& xs, Parameters<T>& ps) {
    if (c < n) return &xs[static_cast<std::size_t>(c)];
    const int k = active[c - n];
    return is_problem_parameter(k) ? &ps[static_cast<std::size_t>(k - 1)] : nullptr;
  }

  static bool hand_written(const void* self, std::int32_t kind, int index, const double* x, const double* par,
                           const std::int32_t* active, std::int32_t active_count, double* dx, double* dp) {
    std::array<double, static_cast<std::size_t>(n * (q > 0 ? q : 1))> all{};
    const Problem& problem = object(self);
    bool given = false;
    std::fill(dx, dx + rows(kind) * n, 0.0);
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
    return true;
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
      IndexVectors next;
      if constexpr (successors_of_state)
        next = object(self).successors(last, x, par);
      else if constexpr (successors_of_x)
        next = object(self).successors(last, x);
      else if constexpr (successors_alone)
        next = object(self).successors(last);
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

  static void user_value(const void* self, const double* x, const double* par, double* out) {
    if constexpr (requires { Problem::user_values; }) object(self).user_value(x, par, out);
  }

  static tchat_problem make(const char* name, const Problem& problem) {
    tchat_problem table{};
    table.abi_version = TCHAT_PROBLEM_ABI;
    table.struct_size = sizeof(tchat_problem);
    table.dimension = n;
    table.parameters = q;
    table.fields = Problem::fields;
    table.events = Problem::events;
    table.jumps = Problem::jumps;
    table.derivative_order = 2;
    table.name = name;
    table.self = &problem;
    table.value = &value;
    table.first = &first;
    table.second = &second;
    table.user_value = &user_value;
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

/// Makes the class PROBLEM the problem of this shared library. Once per library, at namespace scope.
#define TCHAT_PROBLEM(PROBLEM)                                                                       \
  extern "C" __attribute__((visibility("default"))) const tchat_problem* tchat_problem_table(void) { \
    return ::tchat::ProblemTable<PROBLEM>::get(#PROBLEM);                                            \
  }
