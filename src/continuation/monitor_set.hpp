/// The monitors of a run, and which of them are held. The values of all are kept in PAR behind the durations, where
/// columns, user values, bounds and the principal parameter find them.
#pragma once

#include <memory>
#include <vector>

#include "orbit/monitor.hpp"
#include "stability/test_function.hpp"

namespace tchat {

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
