/// Problem type 1: equilibria, f_i(x, p) = 0.
///
/// Such an equilibrium is an orbit of one segment of no duration: with T = 0 the collocated field (5.29) says that the
/// state is the same at both nodes of the one interval (OrbitShape::point), and the rows that couple its ends are
///
///     T = 0,     f_i(x(1), p) = 0                                                        1 + n rows
///
/// Count. Unknowns: n functions, one duration, q free parameters. Conditions: 1 + n rows and the border's: with
/// pseudo-arclength q = 1, on curves of folds or Hopf points, which have one condition more, q = 2.
#pragma once

#include "orbit/defining_system.hpp"

namespace tchat {

class EquilibriumSystem final : public DefiningSystem {
 public:
  /// `signature` has one segment, of which the field counts.
  EquilibriumSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;
  int field() const { return signature().front().field; }

  int coupling_rows(int) const override { return 1 + dimension(); }
  void coupling_pattern(int s, CouplingPattern& pattern) const override;
  void coupling_values(int s, const Orbit& x, double* values) const override;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const override;
  std::string coupling_name(int s, int r) const override;
  std::string coupling_failure(int s, const Orbit& x) const override;

  /// The sign of det [f_x f_p; t^T] for one free parameter, t the tangent at x, times the least singular value of this
  /// matrix scaled: zero at branch points, of constant sign through folds. At a branch point all of a row may vanish,
  /// so that none is scaled to unit size: a row r is divided by |r| + (1 + |x| + |p|) |dr/ds|, s the arclength.
  /// Allocates.
  std::optional<double> singular_distance(const Orbit& x, const OrbitVector& tangent) const override;
  /// The null vector of that matrix. Newton's own, in which a row may be zero, need not have factors at a branch point.
  /// Allocates.
  bool find_crossing_branch(const Orbit& x, const OrbitVector& tangent, OrbitVector& direction) const override;

 private:
  mutable std::vector<double> by_state_, by_parameter_;  // n x n, n x q: scratch, as Newton's loop is not to allocate
};

}  // namespace tchat
