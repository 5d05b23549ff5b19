/// The equations besides collocation: what a problem type adds, the rows that couple segments, the conditions of
/// curves, and what failed if one of them could not be evaluated.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/scales.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// What a problem type adds to collocation: the conditions that tie the segments of an orbit together.
//
// Every problem type continues orbits of a signature I_1..I_m: on each segment the collocated field (5.29), rows that
// couple the ends of segments, and integral conditions over the whole orbit. A problem type says which these are, and
// which problem parameters are free. Those of a ring of segments are in ring_system.hpp.
//
// Count. Unknowns: n m functions, m durations, q free problem parameters. Conditions: R coupling rows, I integral
// conditions and b further border conditions (pseudo-arclength and that of a two-parameter curve). Well posed when
// n m + m + q = R + I + b.

class BranchAnalysis;
class CouplingPattern;

class DefiningSystem {
 public:
  /// `free_parameters`: PAR indices of the free problem parameters, durations not among them.
  DefiningSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);
  virtual ~DefiningSystem() = default;

  const HybridSystem& system() const { return system_; }
  const Signature& signature() const { return signature_; }
  const std::vector<int>& free_parameters() const { return free_parameters_; }
  int dimension() const { return system_.dimension(); }
  ParameterLayout layout() const { return system_.layout(); }
  /// How many orbits of one return each are coupled: several lie on a torus (torus_system.hpp).
  virtual int orbits() const { return 1; }
  /// What a branch of solutions of this shape needs while it is computed. Defined with the system's family
  /// (src/kinds), which alone knows the classes of analyses.
  virtual std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const = 0;
  int segments() const { return static_cast<int>(signature_.size()); }
  /// The states of the mode of segment s (from 0); those beyond are zero.
  int dimension_of(int s) const { return system_.dimension_of(signature_[static_cast<std::size_t>(s)].field); }
  /// Sets rows of a jump (dimension() each, column by column) at the end of segment s to zero for states that the mode
  /// after it has not. The identity does not do this itself.
  void clear_absent(int s, double* rows, int columns) const {
    if (!system_.has_modes()) return;
    for (int c = 0; c < columns; ++c)
      for (int a = dimension_of((s + 1) % segments()); a < dimension(); ++a) rows[c * dimension() + a] = 0.0;
  }
  /// Does an event end segment s?
  bool has_event(int s) const { return signature_[static_cast<std::size_t>(s)].event != no_function; }
  /// Does segment s begin and end on one surface (model/events.hpp)?
  bool is_contact_segment(int s) const { return contact_segments_[static_cast<std::size_t>(s)]; }
  int free_count() const { return static_cast<int>(free_parameters_.size()); }

  // The coupling rows, in m groups (some may be empty): group s stands behind the condensed rows of segment s.
  // Evaluation allocates at its first call at most.

  virtual int coupling_rows(int s) const = 0;
  /// Where the derivatives of group s stand.
  virtual void coupling_pattern(int s, CouplingPattern& pattern) const = 0;
  /// The rows of group s at x, each zero on an orbit.
  virtual void coupling_values(int s, const Orbit& x, double* values) const = 0;
  /// The same with the derivatives in the order of the pattern; returns the place behind the last one.
  virtual double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const = 0;
  /// What row r of group s says, for messages.
  virtual std::string coupling_name(int s, int r) const = 0;
  /// What a value 1 of that row is in the units of the user: where it is a state or its rate, the state's unit.
  virtual double coupling_unit(int /*s*/, int /*r*/) const { return 1.0; }
  /// A function of the coupling rows of group s, or a derivative of it, that is not finite at x: what and where, else
  /// "".
  virtual std::string coupling_failure(int s, const Orbit& x) const = 0;

  // Conditions on the whole orbit that are integrals of functions of the states; none unless a type has some. The
  // reference is the orbit that a step goes from, on the same mesh: phases are compared with it.

  virtual int integral_conditions() const { return 0; }
  /// Their values, each zero on an orbit.
  virtual void integral_values(const Orbit& /*x*/, const Orbit& /*reference*/, const CollocationRule&,
                               double* /*values*/) const {}
  /// Values and gradients: `rows` holds one dual vector for each, overwritten.
  virtual void integral_gradients(const Orbit& /*x*/, const Orbit& /*reference*/, const CollocationRule&,
                                  double* /*values*/, std::span<OrbitVector> /*rows*/) const {}
  virtual std::string integral_name(int) const { return {}; }
  /// A function in them, or a derivative of it, that is not finite at x, a point of segment s at tau: what and where,
  /// else "".
  virtual std::string integral_failure(int /*s*/, double /*tau*/, const double* /*x*/, const double* /*par*/) const {
    return {};
  }

  /// Gradient (n) of the section that ends segment s, on which its part of the return map is taken: that of the
  /// terminal event, unless the problem type says otherwise; zero where there is no section.
  virtual void section_gradient(int s, const double* x, const double* par, double* gradient) const;

  /// How many functions of the state orbits keep: as many multipliers are 1 on every orbit, beside those of all orbits.
  virtual int conserved_quantities() const { return 0; }
  /// A free parameter that is zero at every solution, for it unfolds equations that depend on each other.
  virtual std::optional<double> unfolding(const Orbit& /*x*/) const { return std::nullopt; }
  /// Why a solution of the equations is none of the problem, as a sentence with a cure; "" if it is one.
  virtual std::string why_no_solution(const Orbit& /*x*/) const { return {}; }

  /// A function of the points of a branch in one parameter whose sign is that of the bordered determinant and that
  /// vanishes where it does, `tangent` at x given; nothing where that of Newton's own matrix will do.
  virtual std::optional<double> singular_distance(const Orbit& /*x*/, const OrbitVector& /*tangent*/) const {
    return std::nullopt;
  }
  /// The null vectors across the `tangent` of the known branch at a branch point x, the nearest to one first: several
  /// where a symmetry makes them equal. None where Newton's own matrix is to give them.
  virtual std::vector<OrbitVector> crossing_directions(const Orbit& /*x*/, const OrbitVector& /*tangent*/) const {
    return {};
  }

 private:
  HybridSystem system_;
  Signature signature_;
  std::vector<int> free_parameters_;
  std::vector<bool> contact_segments_;
};

/// The size of free parameter g, from 0, of x, against which a change of it is small.
inline double parameter_size(const DefiningSystem& system, const Orbit& x, int g) {
  const int k = system.free_parameters()[static_cast<std::size_t>(g)];
  return system.system().parameter_size(k, x.par(k - 1));
}

/// Durations of x are small against this and their own: the time that one return of the orbits takes, 1 if none.
inline double time_size(const DefiningSystem& system, const Orbit& x) {
  const double turn = x.par.durations(x.shape.segments).cwiseAbs().sum() / system.orbits();
  return turn > 0.0 ? turn : 1.0;
}

// The rows that tie the ends of segments together, as a problem type gives them to the condensed system.

/// The unknowns that are left when each segment is condensed: x_s(0), x_s(1), T_s of one segment after the other, then
/// the free problem parameters.
struct EndUnknowns {
  int dimension;
  int segments;

  int start(int s) const { return s * (2 * dimension + 1); }
  int end(int s) const { return start(s) + dimension; }
  int duration(int s) const { return start(s) + 2 * dimension; }
  int global(int g) const { return segments * (2 * dimension + 1) + g; }
};

/// Collects where the derivatives of rows stand. Their values are given later in the order of these calls, row by row
/// within each of them. `row` counts from `first_row`.
class CouplingPattern {
 public:
  CouplingPattern(const EndUnknowns& unknowns, int globals, int first_row, std::vector<int>& rows,
                  std::vector<int>& columns)
      : unknowns_(unknowns), globals_(globals), first_row_(first_row), rows_(rows), columns_(columns) {}

  /// `count` rows in all of x_s(0), of x_s(1), in T_s, in the free problem parameters, in one of them.
  void start(int row, int count, int s) { dense(row, count, unknowns_.start(s), unknowns_.dimension); }
  void end(int row, int count, int s) { dense(row, count, unknowns_.end(s), unknowns_.dimension); }
  void duration(int row, int count, int s) { dense(row, count, unknowns_.duration(s), 1); }
  void globals(int row, int count) { dense(row, count, unknowns_.global(0), globals_); }
  void global(int row, int count, int g) { dense(row, count, unknowns_.global(g), 1); }
  /// n rows, each in its own component of x_s(0).
  void start_components(int row, int s) {
    for (int a = 0; a < unknowns_.dimension; ++a) put(row + a, unknowns_.start(s) + a);
  }

 private:
  void dense(int row, int count, int column, int columns) {
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < columns; ++b) put(row + a, column + b);
  }
  void put(int row, int column) {
    rows_.push_back(first_row_ + row);
    columns_.push_back(column);
  }

  EndUnknowns unknowns_;
  int globals_;
  int first_row_;
  std::vector<int>& rows_;
  std::vector<int>& columns_;
};

// Which function of the problem could not be evaluated on an orbit, for messages.

/// The first field, event function or jump whose value or derivatives are not finite at a point where the boundary
/// value problem evaluates it, with its index, place and state; empty when there is none.
std::string evaluation_failure(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x);

/// The same for one function at one state, tau on segment s (from 0).
std::string function_failure(const DefiningSystem& system, FunctionKind kind, int index, int s, double tau,
                             const double* x, const double* par);

// What a curve in two parameters adds to the equations of one solution.

class CondensedSystem;

/// The vectors of a multiplier at the ends of segments, of any length: S(mu) right = 0, left S(mu) = 0
/// (return_map.hpp).
struct CriticalVectors {
  std::complex<double> multiplier;
  Eigen::VectorXcd right, left;
};

/// A function G of the orbit, durations and free parameters, of a few numbers, with its gradients.
class OrbitCondition {
 public:
  static constexpr int most = 5;

  virtual ~OrbitCondition() = default;
  /// How many numbers; constant.
  virtual int count() const { return 1; }
  /// G and its gradients at x, whose linearisation is in `condensed`. False when they cannot be found.
  virtual bool evaluate(CondensedSystem& condensed, const Orbit& x) = 0;
  /// Of number k = 0 .. count() - 1.
  virtual double value(int k) const = 0;
  virtual const OrbitVector& gradient(int k) const = 0;
  /// The multiplier that is kept exactly, where it is one number: 1 or -1.
  virtual std::optional<int> kept_multiplier() const { return std::nullopt; }
  /// The vectors of the multiplier that is kept on the unit circle, in the closed upper half plane, at the point of the
  /// last evaluation. False where there is no such multiplier.
  virtual bool put_critical_vectors(CriticalVectors& /*vectors*/) const { return false; }
  /// "" on the curve, or why the last point, which solves the equations, lies beyond its end.
  virtual std::string beyond_end() const { return {}; }

  /// What evaluations near the point of the last one begin from; `memory` is overwritten, empty before the first one.
  virtual void remember(std::vector<double>& memory) const = 0;
  virtual void recall(const std::vector<double>& memory) = 0;
};

/// What linearisations near a point of the branch begin from; empty without a condition.
using ConditionMemory = std::vector<double>;

}  // namespace tchat
