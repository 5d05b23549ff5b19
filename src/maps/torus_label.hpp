/// The torus of a label (orbit/torus_system.hpp) as closed curves on sections, for composite maps: its curve, the
/// derivative of that and rho come from the solution of equations, nothing is simulated.
///
/// The events that end the segments of its return are sections, v_s(phi) = x_s(1; phi) the curve on that of segment s,
/// a trigonometric polynomial through N values. On P, h_P = 0, which need be none of them, points are collected
/// along one motion on the computed torus, u(phi_0 + k rho), k = 0, 1, ..., each from the mesh point before it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "files/solution_file.hpp"
#include "maps/invariant_curve.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "orbit/torus_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

class TorusLabel {
 public:
  /// `source` is for messages. Throws UserError where the label does not belong to the constants.
  TorusLabel(const HybridSystem& system, const LabelledSolution& solution, const RunSettings& settings,
             std::string source);

  /// What one segment's end is a section for.
  struct Section {
    int event, field, jump;
    InvariantCurve curve;
    Eigen::MatrixXd points;  ///< u at the N phases
  };
  /// Of each event function once, in the order of the segments.
  const std::vector<Section>& sections() const { return sections_; }
  const ParameterVector& par() const { return orbit_.par; }
  double rotation() const { return orbit_.par.rotation(); }
  int orbits() const { return torus_.orbits(); }
  const std::string& source() const { return source_; }

  /// Where event function `wall` is least along trajectories of a field: n x count, in the order in which one motion
  /// comes there. Throws UserError where it is so nowhere.
  Eigen::MatrixXd points_on_p(int wall, int field, int count) const;

 private:
  std::vector<Eigen::VectorXd> wall_contacts(int wall, int field, double phi) const;
  Eigen::VectorXd on_p(int wall, int field, const Eigen::VectorXd& from, double duration) const;

  const HybridSystem& system_;
  RunSettings settings_;
  std::string source_;
  Orbit orbit_;
  TorusSystem torus_;
  std::vector<Section> sections_;
};

}  // namespace tchat
