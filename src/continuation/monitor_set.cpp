#include "continuation/monitor_set.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace tchat {

MonitorSet::MonitorSet(const std::vector<MonitorName>& names, const DefiningSystem& system)
    : first_(system.layout().first_monitor(system.segments())) {
  for (const MonitorName& name : names) list_.push_back({make_monitor(name, system), name.number});
}

bool MonitorSet::has_gradient(int k) const {
  const int i = k - first_;
  return i >= 0 && i < static_cast<int>(list_.size()) && list_[static_cast<std::size_t>(i)].monitor != nullptr;
}

void MonitorSet::store(Orbit& x, const CollocationRule& rule) const {
  for (std::size_t i = 0; i < list_.size(); ++i)
    if (list_[i].monitor) x.par(first_ - 1 + static_cast<int>(i)) = list_[i].monitor->value(x, rule);
}

void MonitorSet::store(Orbit& x, const FloquetMultipliers& multipliers) const {
  const bool wanted = std::any_of(list_.begin(), list_.end(), [](const Entry& entry) { return !entry.monitor; });
  if (!wanted) return;
  std::vector<double> moduli;
  for (const auto& mu : multipliers.nontrivial()) moduli.push_back(std::abs(mu));
  std::sort(moduli.begin(), moduli.end(), std::greater<>());
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (list_[i].monitor) continue;
    const auto rank = static_cast<std::size_t>(list_[i].rank);
    x.par(first_ - 1 + static_cast<int>(i)) =
        rank <= moduli.size() ? moduli[rank - 1] : std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace tchat
