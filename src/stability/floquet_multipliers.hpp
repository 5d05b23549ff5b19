/// Floquet multipliers of the hybrid return map, saltation included, without dividing by the transversality.
///
/// A perturbation v of x_s(0) leaves segment s as w = Phi_s v + sigma_s f with h_x w = 0 (sigma_s is the change of the
/// duration) and enters the next segment as g_x w; eliminating sigma_s gives (2.26). Here Phi_s stays in the condensed
/// form A_s v + C_s (Phi_s v) = 0, so the step from segment to segment is
///
///     C_s w_s - sigma_s C_s f = -A_s g_{s-1,x} w_{s-1},     h_x w_s = 0.
///
/// With w_s = Z_s c_s (the columns of Z_s span the kernel of h_x) and the rows projected by F_s orthogonal to C_s f,
///
///     E_s c_s = A'_s c_{s-1},   E_s = F_s^T C_s Z_s,   A'_s = -F_s^T A_s g_{s-1,x} Z_{s-1}      ((n-1) x (n-1))
///
/// and the n - 1 nontrivial multipliers are the eigenvalues of the product of E_s^-1 A'_s (periodic QZ). E_s is
/// singular exactly at grazing, h_x f = 0, where one multiplier is infinite and the others remain what they are. But
/// where A'_{s+1} annihilates the same vector (in the plane; at a section that the orbit touches; where a curve of
/// folds or period doublings ends at grazing) the pencil is singular, and a multiplier has a finite limit that cannot
/// be read off it any more: it is 0/0. Such a one is known by what an error of the orbit's size makes of it.
///
/// The projection removes the structural zero multiplier. What is printed in its place is its size as the
/// discretisation sees it: how far Phi_s f(x_s(0)) misses f(x_s(1)), relatively, on the worst segment. It is 0 for the
/// exact flow, and an error figure of the mesh.
#pragma once

#include <complex>
#include <vector>

#include "bvp/condensed_system.hpp"
#include "stability/periodic_qz.hpp"

namespace tchat {

/// What is printed for a multiplier that is infinite (grazing) or too large for files.
inline constexpr double infinite_multiplier = 1e99;

struct FloquetMultipliers {
  /// n multipliers, the structural zero among them: the one closest to 1 first, then by | |mu| - 1 |.
  std::vector<std::complex<double>> values;
  double structural = 0.0;  ///< size of the structural zero
  bool valid = false;       ///< false: not computed, or the eigenvalue iteration failed
  /// Nontrivial multipliers that are left out of `values`: where h_x f = 0 they may be 0/0, and what comes out is
  /// noise.
  int undetermined = 0;

  bool determined() const { return valid && undetermined == 0; }

  /// All |mu| <= 1 + 1e-5 of those that are known.
  bool stable() const;
  int stable_count() const;
};

/// Workspace for one defining system and shape; compute() may be called at every point.
class FloquetSolver {
 public:
  explicit FloquetSolver(const OrbitShape& shape);

  /// `condensed` holds the linearisation at x.
  FloquetMultipliers compute(const CondensedSystem& condensed, const Orbit& x);

 private:
  struct SegmentEnd;
  std::vector<std::complex<double>> eigenvalues(double disturbance);
  void leave_out_undetermined(FloquetMultipliers& result);

  OrbitShape shape_;
  std::vector<Eigen::MatrixXd> a_;  // A'_s
  std::vector<Eigen::MatrixXd> e_;  // E_s
  std::vector<double> a_sizes_;     // of the blocks before their projection
  std::vector<double> e_sizes_;
  PeriodicQz qz_;
};

}  // namespace tchat
