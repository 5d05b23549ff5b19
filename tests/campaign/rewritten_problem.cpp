/// A problem in other words: its states, parameters, time, user values and event functions in other units, its states
/// and parameters in another order, and perhaps one more state, on which nothing depends.
///
/// rewriting.py writes the file that includes this one. It defines REWRITTEN_SOURCE, the source of the problem, and in
/// the namespace `rewriting` x_i = state_units[i] y_i, p_k = parameter_units[k] q_k, t = time_unit t', the factors of
/// event functions, and for each new state or parameter the number (from 0) of the one that it is; idle: -1.
#include <array>
#include <cmath>
#include <cstddef>
#include <tchat/problem.hpp>
#include <vector>

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) using OriginalProblem = PROBLEM;
#include REWRITTEN_SOURCE
#pragma pop_macro("TCHAT_PROBLEM")

/// Members that are as before, if the problem has them.
#define FORWARDED(MEMBER)                                   \
  template <class Original>                                 \
  struct With_##MEMBER {};                                  \
  template <class Original>                                 \
  requires requires { Original::MEMBER; }                   \
  struct With_##MEMBER<Original> {                          \
    static constexpr const auto& MEMBER = Original::MEMBER; \
  };
FORWARDED(events)
FORWARDED(jumps)
FORWARDED(sliding)
FORWARDED(chatter)
FORWARDED(integral_conditions)
FORWARDED(user_values)
FORWARDED(user_value_names)
FORWARDED(field_names)
FORWARDED(event_names)
FORWARDED(jump_names)
#undef FORWARDED

/// One more boundary condition says where the idle state starts.
template <class Original, bool has_idle>
struct WithBoundary {};
template <class Original, bool has_idle>
requires requires { Original::boundary_conditions; }
struct WithBoundary<Original, has_idle> {
  static constexpr int boundary_conditions = Original::boundary_conditions + (has_idle ? 1 : 0);
};

template <class Original>
struct Rewritten : With_events<Original>,
                   With_jumps<Original>,
                   With_sliding<Original>,
                   With_chatter<Original>,
                   With_integral_conditions<Original>,
                   With_user_values<Original>,
                   With_user_value_names<Original>,
                   With_field_names<Original>,
                   With_event_names<Original>,
                   With_jump_names<Original>,
                   WithBoundary<Original, (std::size(rewriting::state_order) > Original::dimension)> {
  static constexpr int n = Original::dimension, dimension = std::size(rewriting::state_order);
  static constexpr int parameters = Original::parameters, fields = Original::fields;
  static_assert(dimension == n || dimension == n + 1);
  static_assert(std::size(rewriting::state_units) == n && std::size(rewriting::parameter_order) == parameters &&
                std::size(rewriting::parameter_units) == parameters);
  static_assert(
      !requires { Original::dimension_of(1); }, "modes of different dimension: their first states cannot be permuted");

  static constexpr auto state_names = [] {
    std::array<const char*, dimension> names{};
    for (int a = 0; a < dimension; ++a)
      names[a] = rewriting::state_order[a] < 0 ? "idle" : Original::state_names[rewriting::state_order[a]];
    return names;
  }();
  static constexpr auto parameter_names = [] {
    std::array<const char*, parameters> names{};
    for (int k = 0; k < parameters; ++k) names[k] = Original::parameter_names[rewriting::parameter_order[k]];
    return names;
  }();
  static constexpr auto initial_parameters = [] {
    std::array<double, parameters> values{};
    for (int k = 0; k < parameters; ++k) {
      const int o = rewriting::parameter_order[k];
      values[k] = Original::initial_parameters[o] / rewriting::parameter_units[o];
    }
    return values;
  }();
  static constexpr auto initial_state = [] {
    std::array<double, dimension> values{};
    for (int a = 0; a < dimension; ++a) {
      const int o = rewriting::state_order[a];
      if (o < 0)
        values[a] = rewriting::idle;
      else if constexpr (requires { Original::initial_state; })
        values[a] = Original::initial_state[o] / rewriting::state_units[o];
    }
    return values;
  }();

  Original original;

  template <class T>
  static std::array<T, n> states_of(const T* y) {
    std::array<T, n> x;
    for (int a = 0; a < dimension; ++a)
      if (const int o = rewriting::state_order[a]; o >= 0) x[o] = rewriting::state_units[o] * y[a];
    return x;
  }
  template <class T>
  static std::array<T, parameters> parameters_of(const T* q) {
    std::array<T, parameters> p;
    for (int k = 0; k < parameters; ++k) {
      const int o = rewriting::parameter_order[k];
      p[o] = rewriting::parameter_units[o] * q[k];
    }
    return p;
  }
  template <class T>
  static std::array<T, n> unset() {
    std::array<T, n> values;
    values.fill(T(NAN));
    return values;
  }

  template <class T>
  void field(int i, const T* y, const T* q, T* f) const {
    const auto x = states_of(y);
    const auto p = parameters_of(q);
    auto rates = unset<T>();
    original.field(i, x.data(), p.data(), rates.data());
    for (int a = 0; a < dimension; ++a) {
      const int o = rewriting::state_order[a];
      f[a] = o < 0 ? T(rewriting::time_unit * (rewriting::idle - y[a]))
                   : T(rewriting::time_unit / rewriting::state_units[o] * rates[o]);
    }
  }

  template <class T>
  T event(int j, const T* y, const T* q) const requires requires(const Original& o, const T* v) {
    o.event(1, v, v);
  }
  { return rewriting::event_factors[j - 1] * original.event(j, states_of(y).data(), parameters_of(q).data()); }

  template <class T>
  void jump(int k, const T* y, const T* q, T* g) const requires requires(const Original& o, const T* v, T* w) {
    o.jump(1, v, v, w);
  }
  {
    auto after = unset<T>();
    original.jump(k, states_of(y).data(), parameters_of(q).data(), after.data());
    for (int a = 0; a < dimension; ++a) {
      const int o = rewriting::state_order[a];
      g[a] = o < 0 ? y[a] : T(after[o] / rewriting::state_units[o]);
    }
  }

  template <class T>
  void boundary(const tchat::Ends<T>& orbit, const T* q, T* b) const requires
      requires(const Original& o, const T* v, T* w) {
    o.boundary(orbit, v, w);
  }
  {
    std::vector<T> starts, ends, durations;
    for (int s = 1; s <= orbit.segments(); ++s) {
      const auto first = states_of(orbit.start(s)), last = states_of(orbit.end(s));
      starts.insert(starts.end(), first.begin(), first.end());
      ends.insert(ends.end(), last.begin(), last.end());
      durations.push_back(T(rewriting::time_unit * orbit.duration(s)));
    }
    original.boundary(tchat::Ends<T>(orbit.segments(), n, starts.data(), ends.data(), durations.data()),
                      parameters_of(q).data(), b);
    for (int a = 0; a < dimension; ++a)
      if (rewriting::state_order[a] < 0) b[Original::boundary_conditions] = orbit.start(1)[a] - rewriting::idle;
  }

  template <class T>
  void integrand(int s, const T* y, const T* q, T* w) const requires requires(const Original& o) {
    o.integrand(s, y, q, w);
  }
  { original.integrand(s, states_of(y).data(), parameters_of(q).data(), w); }

  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* y,
                                             const double* q) const requires requires {
    &Original::successors;
  }
  {
    const auto x = states_of(y);
    const auto p = parameters_of(q);
    if constexpr (requires { original.successors(from, x.data(), p.data()); })
      return original.successors(from, x.data(), p.data());
    else if constexpr (requires { original.successors(from, x.data()); })
      return original.successors(from, x.data());
    else
      return original.successors(from);
  }

  void user_value(const double* y, const double* q, double* out) const requires requires { &Original::user_value; }
  {
    original.user_value(states_of(y).data(), parameters_of(q).data(), out);
    for (int k = 0; k < Original::user_values; ++k) out[k] /= rewriting::value_units[k];
  }
};

using RewrittenProblem = Rewritten<OriginalProblem>;
TCHAT_PROBLEM(RewrittenProblem)
