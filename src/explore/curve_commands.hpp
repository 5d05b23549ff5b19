/// The commands of curves in two parameters, as jobs.
#pragma once

#include <string>

#include "explore/exploration_commands.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

/// A labelled point of grazing orbits where xi_n = 0.
struct ResonantPoint {
  std::string curve;
  int label = 0;
  int returns = 1;  ///< n
};

class CurveCommands {
 public:
  /// `commands` must outlive this; `par` are the parameters of the diagram over one. Throws UserError where --and has
  /// no range, or not one of a parameter, or one without the value at which the diagram is.
  CurveCommands(const ExploreRequest& request, const ExplorationCommands& commands, const HybridSystem& system,
                const ParameterVector& par);

  /// Of Q; its `parameter` is the name.
  const SweptRange& second() const { return second_; }
  /// Of Q in PAR.
  int second_index() const { return index_; }
  /// The largest n of the points with xi_n = 0 that are used.
  int returns() const { return returns_; }
  /// By the line of a CurveCommand (run/run_remarks.hpp), from a label of the files `source`, in both directions.
  /// `rests`: of equilibria, which have no monitors.
  CommandJob curve(const std::string& name, const std::string& command, const std::string& source, bool rests) const;
  /// Beside a point of a grazing curve, in the direction of `sign` along it: orbits with one impact in n returns over
  /// P.
  CommandJob slice(const ResonantPoint& at, int sign) const;

 private:
  std::string free_parameters(bool rests) const;
  double largest_step() const;

  const ExplorationCommands& commands_;
  int returns_;
  SweptRange second_;
  int index_ = 0;
};

}  // namespace tchat
