/// A problem in units of its own states.
#pragma once

#include <memory>

#include "model/hybrid_system.hpp"

namespace tchat {

/// A problem for y, x_i = u_i y_i:
///
///     y' = u^-1 f(u y, p),   h(u y, p),   u^-1 g(u y, p),
///
/// with the derivatives that the problem has. Time, parameters and the values of event functions, conditions and
/// user functions are as they were. The table of the problem outlives this object, and this object its system().
class ScaledProblem {
 public:
  /// Scales::units: u, n positive numbers.
  ScaledProblem(const HybridSystem& base, Scales scales);
  ScaledProblem(const ScaledProblem&) = delete;
  ScaledProblem& operator=(const ScaledProblem&) = delete;
  ~ScaledProblem();

  const HybridSystem& system() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
