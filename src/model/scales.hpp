/// The sizes of what a problem is made of, against which a number is small or large: states and event functions; and
/// the problem in units of its own states.
///
/// A problem may be written in any units: x_i = u_i y_i with any u_i > 0 is the same problem. So nothing may be decided
/// by a number that has a unit. A run does not divide by sizes at each of its decisions: it solves the problem for y,
/// whose states are of size 1, and gives its solutions back as x (ScaledProblem). What is left for decisions are the
/// sizes of events, sums of the terms that h and h_x f are made of (model/events.hpp).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

/// The sizes of the states of an orbit: the largest |x_i| of each row of `states`, n.
///
/// A state that is zero by symmetry is there but for rounding, and that must not be taken for its size. What sets it
/// apart from a state in large units is that nothing is changed by it: a state far smaller than others has a size only
/// if, in a chain of such steps, one that has a size is changed by it: by a term of its rate, of its jump, or of an
/// event function that is no rounding of the others. All others have size 1: nothing is known of them.
class StateSizes {
 public:
  /// `states`: some of an orbit, n to a column.
  explicit StateSizes(const Eigen::MatrixXd& states);

  /// A function of the orbit whose values are states (rates, images of a jump): n values and their derivatives by the
  /// states (n x n) at one of these.
  void add_states(const Eigen::VectorXd& values, const Eigen::MatrixXd& by_state);
  /// The same of the rates at the only state, which is at rest: what its terms do not cancel shows that it has no size
  /// but rounding of zero.
  void add_rates_at_rest(const Eigen::VectorXd& values, const Eigen::MatrixXd& by_state);
  /// An event function at one of them.
  void add_event(double value, const Eigen::RowVectorXd& by_state, const double* x);

  Eigen::VectorXd sizes() const;
  /// Of each state: has it a size?
  std::vector<bool> known() const;

 private:
  Eigen::VectorXd largest_;
  Eigen::MatrixXd shares_;  // (j, i): the largest part that state i has in the terms of values for state j
  Eigen::VectorXd in_events_;
  std::optional<Eigen::VectorXd> in_balance_;  // of a state at rest: the share in sums of terms that cancel
};

/// Sizes of the states at one state of a flow, for which nothing else is known: |x_i|, and what its rate makes of it
/// within the time in which states change by themselves: for each the shortest of |x_i| / |f_i|, the root of |x_i| /
/// |(f_x f)_i| and 1 / |f_x|'s largest eigenvalue, and the shortest of these without what is rounding. 0 where that
/// says nothing.
Eigen::VectorXd sizes_at(const HybridSystem& system, int field, const Eigen::VectorXd& x, const Eigen::VectorXd& par);

/// Is a number of this size one that users write where units are chosen for it: neither many times larger than 1 nor
/// smaller? So is one of which nothing is known.
bool is_ordinary(double size);

/// The weight that a state or duration of this size has in a norm where none is given: 1 in the units of the user, as
/// AUTO has it, where these are such that numbers are of an ordinary size; else 1 / size^2, for a step of the length DS
/// would mean nothing.
double default_weight(double size);

/// Powers of two next to `sizes`: multiplication by them is exact. All 1 where no size is many times larger or smaller
/// than 1: what is computed then is what it would be without units.
Eigen::VectorXd units_of(const Eigen::VectorXd& sizes);

/// u, all 1 of a problem in the units of its user: n.
Eigen::VectorXd units_of_states(const HybridSystem& system);
/// |u v| of a vector of states of the problem, of the first of them where it is shorter, in the units of its user.
template <class Vector>
double length_in_users_units(const HybridSystem& system, const Vector& v) {
  double squares = 0.0;
  for (Eigen::Index k = 0; k < v.size(); ++k)
    squares += std::pow(system.unit_of(static_cast<int>(k) + 1) * std::abs(v(k)), 2);
  return std::sqrt(squares);
}

/// Which of its entries is the largest in those units, from 0.
template <class Vector>
Eigen::Index largest_in_users_units(const HybridSystem& system, const Vector& v) {
  Eigen::Index largest = 0;
  double size = -1.0;
  for (Eigen::Index k = 0; k < v.size(); ++k) {
    const double shown = system.unit_of(static_cast<int>(k) + 1) * std::abs(v(k));
    if (shown > size) largest = k, size = shown;
  }
  return largest;
}

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
  const Eigen::VectorXd& units() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> p_;
};

}  // namespace tchat
