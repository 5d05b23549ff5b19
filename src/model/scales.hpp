/// How large states, events, durations and parameters are, against which a number is small.
///
/// A problem may be written in any units: x_i = u_i y_i with any u_i > 0 is the same problem, so that nothing may be
/// decided by a number that has a unit. A run solves the problem for y, whose states are of size 1
/// (model/scaled_problem.hpp); simulations compare states with the sizes that they have had; events are judged by what
/// states of their sizes make of them (model/events.hpp).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

/// The sizes of the states of an orbit or a motion: the largest |x_i|, n.
///
/// A state that symmetry makes zero still shows rounding, 1e-17 or less, which is not its size. Small as it is, it may
/// also be a state in large units. It is one, and has a size, only if something depends on it: if, directly or through
/// other such states, it is a visible part of the terms of an event function, or of the rate or the jump of a state
/// that has a size. States that are not far smaller than the largest one have one. Of the others nothing is known but
/// how they depend on each other: their sizes balance f_x, with the median 1, and are 1 where that makes little of it.
class StateSizes {
 public:
  /// `states`: some of an orbit, n to a column.
  explicit StateSizes(const Eigen::MatrixXd& states);

  /// A function on which the orbit depends, at one of its states.
  void add(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par);
  /// The only state is at rest. Where the terms of its rate do not cancel it is rounding of zero.
  void add_at_rest(const HybridSystem& system, int field, const double* x, const double* par);

  /// `balances`: else states of which nothing else is known have the size 1, for entries of f_x may be rounding of
  /// zero.
  Eigen::VectorXd sizes(bool balances = true) const;
  /// Of each state: has it a size? `sure`: those that have one, so that others need to be a visible part of what they
  /// do, or of an event; none: all that are not far smaller than the largest.
  std::vector<bool> known(const std::vector<bool>& sure = {}) const;

 private:
  struct Terms {
    Eigen::VectorXd values;  // of the function
    Eigen::MatrixXd terms;   // |dF_j / dx_i| times the size of x_i
    double constant;         // what is left of the first value without its linear terms
  };
  Terms terms_of(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par);
  void add_states(const Terms& of);

  Eigen::VectorXd largest_;
  Eigen::MatrixXd couplings_;  // (j, i): the largest |df_j / dx_i|
  Eigen::MatrixXd shares_;     // (j, i): the largest part that state i has in the terms of values for state j
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

/// Are sizes of states, as far as they are known, so near to 1 that units make no difference: from 1/64 to 64?
bool are_usual(const Eigen::VectorXd& sizes);

/// What an absolute tolerance of integration, which is meant for states of size 1, is to be multiplied by for one of
/// this size: it, but not nothing; 1 where the size is 0, not known.
double size_for_tolerance(double size);

/// Sizes of differences of states that range so far: the range, or the size (0: not known) of one that hardly moves.
Eigen::VectorXd sizes_from_ranges(const Eigen::VectorXd& ranges, const Eigen::VectorXd& sizes);

/// Sizes of differences of states of a motion between `low` and `high`: of each its range and 1e-3 of its largest
/// value; of one that is nothing but rounding of zero 1e-3 of the largest range; infinite of one that is left out.
/// Flags of states may be empty: none.
Eigen::VectorXd sizes_of_differences(const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                                     const std::vector<bool>& rounding, const std::vector<bool>& left_out = {});

/// |d| of a change d of states, each in units of its size: infinite where one without a size changes.
double length_in_sizes(const Eigen::VectorXd& d, const Eigen::VectorXd& sizes);

/// Powers of two u for which the matrix a_ij u_j / u_i, n x n, has a norm not far from its least, also where it is
/// reducible: a large entry may stand for a transient only.
Eigen::VectorXd balancing_units(const Eigen::MatrixXd& a);

/// Powers of two next to `sizes`, multiplication by which is exact; all 1 where they are usual.
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

}  // namespace tchat
