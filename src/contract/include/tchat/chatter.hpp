/// Complete chatter, infinitely many impacts in finite time, as one jump; for problem authors: included by
/// tchat/problem.hpp.
///
/// Impacts g at the surface h = 0 of an event function, in a field f that presses the orbit against it, can accumulate
/// at C = {h = 0, v = 0}, v = h_x f, where the orbit rests on the surface: where a = v_x f < 0, where g leaves C as it
/// is, and where the restitution r = -v_x g_x d is between 0 and 1, d any direction with h_x d = 0 and v_x d = 1. A
/// class that says which impacts may,
///
///     static constexpr tchat::Chatter chatter{.field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2,
///                                             .limit = 3, .margin = 3, .leave = 4};
///
/// has more functions: as field 2 the motion in contact, as event function 2 -a, where contact ends, as jump 3 the
/// limit of all impacts from one on, and as event function 3 a margin, which is zero where there is no limit any more.
/// With `.time = 4` event function 4 is the time that these impacts take, for monitors.
/// Jump 4, with which field 1 goes on after contact, puts back on C what integration has left beside it. `fields`,
/// `events` and `jumps` count them; field(), event() and jump() are then called with the other ones only.
///
/// In contact the field is f less what the kicks of impacts take away,
///
///     f - a b,      b = k / (v_x k),      k = g_x d - d,      so that h and v stay zero on C.
///
/// The limit. States before impacts that follow each other lie on a smooth curve x = X(v): C consists of fixed points
/// of the map from one to the next, whose other multiplier is r (A. B. Nordmark, P. T. Piiroinen, Nonlinear Dynamics 58
/// (2009) 85-106). The polynomial through impacts 0, s, 2 s, ..., 8 s, with r^s <= 1/2, is extrapolated to v = 0, and
/// the time with it. From there the motion in contact is followed back by that time: the jump itself lasts no time, and
/// where contact begins the last impacts are still to come. Periods, phases and what follows are those of all impacts.
/// Derivatives are those of this formula, which is computed with dual numbers, the places v of the nodes included.
///
/// Where h''' = -j is constant, chatter is complete if u = r |v| j / a^2 falls from impact to impact, and it is not
/// where u is above c(r): release comes first. Impacts below 0.3 c are near their limit; those before them belong to
/// the jump as well. The margin is c - u, extrapolated over some impacts to a = 0.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "tchat/dual.hpp"
#include "tchat/impact_flight.hpp"
#include "tchat/problem.h"
#include "tchat/sliding.hpp"

namespace tchat {

/// Which functions chatter is made of, `field`, `event` and `impact`, and which it adds.
using Chatter = ::tchat_chatter;

/// The chatter modes of a problem class, as an array.
template <class Problem>
constexpr auto chatter_modes_of() {
  if constexpr (requires { Problem::chatter; }) {
    if constexpr (std::is_array_v<std::remove_cvref_t<decltype(Problem::chatter)>>)
      return std::to_array(Problem::chatter);
    else
      return std::array<Chatter, 1>{Problem::chatter};
  } else {
    return std::array<Chatter, 0>{};
  }
}

/// What is wrong with the numbers of chatter modes.
enum class ChatterFault { none, field_range, event_range, jump_range, made_of_itself };

/// The first fault of a range of modes in a problem of so many functions.
template <class Modes>
constexpr ChatterFault chatter_fault(const Modes& modes, int fields, int events, int jumps) {
  const auto outside = [](int number, int count) { return number < 1 || number > count; };
  for (const Chatter& mode : modes) {
    if (outside(mode.field, fields) || outside(mode.contact, fields)) return ChatterFault::field_range;
    if (outside(mode.event, events) || outside(mode.release, events) || outside(mode.margin, events) ||
        (mode.time != 0 && outside(mode.time, events)))
      return ChatterFault::event_range;
    if (outside(mode.impact, jumps) || outside(mode.limit, jumps) || outside(mode.leave, jumps))
      return ChatterFault::jump_range;
  }
  for (const Chatter& a : modes)
    for (const Chatter& b : modes)
      if (a.field == b.contact || a.event == b.release || a.event == b.margin || a.event == b.time ||
          a.impact == b.limit || a.impact == b.leave || a.limit == b.leave)
        return ChatterFault::made_of_itself;
  return ChatterFault::none;
}

/// The functions that chatter makes, for a problem class. All are for numbers T, double or dual.
template <class Problem>
class ChatterFunctions : ImpactFlights<Problem> {
  using Base = ImpactFlights<Problem>;
  using Base::n;
  template <class T>
  using State = typename Base::template State<T>;
  using typename Base::Acceleration;
  using typename Base::Point;
  using typename Base::Rate;

 public:
  ChatterFunctions(const Problem& problem, const Chatter& mode) : Base(problem, mode) {}

  /// The field in contact.
  template <class T>
  void contact(const T* x, const T* par, T* out) const {
    const State<T> f = field(x, par);
    const T a = this->template along<T>(f.data(), x, par, Rate{});
    const State<T> d = direction(x, par);
    State<T> kick = this->along_jump(d.data(), x, par);
    for (std::size_t i = 0; i < n; ++i) kick[i] -= d[i];
    const T change = this->template along<T>(kick.data(), x, par, Rate{});
    for (std::size_t i = 0; i < n; ++i) out[i] = f[i] - a / change * kick[i];
  }

  /// -a.
  template <class T>
  T release(const T* x, const T* par) const {
    return -acceleration(x, par);
  }

  /// The state next to x with h = v = a = 0, which differs from it in three states: by Newton's method for numbers;
  /// then one step for each order of derivatives, with the matrix at that state.
  template <class T>
  void leave(const T* x, const T* par, T* out) const {
    const Point from = numbers(x, par);
    Point at = from;
    auto matrix = this->release_matrix(at.x.data(), at.par.data());
    constexpr int most = 16;
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    double change = HUGE_VAL;  // as a share of the states
    for (int k = 0; k < most && change > 4.0 * epsilon; ++k) {
      if (k > 0) matrix = this->release_matrix(at.x.data(), at.par.data(), &matrix.states);
      change = correct(matrix, at.par.data(), at.x);
    }
    if (!(change * change <= epsilon)) throw NoValue("no state is near in which contact ends");
    State<T> there;
    for (std::size_t i = 0; i < n; ++i) there[i] = x[i] + (at.x[i] - from.x[i]);
    for (int k = 0; k < derivative_depth<T>; ++k) correct(matrix, par, there);
    for (std::size_t i = 0; i < n; ++i) out[i] = there[i];
  }

  /// Where all impacts from the one at x on lead to, and how long they take. Where they do not accumulate, a
  /// continuation of that past the border.
  template <class T>
  struct Rest {
    State<T> state;
    T time;
  };
  template <class T>
  Rest<T> rest(const T* x, const T* par) const {
    return extrapolated(nodes_of(impacts_from(x, par)));
  }

  /// Where contact would have been at the time of the impact at x.
  template <class T>
  void limit(const T* x, const T* par, T* out) const {
    const Rest<T> last = rest(x, par);
    const Point from = numbers(x, par);
    State<double> sizes = field(from.x.data(), from.par.data());  // what is zero in contact has that of the impacts
    for (std::size_t i = 0; i < n; ++i)
      sizes[i] = std::fabs(sizes[i] * plain(last.time)) + std::fabs(from.x[i]) + std::fabs(plain(last.state[i]));
    const State<T> start = back_in_contact(last.state, last.time, par, sizes);
    for (std::size_t i = 0; i < n; ++i) out[i] = start[i];
  }

  /// c(r) - u of the impacts from x on, extrapolated to a = 0: zero where chatter becomes incomplete, and positive
  /// where it is complete. Where u falls soon it is that of the last impact. Not there where impacts come to an end.
  template <class T>
  T margin(const T* x, const T* par) const {
    const int last = impacts_to_border(restitution_of_chatter(numbers(x, par))), first = last - 4;
    std::vector<T> places, values;
    State<T> here;
    for (std::size_t i = 0; i < n; ++i) here[i] = x[i];
    T time(0.0);
    bool is_far = false;
    for (int k = 0; k <= last && !is_far; ++k) {
      if (k > 0 && !fly(jump(here.data(), par), par, here, time)) throw NoValue("the impacts come to an end");
      const State<T> f = field(here.data(), par);
      const T a = acceleration(here.data(), par),
              jerk = this->template along<T>(f.data(), here.data(), par, Acceleration{});
      const T r = restitution(here.data(), par), c = border(r);
      const T u = -r * rate(here.data(), par) * jerk / (a * a);
      is_far = k >= first && plain(u) <= near_enough * plain(c);
      if (k < first) continue;
      places.push_back(a / jerk);
      values.push_back(c - u);
    }
    if (is_far) return values.back();
    for (std::size_t level = 1; level < values.size(); ++level)
      for (std::size_t i = 0; i + level < values.size(); ++i)
        values[i] += places[i] / (places[i] - places[i + level]) * (values[i + 1] - values[i]);
    return values[0];
  }

  /// How many impacts there are before those that are near their limit, the one at x included: none is 0. Negative
  /// where impacts do not accumulate.
  int impacts_before_limit(const double* x, const double* par) const {
    try {
      const Impacts<double> impacts = impacts_from(x, par);
      return impacts.is_complete && keeps_contact(impacts, par) ? impacts.near : -1;
    } catch (const NoValue&) {
      return -1;
    }
  }

  /// The same from the impact on that the motion above the surface, at x, comes to.
  int impacts_before_limit_from(const double* x, const double* par) const {
    try {
      const std::optional<State<double>> impact = this->next_impact(x, par);
      return impact ? impacts_before_limit(impact->data(), par) : -1;
    } catch (const NoValue&) {
      return -1;
    }
  }

 private:
  using Base::acceleration;
  using Base::direction;
  using Base::field;
  using Base::fly;
  using Base::jump;
  using Base::numbers;
  using Base::rate;
  using Base::restitution;

  /// One step of leave(). Returns the largest change, as a share of its state.
  template <class Matrix, class T>
  double correct(const Matrix& matrix, const T* par, State<T>& x) const {
    const std::array<T, 3> rest{this->height(x.data(), par), rate(x.data(), par), acceleration(x.data(), par)};
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      T change(0.0);
      for (std::size_t j = 0; j < 3; ++j) change -= matrix.inverse[i][j] * rest[j];
      T& state = x[matrix.states[i]];
      const double before = std::fabs(plain(state));
      state += change;
      largest = std::fmax(largest, std::fabs(plain(change)) / std::fmax(before, std::fabs(plain(state))));
    }
    return largest;
  }

  static constexpr std::size_t orders = 8;
  static constexpr int most_impacts = 200;    // before those near the limit
  static constexpr double near_enough = 0.3;  // of c(r)

  /// What is known before an impact.
  template <class T>
  struct Impact {
    T v;
    State<T> state;
    T time;
  };
  template <class T>
  struct Impacts {
    std::vector<Impact<T>> list;
    int near = 0;   // the first from which on all are near the limit
    int apart = 1;  // s
    bool is_complete = false;
  };

  /// Does the jump leave their limit where it is? Else they have none.
  bool keeps_contact(const Impacts<double>& impacts, const double* par) const {
    const double moved = std::sqrt(std::numeric_limits<double>::epsilon());  // as a share of the state and its change
    const Impact<double>& last = impacts.list.back();
    const State<double> limit = extrapolated(nodes_of(impacts)).state, after = jump(limit.data(), par);
    for (std::size_t i = 0; i < n; ++i) {
      const double size = std::fabs(limit[i]) + std::fabs(last.state[i] - impacts.list.front().state[i]);
      if (!(std::fabs(after[i] - limit[i]) <= moved * size)) return false;
    }
    return true;
  }

  /// On C, at the place that v = 0 has beside the state: at larger v it may be any number.
  double restitution_of_chatter(const Point& at) const {
    const State<double> d = direction(at.x.data(), at.par.data());
    const double v = rate(at.x.data(), at.par.data());
    Point at_rest = at;
    for (std::size_t i = 0; i < n; ++i) at_rest.x[i] -= v * d[i];
    const double r = restitution(at_rest.x.data(), at_rest.par.data());
    if (!(r > 0.0 && r < 1.0)) throw NoValue("impacts accumulate where their restitution is between 0 and 1 only");
    return r;
  }

  /// u / c(r): infinite where a is not negative.
  double share_of_border(const Point& at, double r) const {
    const double a = acceleration(at.x.data(), at.par.data());
    if (!(a < 0.0)) return HUGE_VAL;
    const State<double> f = field(at.x.data(), at.par.data());
    const double jerk = this->template along<double>(f.data(), at.x.data(), at.par.data(), Acceleration{});
    return std::fabs(r * rate(at.x.data(), at.par.data()) * jerk) / (a * a * border(r));
  }

  /// The root in (0, 1) of kappa^3 + 2 kappa^2 - 2 r kappa - r: on the border a falls by this from impact to impact.
  template <class T>
  static T ratio_at_border(const T& r) {
    constexpr int enough = 8;  // for numbers, from the root at r = 1
    T kappa(1.0);
    for (int k = 0; k < enough + derivative_depth<T>; ++k)
      kappa -= (((kappa + 2.0) * kappa - 2.0 * r) * kappa - r) / ((3.0 * kappa + 4.0) * kappa - 2.0 * r);
    return kappa;
  }

  /// c(r) = (3 sigma - sigma^2) / 6 with sigma = 1 - kappa.
  template <class T>
  static T border(const T& r) {
    const T sigma = 1.0 - ratio_at_border(r);
    return (3.0 - sigma) * sigma / 6.0;
  }

  /// As many as a falls to a small part in, so that v, which falls by its square, is not yet rounding.
  static int impacts_to_border(double r) {
    constexpr int least = 6, most = 40;
    constexpr double part = 0.01;
    const double count = std::ceil(std::log(part) / std::log(ratio_at_border(r)));
    return count < least ? least : count > most ? most : static_cast<int>(count);
  }

  /// All that are needed: those that are not near the limit, and 8 s + 1 that are, or fewer where v is as small as
  /// rounding; or those up to where there is no further one, or after a flight twice as long as the one before.
  template <class T>
  Impacts<T> impacts_from(const T* x, const T* par) const {
    const double r = restitution_of_chatter(numbers(x, par));
    Impacts<T> impacts;
    impacts.apart = static_cast<int>(std::ceil(std::log(0.5) / std::log(r)));
    State<T> here;
    for (std::size_t i = 0; i < n; ++i) here[i] = x[i];
    T time(0.0);
    constexpr double tiny = 1e-8, rounding = 1e-12;  // v is a difference: the next ones might be equal
    constexpr double longer = 2.0;
    double flight = HUGE_VAL;
    const int needed = static_cast<int>(orders) * impacts.apart + 1;
    for (int k = 0; !impacts.is_complete && impacts.near <= most_impacts; ++k) {
      impacts.list.push_back({rate(here.data(), par), here, time});
      if (share_of_border(numbers(here.data(), par), r) > near_enough) impacts.near = k + 1;
      impacts.is_complete = k + 1 - impacts.near == needed;
      if (impacts.is_complete) continue;
      const double first = std::fabs(plain(impacts.list.front().v)), last = std::fabs(plain(impacts.list.back().v));
      if (last > rounding * first && fly(jump(here.data(), par), par, here, time)) {
        const double before = std::exchange(flight, plain(time - impacts.list.back().time));
        if (flight <= longer * before) continue;
        break;
      }
      impacts.is_complete = last <= tiny * first && impacts.near <= k;
      break;
    }
    return impacts;
  }

  /// The nodes of the extrapolation, the last ones first. Of incomplete chatter the last impacts that there are.
  template <class T>
  static std::vector<Impact<T>> nodes_of(const Impacts<T>& impacts) {
    const int count = static_cast<int>(impacts.list.size());
    if (!impacts.is_complete && count < 2) throw NoValue("the impacts do not accumulate");
    const int apart = impacts.is_complete ? impacts.apart : 1, least = impacts.is_complete ? impacts.near : 0;
    std::vector<Impact<T>> nodes;
    for (int k = count - 1; k >= least && nodes.size() <= orders; k -= apart)
      nodes.push_back(impacts.list[static_cast<std::size_t>(k)]);
    return nodes;
  }

  /// By Neville's scheme at v = 0.
  template <class T>
  static Rest<T> extrapolated(std::vector<Impact<T>> nodes) {
    for (std::size_t level = 1; level < nodes.size(); ++level)
      for (std::size_t i = 0; i + level < nodes.size(); ++i) {
        const Impact<T>& other = nodes[i + 1];
        const T share = nodes[i].v / (nodes[i].v - nodes[i + level].v);
        for (std::size_t k = 0; k < n; ++k) nodes[i].state[k] += share * (other.state[k] - nodes[i].state[k]);
        nodes[i].time += share * (other.time - nodes[i].time);
      }
    return {nodes.front().state, nodes.front().time};
  }

  /// Follows the motion in contact back from x by `time`, in as many equal parts as accuracy needs. `sizes`: of states.
  template <class T>
  State<T> back_in_contact(const State<T>& x, const T& time, const T* par, const State<double>& sizes) const {
    constexpr int most_parts = 64;
    constexpr double accurate = 1e-13;
    const Point from = numbers(x.data(), par);
    int parts = 1;
    while (parts < most_parts && !(error_of_parts(from, plain(time), parts, sizes) <= accurate)) parts *= 2;
    State<T> y = x;
    State<double> change;
    for (int k = 0; k < parts; ++k) y = part_back(y, time / static_cast<double>(parts), par, change);
    return y;
  }

  /// The largest error of a part, beside the sizes.
  double error_of_parts(const Point& from, double time, int parts, const State<double>& sizes) const {
    State<double> y = from.x, change;
    double error = 0.0;
    for (int k = 0; k < parts; ++k) {
      y = part_back(y, time / parts, from.par.data(), change);
      for (std::size_t i = 0; i < n; ++i)
        if (change[i] != 0.0) error = std::fmax(error, change[i] <= sizes[i] ? change[i] / sizes[i] : HUGE_VAL);
    }
    return error;
  }

  /// Gragg's method, of whose steps the errors are even powers, extrapolated. `error`: the last change.
  template <class T>
  State<T> part_back(const State<T>& x, const T& time, const T* par, State<double>& error) const {
    constexpr std::size_t levels = 7;
    std::array<State<T>, levels> table;
    for (std::size_t level = 0; level < levels; ++level) {
      table[level] = midpoint_steps(x, time, par, 2 * (static_cast<int>(level) + 1));
      for (std::size_t m = level; m-- > 0;) {
        const double ratio = static_cast<double>(level + 1) / static_cast<double>(m + 1);
        for (std::size_t i = 0; i < n; ++i)
          table[m][i] = table[m + 1][i] + (table[m + 1][i] - table[m][i]) / (ratio * ratio - 1.0);
      }
    }
    for (std::size_t i = 0; i < n; ++i) error[i] = std::fabs(plain(table[0][i] - table[1][i]));
    return table[0];
  }

  template <class T>
  State<T> midpoint_steps(const State<T>& x, const T& time, const T* par, int steps) const {
    const T h = -time / static_cast<double>(steps);
    State<T> before = x, here = x, f;
    contact(x.data(), par, f.data());
    for (std::size_t i = 0; i < n; ++i) here[i] += h * f[i];
    for (int k = 1; k < steps; ++k) {
      contact(here.data(), par, f.data());
      for (std::size_t i = 0; i < n; ++i) before[i] += 2.0 * h * f[i];
      std::swap(before, here);
    }
    contact(here.data(), par, f.data());
    for (std::size_t i = 0; i < n; ++i) here[i] = 0.5 * (before[i] + here[i] + h * f[i]);
    return here;
  }
};

}  // namespace tchat
