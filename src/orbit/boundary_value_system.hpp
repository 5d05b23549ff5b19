/// Problem type 4: a boundary value problem of m segments with conditions of the problem's own (5.6).
///
///     x_s' = T_s f_{i_s}(x_s, p)                                                         s = 1..m
///     b(x_1(0), .., x_m(0), x_1(1), .., x_m(1), T_1, .., T_m, p) = 0                     NBC conditions
///     sum over s of T_s integral_0^1 q_s(x_s, T_1, .., T_m, p) dtau = 0                  NINT conditions
///
/// There is no ring. Unknowns: n m functions, d durations that are free, q problem parameters. Conditions: NBC + NINT
/// and pseudo-arclength. Well posed when n m + d + q = NBC + NINT + 1. A duration that is not free has a row of its
/// own, which keeps it.
///
/// Integrals are those of the collocation polynomials by the Gauss points of their intervals.
#pragma once

#include "orbit/defining_system.hpp"

namespace tchat {

class BoundaryValueSystem final : public DefiningSystem {
 public:
  /// `free_durations`: m flags.
  BoundaryValueSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters,
                      std::vector<bool> free_durations);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;
  int coupling_rows(int s) const override { return kept_rows(s) + boundary_rows(s); }
  void coupling_pattern(int s, CouplingPattern& pattern) const override;
  void coupling_values(int s, const Orbit& x, double* values) const override;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const override;
  std::string coupling_name(int s, int r) const override;
  std::string coupling_failure(int s, const Orbit& x) const override;

  int integral_conditions() const override { return system().integral_conditions(); }
  void integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                       double* values) const override;
  void integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule, double* values,
                          std::span<OrbitVector> rows) const override;
  std::string integral_name(int r) const override;
  std::string integral_failure(int s, double tau, const double* x, const double* par) const override;

 private:
  int kept_rows(int s) const { return free_durations_[static_cast<std::size_t>(s)] ? 0 : 1; }
  /// All boundary conditions stand behind the last segment.
  int boundary_rows(int s) const { return s == segments() - 1 ? system().boundary_conditions() : 0; }
  OrbitEnds ends_of(const Orbit& x) const;

  std::vector<bool> free_durations_;
  std::vector<int> active_;  // all durations, then the free parameters
  // scratch, kept because Newton's loop is not to allocate
  mutable std::vector<double> starts_, ends_;                       // n m
  mutable std::vector<double> by_starts_, by_ends_, by_parameter_;  // NBC rows
  mutable std::vector<double> state_, q_, q_by_state_, q_by_parameter_;
};

}  // namespace tchat
