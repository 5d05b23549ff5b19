/// Collocation on one mesh interval, and what is computed with its polynomials along an orbit: integrals, inner
/// products, the discretisation error.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <type_traits>
#include <vector>

#include "linear/array_kernel.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// Orthogonal collocation on one mesh interval (5.26-5.29), scaled to sigma in [0, 1]: Lagrange polynomials of degree c
// on c + 1 equally spaced nodes, collocated at the c Gauss points. These are in the order in which elimination of the
// interior nodes finds its pivots in a short interval, so that rows are seldom exchanged.

class CollocationRule {
 public:
  static constexpr int most_points = 7;

  /// c = number of collocation points, 2..most_points.
  explicit CollocationRule(int points);

  int points() const { return points_; }

  Eigen::VectorXd gauss;      ///< c: Gauss points
  Eigen::VectorXd weights;    ///< c: Gauss weights of the interval, of unit sum
  Eigen::MatrixXd value;      ///< c x (c+1): value(j, i) = l_i(gauss_j)
  Eigen::MatrixXd slope;      ///< c x (c+1): slope(j, i) = l_i'(gauss_j)
  Eigen::MatrixXd mass;       ///< (c+1) x (c+1): integral of l_i l_k over the interval, exact
  Eigen::VectorXd integral;   ///< c+1: integral of l_i
  Eigen::VectorXd highest;    ///< c+1: the c-th derivative of sum u_i l_i is sum highest_i u_i
  double interpolation;       ///< largest |prod (sigma - node_i)| / (c+1)!: of the error between mesh points
  Eigen::MatrixXd end_slope;  ///< 2 x (c+1): l_i'(0), l_i'(1)
  double residual_integral;   ///< max |integral of Pi from 0 to sigma| / |Pi(0)|, Pi = prod (sigma - gauss_j)

  /// l_i(sigma) and l_i'(sigma) for i = 0..c; either may be null.
  void basis(double sigma, double* values, double* slopes) const;

 private:
  void basis_values(double sigma, double* values) const;

  int points_;
  Eigen::VectorXd nodes_;
  Eigen::VectorXd barycentric_;  // weights 1 / prod_k (node_i - node_k)
};

// The Gauss points of an orbit's mesh intervals, at which integrals over its collocation polynomials are taken.

/// Calls use(interval, Gauss point, h, h w) for segment s: the interval's length, and the point's weight in an integral
/// over tau from 0 to 1.
template <class Use>
void for_each_gauss_point(const Orbit& x, const CollocationRule& rule, int s, const Use& use) {
  const double* const mesh = x.mesh_of(s);
  for (int j = 0; j < x.shape.intervals_of(s); ++j) {
    const double h = mesh[j + 1] - mesh[j];
    for (int g = 0; g < rule.points(); ++g) use(j, g, h, h * rule.weights(g));
  }
}

/// The polynomial of interval j at Gauss point g.
inline void interpolate(const Orbit& x, const CollocationRule& rule, int s, int j, int g, double* state) {
  const double* node = x.node(s, j * x.shape.collocation);
  std::fill_n(state, x.shape.dimension, 0.0);
  for (int i = 0; i <= rule.points(); ++i)
    for (int a = 0; a < x.shape.dimension; ++a) state[a] += rule.value(g, i) * *node++;
}

/// The interval of segment s that tau is in.
int interval_at(const Orbit& x, int s, double tau);

/// The collocation polynomial of segment s (from 0) at tau in [0, 1], n.
Eigen::VectorXd state_at(const Orbit& x, const CollocationRule& rule, int s, double tau);
/// The same into `state`, n, without an allocation.
void state_at(const Orbit& x, const CollocationRule& rule, int s, double tau, double* state);

// The inner product of pseudo-arclength continuation (5.50),
//
//     <a, b> = sum_s integral_0^1 sum_i theta_i a_i b_i dtau + sum_s theta_T a_T b_T + sum_g theta_g a_g b_g,
//
// with weights theta from THU (states) and THL (durations and free parameters). Integrals are exact for the
// polynomials. For several segments the sum grows with their number, as in AUTO's multi-segment problems.

/// M of add_mass() and mass_product() for states of segment s (n x nodes) on the mesh of x: a . M v is the integral
/// of sum_i weights_i a_i v_i over its scaled time. The arguments must outlive it.
MassIntervals mass_intervals(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& weights, int s);

class WeightedNorm {
 public:
  /// `state_weights` has n entries, `parameter_weights` those of the orbit's PAR, all >= 0.
  WeightedNorm(Eigen::VectorXd state_weights, ParameterVector parameter_weights);
  /// All weights 1, for orbits of this shape and a problem of at most 60 parameters.
  static WeightedNorm unit(const OrbitShape& shape);

  /// The dual vector <v, .> on the mesh of x, written to `row`. Returns its value on v, <v, v>.
  double dual(const Orbit& x, const CollocationRule& rule, const std::vector<int>& free_parameters,
              const OrbitVector& v, OrbitVector& row) const;

 private:
  Eigen::VectorXd state_weights_;
  ParameterVector parameter_weights_;
};

// How far collocation polynomials are from the orbit that they stand for, seen by their residual.
//
// On an interval of length h in tau the polynomial p(sigma) of degree c satisfies the equations at the c Gauss points;
// between them r(sigma) = p'(sigma) - h T f(p(sigma)) does not vanish. Where the mesh resolves the orbit, r is Pi, the
// polynomial with its zeros at the Gauss points, times a constant, and the error that arises on the interval is
//
//     e(sigma) = integral of r from 0 to sigma,    |e| <= |r(0)| max |integral of Pi| / |Pi(0)|,
//
// which is h^(c+1) |u^(c+1)| times a constant (Ascher, Mattheij and Russell, Numerical Solution of Boundary Value
// Problems, 5.4). Where it does not, derivatives of p say nothing of those of the orbit, but r still says how far p is
// from a solution. The ends of the intervals are looked at, where |r| is largest. Collocation does not ask for the
// field there: where it has no value, as a root on a surface has none, the other ends tell.

/// The largest |e| of all intervals and components, relative to 1 + max |u|; 0 for equilibria, infinite where a state
/// is not finite. Segments of zero duration have none.
double estimated_error(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const CollocationRule& rule);

/// Calls work with the dimension as a compile-time number where that is a common one: the loops over states are the
/// innermost ones and short.
template <class Work>
auto with_dimension(int n, Work&& work) {
  switch (n) {
    case 2:
      return work(std::integral_constant<int, 2>{});
    case 3:
      return work(std::integral_constant<int, 3>{});
    case 4:
      return work(std::integral_constant<int, 4>{});
    case 5:
      return work(std::integral_constant<int, 5>{});
    case 6:
      return work(std::integral_constant<int, 6>{});
    default:
      return work(n);
  }
}

}  // namespace tchat
