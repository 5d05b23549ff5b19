#include "continuation/solution_measure.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "linear/array_kernel.hpp"

namespace tchat {

namespace {

/// What segments have of the time of the orbit.
class TimeShares {
 public:
  explicit TimeShares(const Orbit& x) : x_(x) {
    for (int r = 0; r < x.shape.segments; ++r) total_ += std::abs(x.duration(r));
  }
  double of(int s) const { return total_ > 0.0 ? std::abs(x_.duration(s)) / total_ : 1.0 / x_.shape.segments; }

 private:
  const Orbit& x_;
  double total_ = 0.0;
};

/// Time mean over the period of what `integrand` gives for the nodes (n x (c+1)) of one interval scaled to length 1.
template <class Integrand>
double time_mean(const Orbit& x, const Integrand& integrand) {
  const int c = x.shape.collocation;
  const TimeShares shares(x);
  double mean = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    double segment = 0.0;
    const double* const mesh = x.mesh_of(s);
    for (int j = 0; j < x.shape.intervals_of(s); ++j)
      segment += (mesh[j + 1] - mesh[j]) * integrand(x.states.middleCols(x.shape.first_node(s) + j * c, c + 1));
    mean += shares.of(s) * segment;
  }
  return mean;
}

}  // namespace

double l2_norm(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights) {
  const TimeShares shares(x);
  double mean = 0.0;
  for (int s = 0; s < x.shape.segments; ++s)
    mean += shares.of(s) * array_functions().mass_product(mass_intervals(x, rule, state_weights, s), x.node(s, 0));
  return std::sqrt(mean);
}

double maximum_of(const Orbit& x, int k) { return x.states.row(k - 1).maxCoeff(); }
double minimum_of(const Orbit& x, int k) { return x.states.row(k - 1).minCoeff(); }

double solution_measure(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& state_weights, int iplt) {
  const int n = x.shape.dimension;
  if (iplt == 0 || iplt < -n || iplt > 3 * n) return l2_norm(x, rule, state_weights);
  if (iplt < 0) return minimum_of(x, -iplt);
  if (iplt <= n) return maximum_of(x, iplt);
  const int k = (iplt - 1) % n;
  if (iplt <= 2 * n) return time_mean(x, [&](const auto& nodes) { return nodes.row(k).dot(rule.integral); });
  return std::sqrt(time_mean(x, [&](const auto& nodes) { return nodes.row(k).dot(nodes.row(k) * rule.mass); }));
}

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
