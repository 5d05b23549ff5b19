/// Monitors: scalar functions of an orbit that have a name, to be watched along a branch or held on it.
///
///     period              the sum of the durations
///     velocity(s)         h_x f at the end of segment s, h its event function
///     start(X, s)         X at the start of segment s, of the first one without s
///     X                   the same, of a user function
///     end(X, s)           X at the end of segment s, of the last one without s
///     max(X), min(X)      the largest, least value of X over the orbit, or segment s: max(X, s)
///     mean(X)             the mean of X in time, over the orbit or segment s
///     integral(X)         the integral of X in time, likewise
///     multiplier(k)       the k-th largest modulus of the Floquet multipliers
///
/// X is a state, an event function or a user function of the problem (quantity.hpp). Extrema are those of the
/// collocation polynomials, also between nodes; where two places are equally high they have a kink.
///
/// A monitor that is held adds the equation q(x) - value = 0, and its gradient is a border row as that of an integral
/// condition is; one more problem parameter is then free. multiplier(k) cannot be held: curves of critical multipliers
/// are for ISW = 2.
#pragma once

#include <memory>
#include <string>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/quantity.hpp"

namespace tchat {

struct MonitorName {
  enum class Kind { period, velocity, start, end, maximum, minimum, mean, integral, multiplier };
  Kind kind = Kind::period;
  Quantity quantity = {};
  int number = 0;  ///< segment from 1, 0: not said; of multipliers the rank, from 1
};

/// Throws UserError that begins with `where` when `text` is no monitor of the problem, and says what there is.
MonitorName parse_monitor(const HybridSystem& system, const std::string& text, const std::string& where);

/// "period, velocity(S), ...": for messages.
std::string monitor_list();

class Monitor {
 public:
  virtual ~Monitor() = default;
  virtual double value(const Orbit& x, const CollocationRule& rule) const = 0;
  /// The value; `row` is overwritten with the gradient. Does not allocate after the first call.
  virtual double gradient(const Orbit& x, const CollocationRule& rule, OrbitVector& row) const = 0;
};

/// Null for multiplier(k), whose value comes with the multipliers. `system` outlives the monitor.
std::unique_ptr<Monitor> make_monitor(const MonitorName& name, const DefiningSystem& system);

/// T_s of segment s, from 0: a duration that is held is a monitor too.
std::unique_ptr<Monitor> make_duration_monitor(int segment);

}  // namespace tchat
