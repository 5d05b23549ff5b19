/// What a problem type adds to collocation: the conditions that tie the segments of an orbit together.
///
/// Every problem type continues orbits of a signature I_1..I_m: on each segment the collocated field (5.29), and rows
/// that couple the ends of segments. A problem type says which rows these are, and which problem parameters are free.
/// Unless it says otherwise they are those of a ring: scalar conditions at the end of each segment, and the
/// connectivity x_{s+1}(0) = g_{k_s}(x_s(1)) (cyclic, so the last one is periodicity, 5.5-5.7).
///
/// Count. Unknowns: n m functions, m durations, q free problem parameters. Conditions: R coupling rows and b border
/// conditions (pseudo-arclength and any others). Well posed when n m + m + q = R + b; in a ring R = n m + E, E the sum
/// of the end conditions.
#pragma once

#include <string>
#include <vector>

#include "bvp/coupling.hpp"
#include "bvp/orbit.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

class DefiningSystem {
 public:
  /// `free_parameters`: PAR indices of the free problem parameters, durations not among them.
  DefiningSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
      : system_(system), signature_(std::move(signature)), free_parameters_(std::move(free_parameters)) {}
  virtual ~DefiningSystem() = default;

  const HybridSystem& system() const { return system_; }
  const Signature& signature() const { return signature_; }
  const std::vector<int>& free_parameters() const { return free_parameters_; }
  int dimension() const { return system_.dimension(); }
  int segments() const { return static_cast<int>(signature_.size()); }
  int free_count() const { return static_cast<int>(free_parameters_.size()); }

  // The coupling rows, in m groups (some may be empty): group s stands behind the condensed rows of segment s.
  // Evaluation allocates at its first call at most.

  virtual int coupling_rows(int s) const { return end_conditions(s) + dimension(); }
  /// Where the derivatives of group s stand.
  virtual void coupling_pattern(int s, CouplingPattern& pattern) const;
  /// The rows of group s at x, each zero on an orbit.
  virtual void coupling_values(int s, const Orbit& x, double* values) const;
  /// The same with the derivatives in the order of the pattern; returns the place behind the last one.
  virtual double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const;
  /// What row r of group s says, for messages.
  virtual std::string coupling_name(int s, int r) const;

  // The conditions at the ends of the segments of a ring.

  /// Number of scalar conditions on x_s(1), s = 0..m-1.
  virtual int end_conditions(int s) const = 0;
  /// Their values (end_conditions(s) numbers), each zero on an orbit.
  virtual void end_values(int s, const double* x, const double* par, double* values) const = 0;
  /// Values with derivatives: dx is end_conditions(s) x n, dp is end_conditions(s) x free_count(), column-major.
  virtual void end_derivatives(int s, const double* x, const double* par, double* values, double* dx,
                               double* dp) const = 0;
  /// What condition r at the end of segment s says, for messages.
  virtual std::string end_condition_name(int s, int r) const = 0;
  /// Gradient (n) of the section that ends segment s, on which its part of the return map is taken: that of the
  /// terminal event, unless the problem type says otherwise.
  virtual void section_gradient(int s, const double* x, const double* par, double* gradient) const;

 private:
  HybridSystem system_;
  Signature signature_;
  std::vector<int> free_parameters_;
  mutable std::vector<double> value_, by_state_, by_parameter_;  // of one group, for Newton's loop is not to allocate
};

}  // namespace tchat
