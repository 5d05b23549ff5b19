/// Defining condition of curves on which a monitor is stationary in K parameters, K + 1 of them free (after those that
/// depend on others, where monitors are held): H_1 = .. = H_K = 0 of reduced_gradient.hpp.
///
/// Count. N unknowns u and N equations F: with K + 1 parameters and the K numbers H_k a curve. On it dq = H_{K+1}
/// dp_{K+1}: where H_{K+1} = 0 the monitor is stationary in K + 1 parameters, and the curve of the next K begins.
#pragma once

#include <memory>
#include <vector>

#include "orbit/bordered_problem.hpp"
#include "orbit/reduced_gradient.hpp"

namespace tchat {

/// Those of a list of held ones, which outlives them.
std::vector<const Monitor*> held_monitors(const std::vector<HeldMonitor>& held);

class StationaryMonitor final : public OrbitCondition {
 public:
  /// The system frees K + 1 parameters more than there are monitors held, and outlives the condition.
  StationaryMonitor(const DefiningSystem& system, const OrbitShape& shape, std::shared_ptr<const Monitor> objective,
                    const std::vector<HeldMonitor>& held);

  int count() const override { return gradient_.count() - 1; }
  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  /// H_k and its gradient as a share of the size of H_k at the point that the step began from.
  double value(int k) const override { return gradient_.value(k) / scales_[static_cast<std::size_t>(k)]; }
  const OrbitVector& gradient(int k) const override { return rows_[static_cast<std::size_t>(k)]; }
  /// The sizes.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override { scales_ = memory; }

  /// H_{K+1} of the last evaluation as a share of its size.
  double next_derivative() const { return gradient_.value(count()) / gradient_.size(count()); }

 private:
  std::shared_ptr<const Monitor> objective_;
  std::vector<HeldMonitor> held_;
  ReducedGradient gradient_;
  std::vector<double> scales_, next_scales_;
  std::vector<OrbitVector> rows_;
};

/// Is the monitor stationary at x in all independent parameters but the last one? Also false where the orbit is
/// no part of a family in these parameters.
bool is_stationary(const DefiningSystem& system, const Orbit& x, const Monitor& objective,
                   const std::vector<HeldMonitor>& held);

}  // namespace tchat
