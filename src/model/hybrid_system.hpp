/// A hybrid dynamical system as the rest of tchat uses it, and central differences for derivatives that its table
/// lacks.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "tchat/problem.h"

namespace tchat {

// A hybrid dynamical system as the rest of tchat sees it: fields f_i, event functions h_j and jumps g_k with their
// derivatives, over a problem table (plugin, or a class compiled into a test); and, for boundary value problems, the
// boundary conditions and integrands that the problem has of its own.
//
// Indices count from 1. x has `dimension()` entries, par is a ParameterVector's data (layout().room() entries).
// Matrices are column-major. Evaluation never allocates and never throws; a function that cannot be evaluated gives
// entries that are not finite, which callers check (`all_finite`).

enum class FunctionKind { field = TCHAT_FIELD, event = TCHAT_EVENT, jump = TCHAT_JUMP, integrand = TCHAT_INTEGRAND };

/// A larger number of states or conditions is an input error: memory would not suffice.
inline constexpr int most_states = 100'000;

/// The ends of the segments of an orbit, n x m each, and PAR with the durations, for the boundary conditions.
struct OrbitEnds {
  int segments;
  const double* starts;
  const double* ends;
  const double* par;
};

/// The units in which the states of a problem are taken (model/scaled_problem.hpp), and how large its parameters are.
struct Scales {
  Eigen::VectorXd units;       ///< of states, n: what their value 1 is in the units of the user
  Eigen::VectorXd parameters;  ///< sizes of PAR(1), ... (HybridSystem::parameter_size())
};

class HybridSystem {
 public:
  /// A view of a table that outlives this object. Throws std::invalid_argument when the table is not usable
  /// (ABI version, sizes out of range, missing functions).
  /// `scales` outlive it as well; null: units and sizes are 1.
  explicit HybridSystem(const tchat_problem& table, const Scales* scales = nullptr);

  int dimension() const { return table_->dimension; }
  /// May modes have fewer states? The others of those are zero there.
  bool has_modes() const { return table_->field_dimensions != nullptr; }
  /// The states of the mode of a field.
  int dimension_of(int field) const { return has_modes() ? table_->field_dimensions[field - 1] : dimension(); }
  int parameters() const { return table_->parameters; }
  /// Where PAR has the parameters and where the durations begin.
  ParameterLayout layout() const { return ParameterLayout(parameters()); }
  /// How many functions of a kind there are; integrands are one for each segment, whatever their number.
  int count(FunctionKind kind) const;
  /// How many values a function of a kind has.
  int rows(FunctionKind kind) const {
    if (kind == FunctionKind::event) return 1;
    return kind == FunctionKind::integrand ? table_->integral_conditions : table_->dimension;
  }
  int boundary_conditions() const { return table_->boundary_conditions; }
  int integral_conditions() const { return table_->integral_conditions; }
  /// Which fields slide on the surface of an event function, as far as the problem tells.
  std::span<const tchat_sliding> sliding_modes() const {
    return {table_->sliding, static_cast<std::size_t>(table_->sliding_modes)};
  }
  /// The mode that a field belongs to; null when it is none that slides.
  const tchat_sliding* sliding_mode(int field) const;
  /// The chatter mode that has this jump as its limit; null if the problem lists none.
  const tchat_chatter* chatter_with_limit(int jump) const;
  /// The one with this field for its time in contact.
  const tchat_chatter* chatter_in_contact(int field) const;
  /// The one whose impacts are such events.
  const tchat_chatter* chatter_of_impact(const IndexVector& index) const;
  /// Is this segment of a signature an impact that others follow up to their limit?
  bool comes_before_limit(const Signature& signature, std::size_t at) const;
  /// Those segments of a signature, from 0, that are neither such impacts nor that limit, of which an orbit may have
  /// more or fewer.
  std::vector<std::size_t> without_chatter(const Signature& signature) const;
  /// Is it the limit, the margin or the time of a chatter mode, for which impacts are computed, or its jump after
  /// contact?
  bool is_made_by_chatter(FunctionKind kind, int index) const;
  const tchat_problem& table() const { return *table_; }

  /// What a value 1 of state k, from 1, is in the units of its user.
  double unit_of(int k) const { return scales_ == nullptr ? 1.0 : scales_->units(k - 1); }
  /// Against which a change of parameter k, from 1, is small where it has this value: |value| and the size that the
  /// parameter is known to have; 1 if none, or another quantity.
  double parameter_size(int k, double value) const {
    const bool is_known = scales_ != nullptr && k >= 1 && k <= scales_->parameters.size();
    return (is_known ? scales_->parameters(k - 1) : 1.0) + std::abs(value);
  }

  std::string name() const { return table_->name; }
  /// User's name or "U(k)", "PAR(k)", "field i", ... ; k counts from 1. Durations are "T1", ..., and the rotation
  /// number of tori is "rho".
  std::string state_name(int k) const;
  std::string parameter_name(int k) const;
  std::string function_name(FunctionKind kind, int index) const;
  /// 1-based index of a parameter by its name, "rho" among them; 0 if there is none.
  int parameter_index(const std::string& name) const;

  /// out = F(x, p), rows(kind) entries. The index of an integrand is the number of its segment. Jump 0 is the identity,
  /// here and in the derivatives; no problem sees it.
  void value(FunctionKind kind, int index, const double* x, const double* par, double* out) const {
    if (is_identity(kind, index))
      std::copy_n(x, dimension(), out);
    else
      table_->value(table_->self, static_cast<int>(kind), index, x, par, out);
  }
  double event(int j, const double* x, const double* par) const {
    double h = 0.0;
    value(FunctionKind::event, j, x, par, &h);
    return h;
  }

  /// Does the problem have an index jump function?
  bool has_successors() const { return table_->successors != nullptr; }
  /// The index vectors that may follow a segment `from` that ends, before its jump, at x; from = (0, 0, 0): those at a
  /// start x. The one with priority first. Nothing when the problem has no such function or it cannot be evaluated.
  std::optional<std::vector<IndexVector>> successors(const IndexVector& from, const double* x, const double* par) const;
  /// The same into `to`, three numbers each, without allocation: how many there are, negative where they are not known.
  int successors(const IndexVector& from, const double* x, const double* par, std::span<std::int32_t> to) const;

  /// F, F_x (rows x dimension) and F_p (rows x active.size()); `active` lists PAR indices from 1. Central differences
  /// where the table has no derivatives.
  void first(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active, double* out,
             double* dx, double* dp) const;

  /// The same at `points` points, their arrays one behind the other.
  void first_at_points(FunctionKind kind, int index, int points, const double* x, const double* par,
                       std::span<const int> active, double* out, double* dx, double* dp) const;

  /// Does the problem give them at four points side by side?
  bool has_first_in_lanes() const { return table_->derivative_order >= 1 && table_->first_in_lanes != nullptr; }
  /// If it does, the same at `sets` sets of four points: entry k of the point in lane l is number 4 k + l of its set's
  /// arrays. No jumps.
  void first_in_lanes(FunctionKind kind, int index, int sets, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp) const {
    table_->first_in_lanes(table_->self, static_cast<int>(kind), index, sets, x, par, active.data(),
                           static_cast<int>(active.size()), out, dx, dp);
  }

  /// D = F_x v + F_p w and its derivatives by x and the active parameters; direction = (v, w).
  void second(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active,
              const double* direction, double* out, double* dx, double* dp) const;

  /// The coefficients (tchat_problem::third) of F along states x_m, m = 0..7, that depend on three numbers whose
  /// squares are left out: 8 dimension() numbers to 8 rows(kind). Where the table has none they are made of second
  /// derivatives and a difference of these, good to about 1e-8; that allocates.
  void third(FunctionKind kind, int index, const double* x, const double* par, double* out) const;
  /// The same at `points` points, their arrays one behind the other.
  void third_at_points(FunctionKind kind, int index, int points, const double* x, const double* par, double* out) const;
  bool has_third() const { return table_->third != nullptr; }

  /// The boundary conditions: boundary_conditions() values.
  void boundary(const OrbitEnds& at, double* out) const {
    table_->boundary(table_->self, at.segments, at.starts, at.ends, at.par, out);
  }
  /// With their derivatives (rows: conditions) by all starts, all ends (n m columns each) and the active entries of
  /// PAR, durations among them.
  void boundary_first(const OrbitEnds& at, std::span<const int> active, double* out, double* dstarts, double* dends,
                      double* dp) const;

 private:
  bool is_identity(FunctionKind kind, int index) const { return kind == FunctionKind::jump && index == no_function; }

  const tchat_problem* table_;
  const Scales* scales_;
};

/// The least number of states that a mode of the signature has: an orbit has this many multipliers; the others are
/// zero.
int least_dimension(const HybridSystem& system, const Signature& signature);

/// True when no entry is NaN or infinite.
inline bool all_finite(const double* values, int count) {
  // The sum of x - x is zero exactly when every entry is finite; one pass without branches.
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += values[i] - values[i];
  return sum == 0.0;
}

// Central differences for problem tables that supply fewer derivatives than are needed (GCIDIFF 0 or 1).
//
// Same shapes as HybridSystem::first and ::second. A derivative by one variable comes from six values at distances h,
// 2h, 3h: its error is of order h^6, near rounding / h = 1e-13 where the function varies on a scale of 1. The result
// is compared with the one of fourth order from the same values; where they disagree or are not finite, h is reduced.

/// F by value, F_x and F_p by differences of F.
void difference_first(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp);

/// dF/dPAR(k) by differences of F: `rows` numbers.
void difference_by_parameter(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                             const double* par, int k, double* column);

/// D = F_x v + F_p w, its derivatives by differences of D. D comes from first derivatives where the table has them,
/// else it is itself a difference along (v, w).
void difference_second(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                       std::span<const int> active, const double* direction, double* out, double* dx, double* dp);

/// HybridSystem::third, the third derivatives by a difference of second ones, of fourth order.
void difference_third(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      double* out);

/// The derivatives of the boundary conditions, shapes as in HybridSystem::boundary_first, by differences of them.
void difference_boundary(const HybridSystem& system, const OrbitEnds& at, std::span<const int> active, double* out,
                         double* dstarts, double* dends, double* dp);

}  // namespace tchat
