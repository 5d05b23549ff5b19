#include "orbit/stationary_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

std::vector<const Monitor*> held_monitors(const std::vector<HeldMonitor>& held) {
  std::vector<const Monitor*> list;
  for (const HeldMonitor& one : held) list.push_back(one.monitor.get());
  return list;
}

StationaryMonitor::StationaryMonitor(const DefiningSystem& system, const OrbitShape& shape,
                                     std::shared_ptr<const Monitor> objective, const std::vector<HeldMonitor>& held)
    : objective_(std::move(objective)),
      held_(held),
      gradient_(system, shape, *objective_, held_monitors(held_)),
      rows_(static_cast<std::size_t>(count()), OrbitVector(shape, system.free_count())) {}

bool StationaryMonitor::evaluate(CondensedSystem&, const Orbit& x) {
  if (!gradient_.evaluate(x)) return false;
  next_scales_.resize(rows_.size());
  for (int k = 0; k < count(); ++k) next_scales_[static_cast<std::size_t>(k)] = gradient_.size(k);
  if (scales_.empty()) scales_ = next_scales_;
  for (int k = 0; k < count(); ++k) {
    OrbitVector& row = rows_[static_cast<std::size_t>(k)];
    gradient_.derivative(x, k, row);
    row.scale(1.0 / scales_[static_cast<std::size_t>(k)]);
  }
  return std::all_of(rows_.begin(), rows_.end(), [](const OrbitVector& row) { return row.states.allFinite(); });
}

void StationaryMonitor::remember(std::vector<double>& memory) const { memory = next_scales_; }

bool is_stationary(const DefiningSystem& system, const Orbit& x, const Monitor& objective,
                   const std::vector<HeldMonitor>& held) {
  constexpr double near = 1e-2;  // far more than a located point leaves, whatever its tolerances
  ReducedGradient gradient(system, x.shape, objective, held_monitors(held));
  if (!gradient.evaluate(x) || gradient.depends_on_phase(x)) return false;
  for (int k = 0; k < gradient.count() - 1; ++k)
    if (!(gradient.distance(x, k) <= near)) return false;
  return true;
}

}  // namespace tchat
