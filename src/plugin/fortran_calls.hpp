/// The subroutines of a Fortran plugin and the arrays that they are called with.
///
/// Every call gets copies of x and PAR; outputs are preset (values to a NaN that no computation gives, derivatives that
/// are read afterwards to zero) and have room behind them, so that what a subroutine leaves unset or writes too much
/// can be told. See fortran_problem.hpp for the argument lists.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "plugin/problem_sizes.hpp"

namespace tchat {

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

}  // namespace tchat
