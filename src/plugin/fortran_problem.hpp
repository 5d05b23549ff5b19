/// A problem in the Fortran interface of TC-HAT, wrapped as a problem table.
///
/// The library exports subroutines (gfortran's names: lower case with an underscore; every argument by reference,
/// arrays column-major). With N = GCNDIM and PAR of at least 512 entries, or as many more as a problem of more than 60
/// parameters needs:
///
///     GCFUNC (GCNDIM, X, PAR, GCIDIFF, FI, DFIDX, DFIDP, DFIDXDX, DFIDXDP, SEGNO)     field SEGNO
///         FI(N), DFIDX(N,N), DFIDP(N,*), DFIDXDX(N,N,N), DFIDXDP(N,N,*)
///     GCBOUND(GCNDIM, X, PAR, GCIDIFF, H, DHDX, DHDP, DHDXX, DHDXDP, SEGNO)           event function SEGNO
///         H, DHDX(N), DHDP(*), DHDXX(N,N), DHDXDP(N,*)
///     JUMPMAP(GCNDIM, U1, PAR, UJUMP, COEFFRES, UJUMPDX, UJUMPDP, SEGNO)              jump SEGNO
///         UJUMP(N), UJUMPDX(N,N), UJUMPDP(N,*)
///     GCBCND (GCNDIM, NSEG, X0, X1, PAR, GCIDIFF, NBC, FB, DFBDX0, DFBDX1, DFBDP)     boundary conditions (IPS = 4)
///         X0(N,NSEG), X1(N,NSEG), FB(NBC), DFBDX0(NBC,N,NSEG), DFBDX1(NBC,N,NSEG), DFBDP(NBC,*)
///     GCICND (GCNDIM, X, PAR, GCIDIFF, FI, DFIDX, DFIDP, DFIDXDX, DFIDXDP, SEGNO)     integrands on segment SEGNO
///         FI(NINT), DFIDX(NINT,N), DFIDP(NINT,*), DFIDXDX(NINT,N,N), DFIDXDP(NINT,N,*)
///     GCSTPNT(GCNDIM, X, PAR, T, SEGNO)    optional: starting values of PAR, durations included, and a state
///     GCNPAR (NPAR)                        optional: the number of parameters; beyond 60 the durations follow them
///     GCPVLS (GCNDIM, X, PAR, SEGNO)       optional: sets entries of PAR that are output; X where segment SEGNO ends
///
/// Values are NaN before a call and derivatives zero, so that an output left unset is seen and only nonzero derivatives
/// need be set. What such a library cannot give (second derivatives of jumps and by two parameters; parameter
/// derivatives of jumps, where it leaves zeros) is filled by central differences of what it gives.
///
/// The sizes come from the constants file. A library written for another N is refused: each function in use is tried
/// once, with room behind its arguments and outputs.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "plugin/fortran_calls.hpp"
#include "plugin/problem_sizes.hpp"

namespace tchat {

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
