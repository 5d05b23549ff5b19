/// What a simulation writes: O.trajectory, the states along every segment, and O.events, what happened at its end and
/// near-grazing contacts on the way.
///
/// O.trajectory, after a '#' heading, an empty line between segments:
///
///     segment  i  j  k  t  U(1) .. U(n)              (i, j, k) ended the segment; j = k = 0: nothing has
///
/// O.events, one line for each:
///
///     segment  i  j  k  t  h  h_x f  U(1) .. U(n) before  U(1) .. U(n) after the jump  what
///
/// what: `event`; `event+2` when event function 2 came to zero at the same time; `contact`, a minimum of h near zero;
/// `violation`, a monitored h that fell below zero; `beyond`, a wall already behind the start of a segment. Where
/// nothing ended the segment k = 0, and the state after is the state before.
#pragma once

#include <string>

#include "hybrid/hybrid_system.hpp"
#include "output/replaced_file.hpp"
#include "simulation/hybrid_simulation.hpp"

namespace tchat {

class SimulationFiles {
 public:
  /// Opens both under temporary names. `heading` is one line: which problem, which parameters.
  SimulationFiles(const HybridSystem& system, const std::string& name, const std::string& heading,
                  const Eigen::VectorXd& par);

  void write(const SimulatedSegment& segment);
  void finish();

  /// O.trajectory, O.events
  static std::string trajectory_path(const std::string& name) { return name + ".trajectory"; }
  static std::string events_path(const std::string& name) { return name + ".events"; }

 private:
  const HybridSystem& system_;
  Eigen::VectorXd par_;
  ReplacedFile trajectory_;
  ReplacedFile events_;
  bool is_first_ = true;
};

}  // namespace tchat
