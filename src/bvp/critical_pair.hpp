/// Defining condition of torus curves: a complex pair of multipliers on the unit circle, G = |mu|^2 - 1.
///
/// mu is followed as a simple eigenvalue of the condensed return map: S(mu) v = 0, w^H S(mu) = 0 by Newton's method on
/// the bordered problem from the last mu, and
///
///     d mu = -(w^H (dS) v) / (w_last^H v_1(0)),      dG = 2 Re(conj(mu) d mu),
///
/// where w_last belongs to the last connectivity, mu v_1(0) = g_x w_m. Regular while the pair is simple: the curve ends
/// at 1:1 and 1:2 resonances, where it becomes a double real multiplier. Newton's method that comes to a real
/// multiplier or far from where it began has found another one: an evaluation fails then. Compared with one critical
/// multiplier there are two sweeps of second derivatives, for the real and the imaginary part.
#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <complex>

#include "bvp/bordered_problem.hpp"
#include "bvp/condensed_return_map.hpp"

namespace tchat {

class CriticalPair final : public OrbitCondition {
 public:
  /// `multiplier`: where to begin, in the upper half plane.
  CriticalPair(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> multiplier);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value() const override { return std::norm(multiplier_) - 1.0; }
  const OrbitVector& gradient() const override { return gradient_; }
  /// mu and the border b, c.
  std::vector<double> memory() const override;
  void recall(const std::vector<double>& memory) override;
  /// In the upper half plane.
  std::complex<double> multiplier() const { return multiplier_; }

 private:
  using Complex = std::complex<double>;
  using Vector = Eigen::VectorXcd;

  bool find_multiplier(const std::vector<double>& values);
  bool iterate(const std::vector<double>& values);
  bool solve_bordered(const std::vector<double>& values);

  CondensedReturnMap map_;
  Complex multiplier_;
  Eigen::SparseMatrix<Complex> matrix_;
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu_;
  Vector column_;  // b
  Vector row_;     // c
  Vector v_;       // with the bordered problem's g last
  Vector w_;
  OrbitVector extended_;
  OrbitVector gradient_;
};

}  // namespace tchat
