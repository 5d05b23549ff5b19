/// What a problem type adds to collocation: the conditions that tie the segments of an orbit together.
///
/// Every problem type continues orbits of a signature I_1..I_m: on each segment the collocated field (5.29), rows that
/// couple the ends of segments, and integral conditions over the whole orbit. A problem type says which these are, and
/// which problem parameters are free. Those of a ring of segments are in ring_system.hpp.
///
/// Count. Unknowns: n m functions, m durations, q free problem parameters. Conditions: R coupling rows, I integral
/// conditions and b further border conditions (pseudo-arclength and that of a two-parameter curve). Well posed when
/// n m + m + q = R + I + b.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

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
  /// Does segment s begin and end on one surface (model/contact_segment.hpp)?
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
  /// Sets `direction` to that of the branch that crosses the one of `tangent` at a branch point x. False where Newton's
  /// own matrix is to give it.
  virtual bool find_crossing_branch(const Orbit& /*x*/, const OrbitVector& /*tangent*/,
                                    OrbitVector& /*direction*/) const {
    return false;
  }

 private:
  HybridSystem system_;
  Signature signature_;
  std::vector<int> free_parameters_;
  std::vector<bool> contact_segments_;
};

}  // namespace tchat
