/// A scalar function of the state and the parameters that monitors look at: a state, an event function, or a function
/// that the problem has for output (user_value).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

struct Quantity {
  enum class Kind { state, event, user_function };
  Kind kind = Kind::state;
  int index = 1;  ///< from 1
};

/// Of user function k: its own, or PVLS(k).
std::string user_function_name(const HybridSystem& system, int k);

/// By its name: "x" or U(1) for states, the name of a user function or PVLS(1), the name of an event function or h1.
std::optional<Quantity> find_quantity(const HybridSystem& system, const std::string& name);

/// The name of state k in those of monitors: U(k) where blanks, commas or brackets of its own would have a meaning.
std::string state_in_monitor(const HybridSystem& system, int k);

/// The function that CONSERVED names. Throws UserError where the problem has none of that name.
Quantity conserved_quantity(const HybridSystem& system, const std::string& name);

/// "x, v, energy, h1 to h3": for messages.
std::string quantity_list(const HybridSystem& system);

/// Values and first derivatives; those of user functions by central differences, a fourth-order formula. Allocates when
/// it is made, not when it is evaluated.
class QuantityFunction {
 public:
  /// `active`: PAR indices of the derivatives by parameters.
  QuantityFunction(const HybridSystem& system, Quantity quantity, std::vector<int> active);

  double value(const double* x, const double* par) const;
  /// by_state: n, by_parameter: as many as are active.
  double first(const double* x, const double* par, double* by_state, double* by_parameter) const;

 private:
  double by_difference(double& variable, const double* x, const double* par) const;

  const HybridSystem* system_;
  Quantity quantity_;
  std::vector<int> active_;
  mutable std::vector<double> values_;       // of all user functions
  mutable std::vector<double> state_, par_;  // displaced
};

}  // namespace tchat
