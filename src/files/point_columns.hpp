/// The columns of a p-file, in AUTO's order: the first free parameter, the solution measure, maxima of the first
/// states, the further free parameters, user functions, and last the period.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// The names of a problem that heads columns; element k - 1 names U(k), PAR(k), event function k, jump k.
struct ProblemNames {
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  std::vector<std::string> user_functions;
  std::vector<std::string> events = {};
  std::vector<std::string> jumps = {};

  static ProblemNames of(const HybridSystem& system);
  /// With the monitors of a run.
  static ProblemNames of(const HybridSystem& system, const RunSettings& settings);
  /// Of a parameter that is not the problem's own.
  void set_parameter(int k, const std::string& name);
  /// The name, or U(k), PAR(k) beyond the problem's own.
  std::string state(int k) const;
  std::string parameter(int k) const;
};

/// One column: what its number is and its heading.
struct PointColumn {
  enum class Kind {
    parameter,  ///< PAR(index)
    l2_norm,    ///< of the whole orbit, segments weighted by their durations
    maximum,    ///< of U(index) over the whole orbit; at an equilibrium U(index) itself
    minimum,
    integral,
    component_l2_norm,
    user_function,  ///< the index-th value of the problem's user functions
    period          ///< the sum of the durations
  };
  Kind kind = Kind::period;
  int index = 0;  ///< from 1; 0 where there is nothing to count
  std::string name;
  int segment = 0;  ///< from 1: the segment whose duration a parameter is; 0: of none
};

/// The measure that IPLT selects: 0 or beyond 3 n in size the L2 norm, 1..n maxima, -1..-n minima, n+1..2n integrals,
/// 2n+1..3n L2 norms of single states.
PointColumn measure_column(int selector, int dimension, const ProblemNames& names);

/// All columns of a run. `free_parameters` as in the settings, durations and output-only ones included; the number of
/// maxima is min(n, 7 - free parameters that are not durations), none when that is negative. A user function that is
/// listed as a monitor has one column. Equilibria have no period.
std::vector<PointColumn> point_columns(const RunSettings& settings, const ProblemNames& names);

}  // namespace tchat
