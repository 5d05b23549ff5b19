/// Event surfaces in pictures of orbits, and the problem that they belong to.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "files/orbit_trace.hpp"
#include "model/hybrid_system.hpp"
#include "plot/figure.hpp"
#include "plugin/problem_library.hpp"

namespace tchat {

// Event surfaces in pictures of orbits: the lines h_j = 0 in the plane of two states, where h_j depends on these two
// alone, and the values of one state where h_j = 0, where it depends on that one alone.
//
// On which states h_j depends is judged by its derivatives along the orbits shown. Event functions that are but the
// time derivative of another one, up to a factor (sections through maxima), are no surfaces of the model and left out
// unless asked for. Functions with the same zeros (a multiple of another one, as h and -h) make one line with both
// names.

/// A rectangle of two states.
struct StateWindow {
  double low_x = 0.0, high_x = 1.0;
  double low_y = 0.0, high_y = 1.0;
};

/// Event functions that have the same zeros.
struct NamedEvent {
  int number = 0;    ///< of the first one
  std::string name;  ///< "wall", or "forward, back"
};

class EventSurfaces {
 public:
  /// `events`: indices from 1; empty: all that are no sections. The system outlives this object.
  EventSurfaces(const HybridSystem& system, const std::vector<OrbitTrace>& orbits, const std::vector<int>& events);

  struct Line {
    NamedEvent event;
    std::vector<std::vector<PicturePoint>> pieces;  ///< polylines
  };
  /// h_j = 0 in the plane of states a and b (from 0), for every orbit's own parameters.
  std::vector<Line> in_plane(int a, int b, const StateWindow& window) const;

  struct Level {
    NamedEvent event;
    std::vector<double> values;
  };
  /// h_j = 0 for state a alone, between low and high.
  std::vector<Level> of_state(int a, double low, double high) const;

 private:
  bool depends_only_on(int event, const std::vector<int>& states) const;
  bool is_section(int event) const;
  std::vector<NamedEvent> distinct_events(const std::vector<int>& states, const StateWindow& window) const;
  bool same_zeros(int event, int other, int a, int b, const StateWindow& window) const;
  double value(int event, const OrbitTrace& orbit, int a, double x, int b, double y) const;

  const HybridSystem& system_;
  const std::vector<OrbitTrace>& orbits_;
  std::vector<std::vector<double>> parameters_;  // of each orbit, as long as functions expect
  std::vector<int> events_;
};

// The problem that the orbits of a q-file belong to: its plugin for event surfaces, and names of states and
// parameters.

struct ProblemChoice {
  std::shared_ptr<ProblemLibrary> library;  ///< none when no plugin was named
  std::vector<std::string> states;
  std::vector<std::string> parameters;
  std::string warning;

  const HybridSystem* system() const { return library ? &library->system() : nullptr; }
};

/// The plugin that the user named with -p. A picture compiles and runs nothing on its own account: without one the
/// names come from the header of p.NAME. Throws UserError when the plugin cannot be used, or has another dimension.
ProblemChoice find_problem(const std::string& solution_path, const std::string& plugin, int dimension);

}  // namespace tchat
