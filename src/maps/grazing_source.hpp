/// Where the analysis of grazing and composite maps start: labels, states given by hand, and points of a section.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "maps/grazing_orbit.hpp"
#include "maps/grazing_point.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// One `tchat grazing`: what the command line says, before any file is read.

struct GrazingRequest {
  std::string name;  ///< q-file, by path or by the name of its run; with `state` the problem
  std::optional<std::string> label;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::vector<std::string> overrides;    ///< KEY=VALUE, of a state given by hand

  std::optional<std::string> state;  ///< "0,0.1" or "x1=0.1,x2=3": a grazing point given by hand
  std::optional<std::string> mode;   ///< "1,1,1": its field, event function and jump
  bool correct = false;              ///< move it onto h_D = h_P = 0

  std::optional<int> jump;               ///< that contact brings
  std::optional<std::string> parameter;  ///< by which the orbit is moved to the contact, and impacting orbits are born
  std::optional<std::string> section;    ///< P': an event function by number or name, or a state by name

  int returns = 20;           ///< how many xi_n
  int born = 5;               ///< impacting orbits up to so many returns
  double penetration = 1e-2;  ///< the largest of those compared
};

// Where `tchat grazing` finds its orbit or point: a label of a q-file, or a state given by hand.

/// The labelled orbit cut at its contact. `jump`: the one that contact brings, where the user names it; otherwise the
/// problem or GRJUMP says. `parameter`: PAR index that moves the orbit; 0: the first free one of the run. Throws
/// UserError, beginning with `source`, for a label that is no grazing orbit, one with several contacts, and one whose
/// contact coincides with another event.
ContactTurn contact_turn(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                         std::optional<int> jump, int parameter, const std::string& source);

/// An event function by number or name ("3", "h3"), or a state by name. Throws UserError with what there is.
CrossSection cross_section(const HybridSystem& system, const std::string& text);

/// The orbit's own Poincare section, where x* lies on it and it is not P itself.
std::optional<CrossSection> own_section(const RunSettings& settings, const HybridSystem& system,
                                        const GrazingPoint& point);

// Points of a section from a file: O.events of a simulation, or O.sweep.

struct SectionPoints {
  int event = 0;           ///< the event function that fell through zero there
  int field = 1;           ///< of the flow that came in
  Eigen::MatrixXd states;  ///< before the jump, n x K, in the order of time
};

/// Those of each event function that there are points of, in the order of their numbers; of `event` alone where that is
/// not 0. Throws UserError with file, line and cure: no such file, not one of `system`, no point of that event.
std::vector<SectionPoints> read_section_points(const HybridSystem& system, const std::string& path, int event);

}  // namespace tchat
