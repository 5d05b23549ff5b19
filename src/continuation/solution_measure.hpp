/// Numbers of a solution along a branch: its measure as printed, and the monitors of the run.
#pragma once

#include <memory>
#include <vector>

#include "orbit/collocation_rule.hpp"
#include "orbit/monitor.hpp"
#include "orbit/orbit.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// The printed numbers of an orbit: norms, maxima and integrals over the whole period, whatever its cuts into segments.

/// sqrt of the time mean of sum_i theta_i u_i^2: each segment weighted by T_s / sum T (equally when all T_s are 0).
double l2_norm(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights);

/// Largest and smallest value of U(k), k = 1..n, over the stored points of all segments.
double maximum_of(const Orbit& x, int k);
double minimum_of(const Orbit& x, int k);

/// The measure that IPLT selects: 0 or |IPLT| > 3n the L2-norm; 1..n maximum, -1..-n minimum, n+1..2n time mean,
/// 2n+1..3n L2-norm of one component.
double solution_measure(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights, int iplt);

// The monitors of a run, and which of them are held. The values of all are kept in PAR behind the durations, where
// columns, user values, bounds and the principal parameter find them.

class MonitorSet {
 public:
  MonitorSet() = default;
  /// `names`: those of PAR(ParameterLayout::first_monitor(segments)), ...; `system` outlives the set.
  MonitorSet(const std::vector<MonitorName>& names, const DefiningSystem& system);

  /// Is PAR(k) one whose gradient is known?
  bool has_gradient(int k) const;
  double gradient(int k, const Orbit& x, const CollocationRule& rule, OrbitVector& row) const {
    return of(k).gradient(x, rule, row);
  }
  /// Puts the values at x into its PAR, but for multipliers.
  void store(Orbit& x, const CollocationRule& rule) const;
  /// Puts moduli of multipliers into PAR; what is not known becomes NaN.
  void store(Orbit& x, const FloquetMultipliers& multipliers) const;

 private:
  const Monitor& of(int k) const { return *list_[static_cast<std::size_t>(k - first_)].monitor; }

  struct Entry {
    std::unique_ptr<Monitor> monitor;  // null: the modulus of a multiplier
    int rank = 0;                      // of that one, from 1
  };
  int first_ = 0;
  std::vector<Entry> list_;
};

}  // namespace tchat
