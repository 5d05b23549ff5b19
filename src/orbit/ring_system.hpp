/// Segments in a ring (5.5-5.7): conditions at the end of each segment, and the connectivity
///
///     x_{s+1}(0) = g_{k_s}(x_s(1), p)     (s cyclic, so the last one is periodicity).
///
/// Coupling rows: R = n m + E, E the sum of the end conditions.
///
/// A segment that begins and ends on one surface (model/contact_segment.hpp) has its one end condition divided by its
/// duration (contact_row.hpp): that it may last no time is then no singularity. Where all segments are such ones, as
/// when an orbit is cut at its contact alone, the first that is not far shorter than the longest keeps h = 0, else
/// nothing says where the surface is. Which one that is changes no solution and no sign of the determinant: the rows
/// differ by combinations with each other and the connectivity, and by factors 1 / T_s.
#pragma once

#include "orbit/contact_row.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

class RingSystem : public DefiningSystem {
 public:
  RingSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;

  int coupling_rows(int s) const final { return end_conditions(s) + dimension(); }
  void coupling_pattern(int s, CouplingPattern& pattern) const final;
  void coupling_values(int s, const Orbit& x, double* values) const final;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const final;
  std::string coupling_name(int s, int r) const final;
  std::string coupling_failure(int s, const Orbit& x) const final;

  /// Is the end condition of segment s divided by its duration at x?
  bool is_divided(int s, const Orbit& x) const;

  /// Number of scalar conditions on x_s(1), s = 0..m-1.
  virtual int end_conditions(int s) const = 0;
  /// Their values (end_conditions(s) numbers), each zero on an orbit.
  virtual void end_values(int s, const double* x, const double* par, double* values) const = 0;
  /// Values with derivatives: dx is end_conditions(s) x n, dp is end_conditions(s) x free_count(), column-major.
  virtual void end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                               double* dp) const = 0;
  /// What condition r at the end of segment s says, for messages.
  virtual std::string end_condition_name(int s, int r) const = 0;

 protected:
  // What the jump at the end of segment s has to be equal to (n numbers, linear in the starts of segments): the start
  // of the next segment, unless orbits are coupled otherwise.

  virtual void target_pattern(int s, int row, CouplingPattern& pattern) const;
  virtual void target_value(int s, const Orbit& x, double* target) const;
  /// Derivatives in the order of the pattern, asked for after target_value() at the same x; returns the place behind
  /// the last one.
  virtual double* target_derivatives(int s, const Orbit& x, double* entries) const;
  virtual std::string target_name(int s) const;

 private:
  /// May it be divided?
  bool is_contact(int s) const { return is_contact_segment(s) && end_conditions(s) == 1; }
  double* end_rows(int s, const Orbit& x, double* values, double* entries) const;
  void put(const std::vector<double>& columns, int row_count, int column_count, double factor, double*& entries) const;

  mutable ContactRow contact_row_;
  mutable std::vector<double> value_, by_state_, by_parameter_;  // of one group, for Newton's loop is not to allocate
};

}  // namespace tchat
