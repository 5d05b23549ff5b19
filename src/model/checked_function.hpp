/// The functions of a problem as `tchat check` compares them with extrapolated differences.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

// One function of a hybrid system as `tchat check` sees it: a function of (x, PAR(1..q)) with a name for every entry,
// and the comparison of a matrix of its derivatives with extrapolated differences.

/// Where functions are compared.
struct TestPoint {
  Eigen::VectorXd x;    // n
  Eigen::VectorXd par;  // room of the layout
  bool is_random;       // a NaN at a random point is no fault
};

/// How far a state or parameter with this value may go: 1 + |x|, |x| where that is not ordinary (model/scales.hpp).
double checked_range(double value);

/// "x = (1, 0.5)", in the units of the user.
std::string point_text(const HybridSystem& system, const TestPoint& at);

/// One function F with its variables: c = 0..n-1 are the states, then come parameters, all of them unless some are
/// chosen.
class CheckedFunction {
 public:
  /// A view of `system`, which outlives this object.
  CheckedFunction(const HybridSystem& system, FunctionKind kind, int index);
  /// `active`: PAR indices, from 1.
  CheckedFunction(const HybridSystem& system, FunctionKind kind, int index, std::vector<int> active);

  int rows() const { return system_.rows(kind_); }
  int variables() const { return system_.dimension() + static_cast<int>(active_.size()); }

  Eigen::VectorXd value(const TestPoint& at) const;
  /// [F_x, F_p], rows x variables; `value` becomes F.
  Eigen::MatrixXd first(const TestPoint& at, Eigen::VectorXd& value) const;
  /// [D_x, D_p] of D = F_x v + F_p w, rows x variables, direction = (v, w); `along` becomes D.
  Eigen::MatrixXd second(const TestPoint& at, const Eigen::VectorXd& direction, Eigen::VectorXd& along) const;

  double variable(const TestPoint& at, int c) const;
  /// The point with variable c moved by t.
  TestPoint moved(TestPoint at, int c, double t) const;
  /// The point moved by these steps of all variables.
  TestPoint moved(TestPoint at, const Eigen::VectorXd& steps) const;

  /// "x2"; of c = -1 "a random direction".
  std::string variable_name(int c) const;
  /// "f_1[x2]", "h_3", "g_1[x1]"
  std::string row_name(int row) const;

 private:
  int parameter(int c) const { return active_[static_cast<std::size_t>(c - system_.dimension())]; }

  const HybridSystem& system_;
  FunctionKind kind_;
  int index_;
  std::vector<int> active_;
};

/// An entry of a matrix of derivatives against differences.
struct ComparedEntry {
  double relative = 0.0;    // distance by the function's scale
  double excess = 0.0;      // distance by what is allowed
  int row = 0, column = 0;  // column -1: along a direction
  double supplied = 0.0, difference = 0.0;
  bool at_fault() const { return excess > 1.0; }
};

struct MatrixComparison {
  ComparedEntry worst;
  std::vector<ComparedEntry> faults;  // column by column
};

/// Compares `supplied`, a matrix rows x variables of each point, with differences of `value` (a view of the function,
/// or of its directional derivative). An entry is at fault when it is off by more than 20 times the differences' error
/// estimate and 1e-8 of the function's scale, and differences of two step lengths agree; entries where no two do are
/// passed over. `supplied` is evaluated again at points with other last digits where an entry seems to be at fault:
/// what changes with them is rounding, and no fault.
MatrixComparison compare_with_differences(const CheckedFunction& function, const TestPoint& at,
                                          const std::function<Eigen::MatrixXd(const TestPoint&)>& supplied,
                                          const std::function<Eigen::VectorXd(const TestPoint&)>& value);

/// The same of the derivatives along a few `directions` (in variables, of any length) in place of those by every
/// variable: of many variables. The worst entry has no column. Where one of them seems to be at fault, every variable
/// is compared, so that faults have their columns.
MatrixComparison compare_along_directions(const CheckedFunction& function, const TestPoint& at,
                                          const std::vector<Eigen::VectorXd>& directions,
                                          const std::function<Eigen::MatrixXd(const TestPoint&)>& supplied,
                                          const std::function<Eigen::VectorXd(const TestPoint&)>& value);

// Derivatives of a function of one variable by central differences with Richardson extrapolation, and how far to
// trust them (Ridders' method). Slow and careful: for checking derivatives, not for using them.

struct ExtrapolatedDifference {
  Eigen::VectorXd value;  ///< phi'(0); NaN where phi could not be evaluated at any step size
  Eigen::VectorXd error;  ///< estimate of its error, entry by entry; infinite where value is NaN
};

/// phi'(0) from phi(+-h) with h = step, step / 2, ..., step / 2^9. Entries of phi that are not finite at some step
/// sizes use the others.
ExtrapolatedDifference extrapolated_difference(const std::function<Eigen::VectorXd(double)>& phi, double step);

}  // namespace tchat
