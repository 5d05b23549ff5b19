/// Orbits made from functions of time: closed forms, or the independent integrator.
#pragma once

#include <functional>
#include <vector>

#include "motion/orbit_flow.hpp"
#include "orbit/orbit.hpp"

namespace tchat::test {

/// One segment: its duration and its state as a function of the time since it began.
struct Piece {
  double duration = 0.0;
  std::function<Eigen::VectorXd(double)> state;
};

inline ParameterVector parameters(std::initializer_list<double> values) {
  ParameterVector par{ParameterLayout()};
  Eigen::Index k = 0;
  for (const double v : values) par(k++) = v;
  return par;
}

/// The pieces at all nodes of the mesh; durations go into PAR.
inline Orbit sampled_orbit(const std::vector<Piece>& pieces, int dimension, int intervals, int collocation,
                           const ParameterVector& par, const std::vector<double>& mesh = {}) {
  const int m = static_cast<int>(pieces.size());
  Orbit x{{dimension, m, intervals, collocation}, mesh.empty() ? uniform_mesh(intervals) : mesh, {}, par};
  x.states.resize(dimension, x.shape.columns());
  for (int s = 0; s < m; ++s) {
    const Piece& piece = pieces[static_cast<std::size_t>(s)];
    x.duration(s) = piece.duration;
    for (int k = 0; k < x.shape.nodes(); ++k)
      x.states.col(s * x.shape.nodes() + k) = piece.state(x.tau(k) * piece.duration);
  }
  return x;
}

/// The segments of a periodic orbit found by shooting, integrated node by node.
inline std::vector<Piece> pieces_of(const HybridSystem& system, const Signature& signature, const ReturnMap& map,
                                    const Eigen::VectorXd& par) {
  std::vector<Piece> pieces;
  FlowOptions options;
  options.variational = false;
  for (std::size_t s = 0; s < signature.size(); ++s) {
    const Eigen::VectorXd start = map.segments[s].start;
    const int field = signature[s].field;
    pieces.push_back({map.segments[s].duration, [&system, start, field, par, options](double t) {
                        return Eigen::VectorXd(integrate_for(system, field, start, par, t, options).end_state);
                      }});
  }
  return pieces;
}

/// Largest difference of the states at mesh points.
inline double mesh_point_distance(const Orbit& a, const Orbit& b) {
  double worst = 0.0;
  for (int s = 0; s < a.shape.segments; ++s)
    for (int k = 0; k < a.shape.nodes(); k += a.shape.collocation) {
      const Eigen::Index column = s * a.shape.nodes() + k;
      worst = std::max(worst, (a.states.col(column) - b.states.col(column)).cwiseAbs().maxCoeff());
    }
  return worst;
}

}  // namespace tchat::test
