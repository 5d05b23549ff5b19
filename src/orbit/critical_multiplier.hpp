/// Defining condition of fold and period-doubling curves: the orbit has the multiplier mu = +1 or -1 (5.11-5.22).
///
/// The augmented hybrid system asks for v with v' = T f_x v + sigma f on each segment, h_x v_s(1) = 0,
/// v_{s+1}(0) = g_x v_s(1) and mu v_1(0) = g_x v_m(1) at the end: sigma_s, the change of the duration, replaces the
/// division by h_x f of (5.13), so that nothing is singular at grazing. Instead of continuing v as n m further
/// functions, G(x) is the bordered solution of the same linear problem condensed to the ends of segments,
///
///     [ S  b ] [v]   [0]          [ S^T  c ] [w]   [0]
///     [ c' 0 ] [G] = [1],         [ b'   0 ] [G] = [1],            G = 0 exactly when S is singular,
///
/// and its gradient is -w^T (dS) v. S shares the condensed blocks of the Newton matrix: a curve costs one more small
/// sparse factorisation, two solutions and one sweep of second derivatives for each Newton matrix.
#pragma once

#include <vector>

#include "orbit/condensed_return_map.hpp"
#include "orbit/orbit_condition.hpp"

namespace tchat {

/// A condition that keeps a real multiplier.
class RealMultiplierCondition : public OrbitCondition {
 public:
  /// w_1(0)-row times v_1(0) of its null vectors: zero where the multiplier is a double one (1:1 and 1:2 resonance).
  virtual double multiplicity_function() const = 0;
};

class CriticalMultiplier final : public RealMultiplierCondition {
 public:
  /// `multiplier` is 1 or -1.
  CriticalMultiplier(const DefiningSystem& system, const OrbitShape& shape, int multiplier);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// The border b, c; empty before the first evaluation.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  std::optional<int> kept_multiplier() const override { return multiplier_; }
  bool put_critical_vectors(CriticalVectors& vectors) const override;
  /// The null vector v with the sigma_s as durations, of unit size at the ends of segments.
  const OrbitVector& null_vector() const { return v_; }
  double multiplicity_function() const override { return multiplicity_; }
  /// dG in the direction of the null vector: zero at a cusp of a fold curve.
  double cusp_function() const { return dot(gradient_, v_); }

  // Of the last evaluation, at the ends of segments, in the unknowns of CondensedReturnMap:
  /// w, its size() entries first.
  const std::vector<double>& left_null_vector() const { return small_w_; }
  /// z with S z + zeta b = column, c' z = 0; both have size() + 1 entries, the last one of `column` zero, of z zeta.
  void solve_beside(const double* column, double* z) { lu_.solve(column, z); }

 private:
  bool solve_bordered(const CondensedSystem& condensed, const Orbit& x);
  void begin_border();
  void follow_null_vectors();

  int multiplier_;
  CondensedReturnMap map_;
  SparseLu lu_;  // of the bordered S
  std::vector<double> values_;
  std::vector<double> column_;   // b
  std::vector<double> row_;      // c
  std::vector<double> small_v_;  // v and G
  std::vector<double> small_w_;  // w and G
  std::vector<double> rhs_;
  bool started_ = false;
  double value_ = 0.0;
  double multiplicity_ = 0.0;
  OrbitVector v_;
  OrbitVector gradient_;
};

}  // namespace tchat
