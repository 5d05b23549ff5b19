/// Problems in the Fortran interface of TC-HAT: their sizes, their subroutines, and the problem table that wraps them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// How many states and functions a problem has, for plugins that cannot say it themselves (Fortran): the constants file
// knows.

struct ProblemSizes {
  int dimension = 1;            ///< n
  int parameters = 0;           ///< largest PAR index of a free parameter that is no duration
  int segments = 1;             ///< of the orbit; starting values are asked for each
  int derivative_order = 0;     ///< of the derivatives coded by hand: 0, 1 or 2
  int boundary_conditions = 0;  ///< of boundary value problems: NBC
  int integral_conditions = 0;  ///< and NINT
  /// Indices that the orbit uses, ascending; the plugin has functions 1 .. the last of them.
  std::vector<int> fields, events, jumps;

  /// Adds the functions of an index vector.
  void add(const IndexVector& index);
  void add_jump(int k);
};

/// NDIM, ICP, GCIDIFF, NBC and NINT where the problem type reads them, and the indices in GCFIND, GCHIND, GCHGRZIND,
/// GCGIND; GRJUMP where the problem type reads it.
ProblemSizes problem_sizes(const RunSettings& settings);

// The subroutines of a Fortran plugin and the arrays that they are called with.
//
// Every call gets copies of x and PAR; outputs are preset (values to a NaN that no computation gives, derivatives that
// are read afterwards to zero) and have room behind them, so that what a subroutine leaves unset or writes too much
// can be told. See FortranCalls for the argument lists.

class FortranCalls {
 public:
  /// Looks the subroutines up in the library; throws UserError, naming `path`, when one that the sizes make necessary
  /// is missing. Room for second derivatives only if their order is 2 or n is not large.
  FortranCalls(const std::string& path, void* library, const ProblemSizes& sizes);

  /// F and, by `order`, its derivatives of order 1 and 2; those by parameters for the `active` ones only.
  void evaluate(FunctionKind kind, int index, const double* x, const double* par, int order,
                std::span<const int> active);

  // Results of the last evaluate(); rows, states and PAR indices count from 0.
  const double* value() const { return value_; }
  const double* by_state() const { return dx_; }                               // rows x n
  const double* by_parameter(int k) const { return dp_ + column(k) * rows_; }  // rows
  double by_states(int i, int j, int k) const { return dxx_[i + rows_ * (j + n_ * k)]; }
  double by_state_and_parameter(int i, int j, int k) const { return dxp_[i + rows_ * (j + n_ * column(k))]; }
  /// GCBCND at the ends of all segments: the conditions and, with `order` 1, their derivatives.
  void boundary(const OrbitEnds& at, int order);
  // Results of the last boundary(): one for each condition, and columns of as many.
  const double* conditions() const { return &conditions_[0]; }
  const double* by_starts() const { return &by_starts_[0]; }
  const double* by_ends() const { return &by_ends_[0]; }
  const double* by_boundary_parameter(int k) const { return &by_par_[static_cast<std::size_t>(k * count_)]; }
  bool left_condition_unset(int i) const { return is_unset(conditions_[static_cast<std::size_t>(i)]); }
  bool wrote_beyond_conditions() const;

  /// Did the last evaluate() leave entry i unset, or write beyond its last entry?
  bool left_unset(int i) const;
  bool wrote_beyond() const;

  /// GCNPAR: how many parameters the problem has; 0 where the library does not say.
  static int parameter_count(const std::string& path, void* library);
  bool has_starting_values() const { return starting_values_ != nullptr; }
  bool has_output_parameters() const { return output_parameters_ != nullptr; }
  /// GCSTPNT for a segment, from 1: entries of `par` and `x` that it does not set stay as they are.
  void starting_values(int segment, double* x, double* par);
  /// GCPVLS for a segment, from 1, at its end x.
  void output_parameters(int segment, const double* x, double* par);

  /// The preset of values, and whether a number is that.
  static double unset();
  static bool is_unset(double value);

 private:
  /// The subroutines know par_room_ entries of PAR, of which they set nothing at the last.
  std::ptrdiff_t column(int k) const { return std::min(k, par_room_ - 1); }

  using Integer = int;
  using Derivatives = void (*)(Integer*, double*, double*, Integer*, double*, double*, double*, double*, double*,
                               Integer*);
  using Jump = void (*)(Integer*, double*, double*, double*, double*, double*, double*, Integer*);
  using Boundary = void (*)(Integer*, Integer*, double*, double*, double*, Integer*, Integer*, double*, double*,
                            double*, double*);
  using StartingValues = void (*)(Integer*, double*, double*, double*, Integer*);
  using OutputParameters = void (*)(Integer*, double*, double*, Integer*);

  struct Free {
    void operator()(double* memory) const;
  };

  void load(const double* x, const double* par);
  void clear_derivatives(int order, std::span<const int> active);

  int n_;
  int rows_ = 1;
  int value_room_;
  int par_room_;
  Derivatives field_ = nullptr, event_ = nullptr, integrand_ = nullptr;
  Jump jump_ = nullptr;
  StartingValues starting_values_ = nullptr;
  OutputParameters output_parameters_ = nullptr;
  Boundary boundary_ = nullptr;
  int integrals_;  // NINT
  int count_;      // NBC
  std::vector<double> starts_, ends_, conditions_, by_starts_, by_ends_, by_par_;

  std::unique_ptr<double, Free> memory_;
  double *x_, *par_, *value_, *dx_, *dp_, *dxx_, *dxp_;  // in memory_
};

/// True when the library exports one of the required subroutines.
bool is_fortran_problem(void* library);

// A problem in the Fortran interface of TC-HAT, wrapped as a problem table.
//
// The library exports subroutines (gfortran's names: lower case with an underscore; every argument by reference,
// arrays column-major). With N = GCNDIM and PAR of at least 512 entries, or as many more as a problem of more than 60
// parameters needs:
//
//     GCFUNC (GCNDIM, X, PAR, GCIDIFF, FI, DFIDX, DFIDP, DFIDXDX, DFIDXDP, SEGNO)     field SEGNO
//         FI(N), DFIDX(N,N), DFIDP(N,*), DFIDXDX(N,N,N), DFIDXDP(N,N,*)
//     GCBOUND(GCNDIM, X, PAR, GCIDIFF, H, DHDX, DHDP, DHDXX, DHDXDP, SEGNO)           event function SEGNO
//         H, DHDX(N), DHDP(*), DHDXX(N,N), DHDXDP(N,*)
//     JUMPMAP(GCNDIM, U1, PAR, UJUMP, COEFFRES, UJUMPDX, UJUMPDP, SEGNO)              jump SEGNO
//         UJUMP(N), UJUMPDX(N,N), UJUMPDP(N,*)
//     GCBCND (GCNDIM, NSEG, X0, X1, PAR, GCIDIFF, NBC, FB, DFBDX0, DFBDX1, DFBDP)     boundary conditions (IPS = 4)
//         X0(N,NSEG), X1(N,NSEG), FB(NBC), DFBDX0(NBC,N,NSEG), DFBDX1(NBC,N,NSEG), DFBDP(NBC,*)
//     GCICND (GCNDIM, X, PAR, GCIDIFF, FI, DFIDX, DFIDP, DFIDXDX, DFIDXDP, SEGNO)     integrands on segment SEGNO
//         FI(NINT), DFIDX(NINT,N), DFIDP(NINT,*), DFIDXDX(NINT,N,N), DFIDXDP(NINT,N,*)
//     GCSTPNT(GCNDIM, X, PAR, T, SEGNO)    optional: starting values of PAR, durations included, and a state
//     GCNPAR (NPAR)                        optional: the number of parameters; beyond 60 the durations follow them
//     GCPVLS (GCNDIM, X, PAR, SEGNO)       optional: sets entries of PAR that are output; X where segment SEGNO ends
//
// Values are NaN before a call and derivatives zero, so that an output left unset is seen and only nonzero derivatives
// need be set. What such a library cannot give (second derivatives of jumps and by two parameters; parameter
// derivatives of jumps, where it leaves zeros) is filled by central differences of what it gives.
//
// The sizes come from the constants file. A library written for another N is refused: each function in use is tried
// once, with room behind its arguments and outputs.

class FortranProblem {
 public:
  /// Looks up the subroutines, asks for starting values and tries every function in use. `path` names the plugin in
  /// messages; the library outlives this object. Throws UserError.
  FortranProblem(const std::string& path, void* library, const ProblemSizes& sizes);
  FortranProblem(const FortranProblem&) = delete;
  FortranProblem& operator=(const FortranProblem&) = delete;
  ~FortranProblem() = default;

  const tchat_problem& table() const { return table_; }

 private:
  void read_starting_values(const std::string& path);
  void fill_table();
  void add_conditions();
  void try_functions(const std::string& path) const;
  void try_function(const std::string& path, FunctionKind kind, int index) const;
  void try_boundary(const std::string& path) const;
  int rows(FunctionKind kind) const {
    return kind == FunctionKind::event       ? 1
           : kind == FunctionKind::integrand ? sizes_.integral_conditions
                                             : sizes_.dimension;
  }

  void first(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active, double* out,
             double* dx, double* dp) const;
  void second(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active,
              const double* direction, double* out, double* dx, double* dp) const;

  ProblemSizes sizes_;
  std::string name_;
  mutable FortranCalls calls_;
  std::vector<double> parameters_, durations_;  // starting values
  std::vector<double> state_;                   // n, a starting state, or a generic one
  tchat_problem table_{};
  tchat_problem first_order_{};  // the same without second derivatives, for differences of first ones
  std::optional<HybridSystem> first_order_system_;
};

}  // namespace tchat
