/// Determinants of block-cyclic systems E_s c_s = A_s c_{s-1}, s = 1..m, c_0 = t c_m with t = 1 or -1:
///
///     det [ E_1            -t A_1 ]
///         [ -A_2  E_2             ]  =  det E_1 ... det E_m  det(1 - t E_m^-1 A_m ... E_1^-1 A_1),
///         [       ...   -A_m  E_m ]
///
/// without forming any inverse: regular where an E_s is singular. Cost O(m n^3).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tchat {

/// mantissa * 2^exponent: a product of many factors need not fit into a double.
class ScaledReal {
 public:
  ScaledReal& operator*=(double factor);
  ScaledReal& operator*=(const ScaledReal& other);
  /// By a divisor other than 0.
  ScaledReal& operator/=(const ScaledReal& other);
  /// As a plain number; sizes beyond `cap` are cut back to it, underflow gives 0.
  double value(double cap) const;

 private:
  double mantissa_ = 1.0;
  long exponent_ = 0;
};

/// Overwrites the square matrix.
ScaledReal determinant_in_place(Eigen::MatrixXd& matrix);

/// Of one system after the other; no allocations after the first of a size.
class CyclicDeterminant {
 public:
  CyclicDeterminant() = default;
  CyclicDeterminant(const std::vector<Eigen::MatrixXd>& e, const std::vector<Eigen::MatrixXd>& a) { eliminate(e, a); }
  /// Entries s = 0..m-1, m >= 1, all square and of one size n >= 0.
  void eliminate(const std::vector<Eigen::MatrixXd>& e, const std::vector<Eigen::MatrixXd>& a);
  ScaledReal at(double t);

 private:
  ScaledReal eliminated_;  // what c_1, ..., c_(m-1) contribute
  Eigen::MatrixXd e_;      // what is left: e c_m = a c_0
  Eigen::MatrixXd a_;
  Eigen::MatrixXd both_, difference_;  // scratch
};

}  // namespace tchat
