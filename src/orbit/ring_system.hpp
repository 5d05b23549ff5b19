/// Segments in a ring: the conditions at their ends, contact with an event surface among them, and their unfolding.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// How a flow meets an event surface at one state: h and its rate h_P = h_x f, with their derivatives.

/// Evaluation allocates nothing: the scratch is kept.
class SurfaceRate {
 public:
  /// `free_count` PAR indices are given with each evaluation.
  SurfaceRate(int dimension, int free_count);

  /// Of event function v.event under field v.field at state x. `free_parameters`: PAR indices that hp and rate_p are
  /// derivatives by. Derivatives by states that the mode of the field has not are zero.
  void evaluate(const HybridSystem& system, const IndexVector& v, const double* x, const double* par,
                const std::vector<int>& free_parameters);

  double h = 0.0;
  double rate = 0.0;  ///< h_x f
  Eigen::VectorXd hx, hp, rate_x, rate_p;

 private:
  Eigen::VectorXd f_, direction_;  // `direction_` stays zero in the parameters
  Eigen::MatrixXd fx_, fp_;
};

// The end condition of a contact segment, divided by its duration.
//
// A contact segment s (model/events.hpp) begins on the surface h_s = 0 by the end condition of the segment
// before it, and ends there. Where it lasts no time the row h_s(x_s(1)) = 0 says the same as that one, and Newton's
// matrix is singular: the orbits with contact meet those that are merely cut twice at one place, T_s = 0. Divided,
//
//     (h_s(x_s(1), p) - h_s(x_s(0), p)) / T_s = mean of h_x f along the segment = 0,
//
// it has the same solutions with T_s != 0 and at T_s = 0 it says h_x f = 0, the tangency. So one branch passes T_s = 0
// regularly, with T_s = -2 h_x f / (h_x f)_x f to first order: duration and velocity of the contact are proportional
// to the arclength there, the parameter moves like their square. Counts of equations and unknowns stay.

/// Allocates nothing after construction.
class ContactRow {
 public:
  ContactRow(int dimension, int free_count);

  /// For segment s (from 0) with index vector v.
  double value(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
               const std::vector<int>& free_parameters);
  /// With the derivatives by x_s(0), x_s(1), T_s and the free parameters, n + n + 1 + q numbers, written to `entries`;
  /// returns the place behind the last one.
  double* derivatives(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                      const std::vector<int>& free_parameters, double& value, double* entries);

 private:
  SurfaceRate start_, end_;
};

// Segments in a ring (5.5-5.7): conditions at the end of each segment, and the connectivity
//
//     x_{s+1}(0) = g_{k_s}(x_s(1), p)     (s cyclic, so the last one is periodicity).
//
// Coupling rows: R = n m + E, E the sum of the end conditions.
//
// A segment that begins and ends on one surface (model/events.hpp) has its one end condition divided by its
// duration (ContactRow): that it may last no time is then no singularity. Where all segments are such ones, as
// when an orbit is cut at its contact alone, the first that is not far shorter than the longest keeps h = 0, else
// nothing says where the surface is. Which one that is changes no solution and no sign of the determinant: the rows
// differ by combinations with each other and the connectivity, and by factors 1 / T_s.

class RingSystem : public DefiningSystem {
 public:
  RingSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;

  int coupling_rows(int s) const final { return end_conditions(s) + dimension(); }
  void coupling_pattern(int s, CouplingPattern& pattern) const final;
  void coupling_values(int s, const Orbit& x, double* values) const final;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const final;
  std::string coupling_name(int s, int r) const final;
  double coupling_unit(int s, int r) const final {
    return r < end_conditions(s) ? unit_of_end(s, r) : system().unit_of(r - end_conditions(s) + 1);
  }
  std::string coupling_failure(int s, const Orbit& x) const final;

  /// Is the end condition of segment s divided by its duration at x?
  bool is_divided(int s, const Orbit& x) const;

  // Rows of end conditions are divided by the size of their derivatives by the state where these were first asked for,
  // a power of two: a factor of an event function is to change nothing.

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
  /// The divisor of row r: 1 before the first evaluation, and where the derivatives vanish there.
  double unit_of_end(int s, int r) const;
  void find_units(int s, const Orbit& x) const;
  void put(const std::vector<double>& columns, int row_count, int column_count, double factor, double*& entries) const;

  mutable ContactRow contact_row_;
  mutable std::vector<double> value_, by_state_, by_parameter_;  // of one group, for Newton's loop is not to allocate
  mutable std::vector<std::vector<double>> units_;               // of the end conditions of each segment
};

// A ring of segments whose conditions are unfolded: b phi_r is added to coupling row r,
//
//     F_r(x, T, p) + b phi_r = 0,
//
// with one more free parameter b, PAR(ParameterLayout::unfolding(m)). Where the derivative of F has lost one rank for
// all values of the parameters, as at the branch points of a symmetric system, b phi with a phi outside of its range
// makes it regular, and b comes out as zero (orbit/curve_conditions.hpp).
//
// phi belongs to the point that a step goes from, like the border of a condition: the solutions with b = 0 do not
// depend on it.

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
  double coupling_unit(int s, int r) const override { return ring_->coupling_unit(s, r); }
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
