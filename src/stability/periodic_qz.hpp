/// Eigenvalues of products of matrix pairs without forming the product, and determinants of block-cyclic systems.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace tchat {

// Eigenvalues of a formal product of matrix pairs by the periodic QZ algorithm,
//
//     M = E_m^-1 A_m ... E_2^-1 A_2 E_1^-1 A_1,
//
// without forming any product or inverse: every factor is transformed by unitary matrices only, so that eigenvalues of
// very different size, and infinite ones of singular E_s, come out with errors of the order of rounding in each
// factor. Cost O(m n^3), memory O(m n^2), all allocated when the object is made.
//
// Method: Bojanczyk, Golub & Van Dooren's periodic Schur form in complex arithmetic. A_1 is reduced to Hessenberg form
// and all other factors to triangular form, then implicit single-shift steps chase a bulge round the cycle until A_1
// is triangular as well. Many factors make eigenvalues that differ by more than any shift resolves: steps without one
// separate these. Steps are applied to the diagonal blocks alone that they are about: no eigenvalue depends on
// what stands beside these, so that it is not kept up to date. Zeros on the diagonal of a triangular factor are
// replaced by rounding-level numbers, a perturbation that the method commits anyway, so no case needs deflation of its
// own.

/// mantissa * 2^exponent: a product of many factors need not fit into a double.
struct ScaledComplex {
  std::complex<double> mantissa;
  long exponent = 0;
  /// As a plain number; moduli above `cap` are cut back to it, keeping the direction; underflow gives 0.
  std::complex<double> value(double cap) const;
};

class PeriodicQz {
 public:
  using Scalar = std::complex<double>;

  /// `size` = n >= 0, `factors` = m >= 1.
  PeriodicQz(int size, int factors);

  /// Entries of A_s and E_s, s = 0..m-1, to be filled before compute(), which overwrites them.
  Scalar& a(int s, int row, int column) { return a_[at(s, row, column)]; }
  Scalar& e(int s, int row, int column) { return e_[at(s, row, column)]; }
  const Scalar& a(int s, int row, int column) const { return a_[at(s, row, column)]; }
  const Scalar& e(int s, int row, int column) const { return e_[at(s, row, column)]; }

  /// False when the iteration does not converge (then the eigenvalues are useless) or the input is not finite.
  bool compute();
  /// n eigenvalues of M. A real problem's come in conjugate pairs to rounding; see conjugate_pairs().
  const std::vector<ScaledComplex>& eigenvalues() const { return eigenvalues_; }

 private:
  struct Rotation;
  struct TriangularBlock;
  /// Of rows or columns, both ends included.
  struct Range {
    int first, last;
  };
  std::size_t at(int s, int row, int column) const { return static_cast<std::size_t>((s * n_ + column) * n_ + row); }
  Range all() const { return {0, n_ - 1}; }
  bool finite() const;
  void normalise();
  void triangularise();
  void hessenberg();
  void chase(int k, const Range& window, int last_row);
  void regularise();
  bool iterate();
  TriangularBlock triangular_block(int k) const;
  bool graded(const TriangularBlock& t, int k) const;
  ScaledComplex shift(const TriangularBlock& t, int high, int iteration) const;
  Rotation first_rotation(const TriangularBlock& t, int low, const ScaledComplex& shift) const;
  void chase_backwards(int k, const Range& window, const Rotation& r);
  void single_step(const Range& window, int iteration);
  void unshifted_step(const Range& window);
  void deflate(int k);
  void rotate_rows(std::vector<Scalar>& matrix, int s, int k, const Rotation& r, const Range& columns);
  void rotate_columns(std::vector<Scalar>& matrix, int s, int k, const Rotation& r, const Range& rows);

  int n_;
  int m_;
  std::vector<Scalar> a_;
  std::vector<Scalar> e_;
  std::vector<long> scale_;  // powers of two taken out of the factors
  std::vector<ScaledComplex> eigenvalues_;
};

/// The eigenvalues of a real problem cleaned of rounding: each is paired with the nearest conjugate, possibly itself
/// (then it is real), and the two are averaged. The one with the positive imaginary part comes first.
void conjugate_pairs(std::vector<std::complex<double>>& values);

// Determinants of block-cyclic systems E_s c_s = A_s c_{s-1}, s = 1..m, c_0 = t c_m with t = 1 or -1:
//
//     det [ E_1            -t A_1 ]
//         [ -A_2  E_2             ]  =  det E_1 ... det E_m  det(1 - t E_m^-1 A_m ... E_1^-1 A_1),
//         [       ...   -A_m  E_m ]
//
// without forming any inverse: regular where an E_s is singular. Cost O(m n^3).

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
