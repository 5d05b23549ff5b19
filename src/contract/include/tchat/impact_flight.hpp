/// How impacts follow each other: directional derivatives of a problem's functions at an event surface, and flights
/// from one impact to the next. Included by tchat/chatter.hpp.
///
/// A flight has the time t as an unknown. In place of h = 0 at its end, with its other root t = 0, stands
/// h / t = h_0 / t + sum_i b_i v(X_i) = 0 over the Gauss points, v = h_x f, where h_0 = 0 after an impact. Newton's
/// method solves it for numbers; for dual numbers one step follows for each order of derivatives.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "tchat/dual.hpp"
#include "tchat/gauss_flight.hpp"
#include "tchat/problem.h"
#include "tchat/sliding.hpp"

namespace tchat {

/// How many times derivatives are nested in a kind of numbers.
template <class T>
inline constexpr int derivative_depth = 0;
template <int N, class B>
inline constexpr int derivative_depth<Dual<N, B>> = 1 + derivative_depth<B>;

/// The value in the first lane: what is decided by it must not matter in others, or be asked for with plain() as well.
inline double first_lane(double a) { return a; }
inline double first_lane(const Lanes& a) { return a.lane(0); }
template <int N, class B>
double first_lane(const Dual<N, B>& a) {
  return first_lane(a.value);
}

/// Gives a number another value; derivatives stay as they are.
inline void set_number(double& a, double value) { a = value; }
inline void set_number(Lanes& a, double value) { a = value; }
template <int N, class B>
void set_number(Dual<N, B>& a, double value) {
  set_number(a.value, value);
}

/// For the impacts of a chatter mode. All functions are for numbers T, double or dual.
template <class Problem>
class ImpactFlights {
 public:
  static constexpr auto n = static_cast<std::size_t>(Problem::dimension);
  static constexpr auto q = static_cast<std::size_t>(Problem::parameters);
  template <class T>
  using State = std::array<T, n>;
  template <class T>
  using Parameters = std::array<T, q + 1>;

  ImpactFlights(const Problem& problem, const tchat_chatter& mode) : problem_(problem), mode_(mode) {}

  /// Numbers of a point, without derivatives.
  struct Point {
    State<double> x;
    Parameters<double> par{};
  };
  template <class T>
  static Point numbers(const T* x, const T* par) {
    Point at;
    for (std::size_t i = 0; i < n; ++i) at.x[i] = plain(x[i]);
    for (std::size_t i = 0; i < q; ++i) at.par[i] = plain(par[i]);
    return at;
  }

  template <class T>
  State<T> field(const T* x, const T* par) const {
    State<T> f;
    f.fill(T(NAN));
    problem_.field(mode_.field, x, par, f.data());
    return f;
  }
  template <class T>
  State<T> jump(const T* x, const T* par) const {
    State<T> after;
    after.fill(T(NAN));
    problem_.jump(mode_.impact, x, par, after.data());
    return after;
  }

  // Functions that are differentiated: h, v and a.
  struct Height {
    template <class T>
    T operator()(const ImpactFlights& self, const T* x, const T* par) const {
      return self.problem_.event(self.mode_.event, x, par);
    }
  };
  struct Rate {
    template <class T>
    T operator()(const ImpactFlights& self, const T* x, const T* par) const {
      return self.rate(x, par);
    }
  };
  struct Acceleration {
    template <class T>
    T operator()(const ImpactFlights& self, const T* x, const T* par) const {
      return self.acceleration(x, par);
    }
  };

  /// A point that moves in directions, and parameters that do not.
  template <int directions, class T>
  struct Moving {
    using Number = Dual<directions, T>;
    State<Number> state;
    Parameters<Number> parameters;
    Moving(const T* x, const T* par) {
      for (std::size_t i = 0; i < n; ++i) state[i].value = x[i];
      for (std::size_t i = 0; i < q; ++i) parameters[i].value = par[i];
    }
    const Number* x() const { return state.data(); }
    const Number* par() const { return parameters.data(); }
  };

  /// The derivative of a function in a direction.
  template <class T, class Function>
  T along(const T* direction, const T* x, const T* par, const Function& function) const {
    Moving<1, T> at(x, par);
    for (std::size_t i = 0; i < n; ++i) at.state[i].derivative[0] = direction[i];
    return function(*this, at.x(), at.par()).derivative[0];
  }
  template <class T>
  State<T> along_jump(const T* direction, const T* x, const T* par) const {
    Moving<1, T> at(x, par);
    for (std::size_t i = 0; i < n; ++i) at.state[i].derivative[0] = direction[i];
    const auto after = jump(at.x(), at.par());
    State<T> result;
    for (std::size_t i = 0; i < n; ++i) result[i] = after[i].derivative[0];
    return result;
  }

  template <class T>
  T rate(const T* x, const T* par) const {
    return along<T>(field(x, par).data(), x, par, Height{});
  }
  template <class T>
  T acceleration(const T* x, const T* par) const {
    return along<T>(field(x, par).data(), x, par, Rate{});
  }

  template <class T>
  T height(const T* x, const T* par) const {
    return problem_.event(mode_.event, x, par);
  }

  /// Three states by which h, v and a can be set, those with the largest determinant whose terms do not cancel, and the
  /// inverse of the derivatives of h, v and a by them. They may have been chosen before.
  struct ReleaseMatrix {
    std::array<std::size_t, 3> states;
    std::array<std::array<double, 3>, 3> inverse;
  };
  ReleaseMatrix release_matrix(const double* x, const double* par,
                               const std::array<std::size_t, 3>* chosen = nullptr) const {
    Moving<static_cast<int>(n), double> at(x, par);
    for (std::size_t i = 0; i < n; ++i) at.state[i].derivative[i] = 1.0;
    const std::array<State<double>, 3> by = {Height{}(*this, at.x(), at.par()).derivative,
                                             Rate{}(*this, at.x(), at.par()).derivative,
                                             Acceleration{}(*this, at.x(), at.par()).derivative};
    ReleaseMatrix best{};
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        for (std::size_t k = 0; k < j; ++k) {
          const std::array<std::size_t, 3> states{i, j, k};
          if (chosen == nullptr || *chosen == states) take_if_larger(by, states, largest, best);
        }
    if (!(largest > 0.0)) throw NoValue("no three states set the height, its rate and its acceleration");
    return best;
  }

  /// d, with h_x d = 0 and v_x d = 1.
  template <class T>
  State<T> direction(const T* x, const T* par) const {
    const Pair pair = pair_at(x, par);
    Moving<2, T> at(x, par);
    for (std::size_t k = 0; k < 2; ++k) at.state[pair[k]].derivative[k] = T(1.0);
    const auto h = Height{}(*this, at.x(), at.par()).derivative;
    const auto v = Rate{}(*this, at.x(), at.par()).derivative;
    const T determinant = h[0] * v[1] - h[1] * v[0];
    State<T> d;
    d.fill(T(0.0));
    d[pair[0]] = -h[1] / determinant;
    d[pair[1]] = h[0] / determinant;
    return d;
  }

  template <class T>
  T restitution(const T* x, const T* par) const {
    const State<T> d = direction(x, par);
    const State<T> after = along_jump(d.data(), x, par);
    return -along<T>(after.data(), x, par, Rate{});
  }

  /// From y to before the next impact, x; `time` goes on. False where there is none.
  template <class T>
  bool fly(const State<T>& y, const T* par, State<T>& x, T& time) const {
    const std::optional<Solved> solved = resolved_flight(numbers(y.data(), par), 0.0);
    if (!solved) return false;
    Flight<T> flight(solved->flight.begin(), solved->flight.end());
    if constexpr (derivative_depth < T >> 0) {
      SmallMatrix matrix(units_of(solved->flight));
      if (!linearise(solved->rule, numbers(y.data(), par).par.data(), solved->flight, 0.0, matrix)) return false;
      for (int k = 0; k < derivative_depth<T>; ++k) {
        Flight<T> step = residual(solved->rule, y, par, flight);
        matrix.solve(step);
        for (std::size_t i = 0; i < flight.size(); ++i) {
          flight[i] -= step[i];
          set_number(flight[i], solved->flight[i]);  // whoever asks for derivatives gets the same value
        }
      }
    }
    x = y;
    for (std::size_t j = 0; j < solved->rule.stages(); ++j) {
      const State<T> f = field(&flight[j * n], par);
      for (std::size_t k = 0; k < n; ++k) x[k] += solved->rule.b(j) * flight.back() * f[k];
    }
    time += flight.back();
    return true;
  }

  /// Before the impact that the motion comes to from x, above the surface; nothing where it leads away.
  std::optional<State<double>> next_impact(const double* x, const double* par) const {
    const Point from = numbers(x, par);
    const std::optional<Solved> solved = resolved_flight(from, height(x, par));
    if (!solved) return std::nullopt;
    State<double> end = from.x;
    for (std::size_t j = 0; j < solved->rule.stages(); ++j) {
      const State<double> f = field(&solved->flight[j * n], from.par.data());
      for (std::size_t k = 0; k < n; ++k) end[k] += solved->rule.b(j) * solved->flight.back() * f[k];
    }
    return end;
  }

 private:
  using Pair = std::array<std::size_t, 2>;

  /// Two states by which h and v can be set: those with the largest determinant whose terms do not cancel. Which they
  /// are makes no difference on C.
  template <class T>
  Pair pair_at(const T* x, const T* par) const {
    State<double> at;
    Parameters<double> with{};
    for (std::size_t i = 0; i < n; ++i) at[i] = first_lane(x[i]);
    for (std::size_t i = 0; i < q; ++i) with[i] = first_lane(par[i]);
    Moving<static_cast<int>(n), double> moving(at.data(), with.data());
    for (std::size_t i = 0; i < n; ++i) moving.state[i].derivative[i] = 1.0;
    const auto h = Height{}(*this, moving.x(), moving.par()).derivative;
    const auto v = Rate{}(*this, moving.x(), moving.par()).derivative;
    Pair best{0, n - 1};
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const double determinant = h[i] * v[j] - h[j] * v[i];
        const double terms = std::fabs(h[i] * v[j]) + std::fabs(h[j] * v[i]);
        if (determinant > 0.5 * terms && determinant > largest) largest = determinant, best = {i, j};
      }
    return best;
  }

  // A flight: the states X_i at the stages of a rule, one after the other, and t.
  template <class T>
  using Flight = std::vector<T>;

  /// What is left of X_i - y - t sum_j a_ij f(X_j) and of sum_i b_i v(X_i).
  template <class T>
  Flight<T> residual(const GaussRule& rule, const State<T>& y, const T* par, const Flight<T>& flight) const {
    const std::size_t stages = rule.stages();
    std::vector<State<T>> f(stages);
    for (std::size_t j = 0; j < stages; ++j) f[j] = field(&flight[j * n], par);
    Flight<T> rest(flight.size(), T(0.0));
    for (std::size_t i = 0; i < stages; ++i) {
      rest.back() += rule.b(i) * rate(&flight[i * n], par);
      for (std::size_t k = 0; k < n; ++k) {
        T sum(0.0);
        for (std::size_t j = 0; j < stages && rule.a(i, j) != 0.0; ++j) sum += rule.a(i, j) * f[j][k];
        rest[i * n + k] = flight[i * n + k] - y[k] - flight.back() * sum;
      }
    }
    return rest;
  }

  bool linearise(const GaussRule& rule, const double* par, const Flight<double>& flight, double height,
                 SmallMatrix& matrix) const {
    const std::size_t stages = rule.stages();
    matrix(stages * n, stages * n) -= height / (flight.back() * flight.back());
    for (std::size_t j = 0; j < stages; ++j) {
      Moving<static_cast<int>(n), double> at(&flight[j * n], par);
      for (std::size_t k = 0; k < n; ++k) at.state[k].derivative[k] = 1.0;
      const auto f = field(at.x(), at.par());
      const auto v = rate(at.x(), at.par());
      for (std::size_t i = 0; i < stages; ++i)
        for (std::size_t k = 0; k < n && rule.a(i, j) != 0.0; ++k) {
          matrix(i * n + k, stages * n) -= rule.a(i, j) * f[k].value;
          for (std::size_t c = 0; c < n; ++c)
            matrix(i * n + k, j * n + c) -= flight.back() * rule.a(i, j) * f[k].derivative[c];
        }
      for (std::size_t c = 0; c < n; ++c) matrix(stages * n, j * n + c) = rule.b(j) * v.derivative[c];
    }
    for (std::size_t k = 0; k < stages * n; ++k) matrix(k, k) += 1.0;
    return matrix.factor();
  }

  /// Of a flight: the sizes of its states and its time.
  std::vector<double> units_of(const Flight<double>& flight) const {
    std::vector<double> units(flight.size(), 0.0);
    for (std::size_t i = 0; i + 1 < flight.size(); ++i) units[i % n] = std::fmax(units[i % n], std::fabs(flight[i]));
    for (std::size_t i = 0; i + 1 < flight.size(); ++i) units[i] = units[i % n] > 0.0 ? units[i % n] : 1.0;
    units.back() = std::fabs(flight.back());
    return units;
  }

  /// A flight for numbers.
  struct Solved {
    GaussRule rule;
    Flight<double> flight;
  };

  /// By the classical Runge-Kutta method from stage to stage.
  Flight<double> followed(const GaussRule& rule, const Point& from, double time) const {
    Flight<double> flight(rule.stages() * n + 1);
    flight.back() = time;
    State<double> x = from.x;
    for (std::size_t j = 0; j < rule.stages(); ++j) {
      const double step = (rule.c(j) - (j > 0 ? rule.c(j - 1) : 0.0)) * time;
      State<double> slope{}, at = x, sum = x;
      for (const auto& [share, weight] : {std::pair{0.0, 1.0}, {0.5, 2.0}, {0.5, 2.0}, {1.0, 1.0}}) {
        for (std::size_t k = 0; k < n; ++k) at[k] = x[k] + share * step * slope[k];
        slope = field(at.data(), from.par.data());
        for (std::size_t k = 0; k < n; ++k) sum[k] += weight / 6.0 * step * slope[k];
      }
      x = sum;
      for (std::size_t k = 0; k < n; ++k) flight[j * n + k] = x[k];
    }
    return flight;
  }

  /// One that ends about this time after `from`; nothing where Newton's method finds none.
  std::optional<Solved> solve(const GaussRule& rule, const Point& from, double height, double about) const {
    constexpr int most_iterations = 20;
    constexpr double solved = 1e-12;   // the next move is its square
    constexpr int enough = 5;          // iterations, after which moves that do not get smaller are rounding,
    constexpr double rounding = 1e-3;  // at most this: near the limit v is what is left of far larger rates
    Flight<double> flight = followed(rule, from, about);
    double last = HUGE_VAL;
    for (int k = 0; k < most_iterations; ++k) {
      SmallMatrix matrix(units_of(flight));
      if (!linearise(rule, from.par.data(), flight, height, matrix)) return std::nullopt;
      Flight<double> step = residual(rule, from.x, from.par.data(), flight);
      step.back() += height / flight.back();
      matrix.solve(step);
      for (std::size_t i = 0; i < flight.size(); ++i) flight[i] -= step[i];
      const double move = std::fabs(step.back() / flight.back());
      if (move <= solved || (k >= enough && move <= rounding && move >= 0.5 * last))
        return flight.back() > 0.0 ? std::optional(Solved{rule, flight}) : std::nullopt;
      last = move;
    }
    return std::nullopt;
  }

  /// Is the field along a flight the polynomial that the rule makes of it?
  bool is_resolved(const Solved& solved, const double* par) const {
    constexpr double accurate = 1e-6;  // squared, the error
    constexpr double rounding = 1e-12;
    std::vector<State<double>> f;
    for (std::size_t j = 0; j < solved.rule.stages(); ++j) f.push_back(field(&solved.flight[j * n], par));
    for (std::size_t k = 0; k < n; ++k) {
      double size = 0.0, change = 0.0;
      for (std::size_t j = 0; j < solved.rule.stages(); ++j) {
        size = std::fmax(size, std::fabs(solved.flight[j * n + k]));
        change = std::fmax(change, std::fabs(f[j][k]) * solved.flight.back());
      }
      const bool stays = change <= rounding * size;
      if (!stays && !(solved.rule.last_share([&](std::size_t j) { return f[j][k]; }) <= accurate)) return false;
    }
    return true;
  }

  /// The time of the first stage below the surface, which the flight has passed before it ends; nothing where it ends
  /// with the next impact. By the rule for h / t, where nothing cancels.
  std::optional<double> time_below(const Solved& solved, const double* par, double height) const {
    const std::size_t stages = solved.rule.stages();
    for (std::size_t i = 0; i < stages; ++i) {
      double height_by_time = height / solved.flight.back();
      for (std::size_t j = 0; j < stages && solved.rule.a(i, j) != 0.0; ++j)
        height_by_time += solved.rule.a(i, j) * rate(&solved.flight[j * n], par);
      if (!(height_by_time > 0.0)) return solved.rule.c(i) * solved.flight.back();
    }
    return std::nullopt;
  }

  /// The flight to the next impact, in the fewest intervals that resolve it; nothing where it is longer than that.
  std::optional<Solved> resolved_flight(const Point& from, double height) const {
    constexpr std::size_t most_intervals = 8;
    constexpr int most_tries = 4;
    const double a = acceleration(from.x.data(), from.par.data());
    if (!(a < 0.0)) return std::nullopt;
    const double v = rate(from.x.data(), from.par.data());
    double about = -(v + std::sqrt(v * v - 2.0 * a * height)) / a;
    int tries = 0;
    for (std::size_t intervals = 1; intervals <= most_intervals;) {
      std::optional<Solved> solved = solve(GaussRule(intervals), from, height, about);
      if (!solved) return std::nullopt;
      if (const auto earlier = time_below(*solved, from.par.data(), height)) {
        if (++tries > most_tries) return std::nullopt;
        about = *earlier;
        continue;
      }
      if (is_resolved(*solved, from.par.data())) return solved;
      about = solved->flight.back();
      intervals *= 2;
    }
    return std::nullopt;
  }

  static void take_if_larger(const std::array<State<double>, 3>& by, const std::array<std::size_t, 3>& states,
                             double& largest, ReleaseMatrix& best) {
    std::array<std::array<double, 3>, 3> inverse{};  // the cofactors first
    double determinant = 0.0, terms = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const auto entry = [&](std::size_t row, std::size_t column) { return by[row % 3][states[column % 3]]; };
        const double one = entry(j + 1, i + 1) * entry(j + 2, i + 2), other = entry(j + 1, i + 2) * entry(j + 2, i + 1);
        inverse[i][j] = one - other;
        if (i > 0) continue;
        determinant += entry(j, 0) * (one - other);
        terms += std::fabs(entry(j, 0)) * (std::fabs(one) + std::fabs(other));
      }
    if (!(std::fabs(determinant) > largest && std::fabs(determinant) > 0.1 * terms)) return;
    for (auto& row : inverse)
      for (double& value : row) value /= determinant;
    largest = std::fabs(determinant);
    best = {states, inverse};
  }

  const Problem& problem_;
  tchat_chatter mode_;
};

}  // namespace tchat
