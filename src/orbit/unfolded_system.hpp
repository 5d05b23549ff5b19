/// A ring of segments whose conditions are unfolded: b phi_r is added to coupling row r,
///
///     F_r(x, T, p) + b phi_r = 0,
///
/// with one more free parameter b, PAR(ParameterLayout::unfolding(m)). Where the derivative of F has lost one rank for
/// all values of the parameters, as at the branch points of a symmetric system, b phi with a phi outside of its range
/// makes it regular, and b comes out as zero (orbit/critical_branch_point.hpp).
///
/// phi belongs to the point that a step goes from, like the border of a condition: the solutions with b = 0 do not
/// depend on it.
#pragma once

#include <memory>

#include "orbit/defining_system.hpp"

namespace tchat {

class UnfoldedSystem final : public DefiningSystem {
 public:
  /// `ring` has the unfolding parameter as the last of its free ones.
  explicit UnfoldedSystem(std::unique_ptr<DefiningSystem> ring);

  /// Number of coupling rows.
  int rows() const { return static_cast<int>(direction_.size()); }
  /// phi, rows() numbers. Evaluations that follow have it.
  void unfold_along(const std::vector<double>& direction) const { direction_ = direction; }
  const std::vector<double>& direction() const { return direction_; }

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;
  std::optional<double> unfolding(const Orbit& x) const override { return x.par(layout().unfolding(segments()) - 1); }
  int coupling_rows(int s) const override { return ring_->coupling_rows(s); }
  void coupling_pattern(int s, CouplingPattern& pattern) const override;
  void coupling_values(int s, const Orbit& x, double* values) const override;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const override;
  std::string coupling_name(int s, int r) const override { return ring_->coupling_name(s, r); }
  std::string coupling_failure(int s, const Orbit& x) const override { return ring_->coupling_failure(s, x); }
  int integral_conditions() const override { return ring_->integral_conditions(); }
  void integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                       double* values) const override {
    ring_->integral_values(x, reference, rule, values);
  }
  void integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule, double* values,
                          std::span<OrbitVector> rows) const override {
    ring_->integral_gradients(x, reference, rule, values, rows);
  }
  std::string integral_name(int r) const override { return ring_->integral_name(r); }
  void section_gradient(int s, const double* x, const double* par, double* gradient) const override {
    ring_->section_gradient(s, x, par, gradient);
  }

 private:
  const double* direction_of(int s) const { return direction_.data() + first_rows_[static_cast<std::size_t>(s)]; }
  void add(int s, const Orbit& x, double* values) const;

  std::unique_ptr<DefiningSystem> ring_;
  std::vector<std::ptrdiff_t> first_rows_;  // of each group
  mutable std::vector<double> direction_;
};

}  // namespace tchat
