/// Runs of invariant tori: their problem types, settings and starts.
#pragma once

#include <optional>

#include "run/branch_setup.hpp"

namespace tchat {

// Runs of invariant tori (orbit/torus_system.hpp): their settings, and how they begin.
//
// The constants describe one return. What is computed are N = 2 Q + 1 orbits of it, so the settings of the run have N
// times as many segments; the constants that are written down (r.O) stay those of one return, and N is told by the
// segments of the labels.
//
// ISW = -1 at a torus bifurcation: the return map has M v = e^(i theta) v at the orbit x*, and the torus of small
// amplitude e is
//
//     u(phi) = x* + e Re(v e^(2 pi i phi)) + O(e^2),     rho = theta / (2 pi) + O(e^2),     0 < rho < 1/2.
//
// The first torus is corrected on the plane across d = Re(v e^(2 pi i phi)), <d, x - x*> = e, which the periodic orbit
// does not meet, e = |DS| or less where that does not converge. Both signs of DS are the same torus, half a turn
// further.

class ProblemType;
class TorusSystem;

/// The settings of `orbits` returns: segments, monitored events and weights of durations repeated.
RunSettings settings_of_orbits(const RunSettings& one_return, int orbits);

/// A run from a label or data of a torus of as many orbits as these have, or NHARM wants. Throws UserError where a
/// segment of the signature has no event.
BranchSetup continue_torus(const ProblemType& type, const HybridSystem& system, const RunSettings& settings,
                           const SelectedStart& selected);

/// From a torus bifurcation. Throws UserError where the start is none, ComputationError when no torus is found.
BranchSetup begin_torus(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

/// The harmonics that a torus needs whose last ones are not as small as HARMTOL asks for, or are smaller than needed by
/// far; nothing where they fit.
std::optional<int> fitting_harmonics(const RunSettings& one_return, const TorusSystem& system, const Orbit& x);

/// Why the branch ends, where as many harmonics as there may be leave out too much: the torus loses its smoothness.
/// Else
/// "".
std::string rough_torus(const RunSettings& one_return, const TorusSystem& system, const Orbit& x);

/// The branch from `last` on with another number of orbits; without a follower when that does not converge.
BranchSetup with_harmonics(const BranchSetup& setup, const TorusSystem& system, const PathPoint& last, int harmonics);

class TorusSystem;

class TorusProblem final : public ProblemType {
 public:
  /// The curve that tori of this shape make; `one_return`: the settings as the user gave them. Throws UserError where
  /// they do not say what the curve keeps.
  using MakeCurve = BranchCurve (*)(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);

  TorusProblem(const ProblemFacts& facts, MakeCurve make_curve) : ProblemType(facts), make_curve_(make_curve) {}

  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override;
  /// As many orbits as the start has.
  BranchSetup prepare(const HybridSystem& system, const RunSettings& one_return,
                      const SelectedStart& start) const override;

 private:
  MakeCurve make_curve_;
};

/// Tori, without a further condition.
BranchCurve free_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);
/// Tori in grazing contact (stability/torus_contact.hpp) with the first chosen event.
BranchCurve touching_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return);

/// A monitored event function on a segment (from 0) of the return.
struct MonitoredEvent {
  int segment;
  int event;
};

/// Those that GCIPSI chooses, in its order; all of GCHGRZIND with an empty GCIPSI.
std::vector<MonitoredEvent> chosen_events(const RunSettings& settings, int segments_per_return);

}  // namespace tchat
