/// The smooth return map near the invariant curve of a torus, where such a torus touches an event surface, and the
/// torus of a label.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "files/solution_file.hpp"
#include "maps/invariant_curve.hpp"
#include "maps/smooth_return.hpp"
#include "maps/suspended_system.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "motion/watched_flow.hpp"
#include "orbit/orbit.hpp"
#include "orbit/torus_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// P_smooth near the invariant curve of a torus (3.20), (3.33), (4.13):
//
//     P(x, p) = u(phi + rho) + A(phi) (x - u(phi)) + A_p(phi) (p - p_0) [+ second order],   phi the projection of x
//
// u(phi + rho) is exact on the curve; the derivatives are computed at equal phases by the variational equations and
// interpolated by trigonometric polynomials. Where the flow does not depend on a parameter (that of h_D alone) A_p is
// zero to rounding, and so is the torus's dependence on it.

struct TorusSettings {
  int order = 1;                       ///< or 2
  int most_nodes = 1024;               ///< phases at which derivatives are computed: doubled up to this,
  double accuracy = level::tolerance;  ///< until the highest harmonics are so small beside the largest
  /// Points of the curve lie on the section to the accuracy of the simulation alone.
  FlowOptions flow{.relative_tolerance = level::reference_flow.relative,
                   .absolute_tolerance = level::reference_flow.absolute,
                   .surface_tolerance = level::same,
                   .active = {}};
};

class TorusReturn : public SmoothMap {
 public:
  /// `par`: of the simulation that the curve comes from. `section`: an event function of `suspended`. Throws UserError
  /// when the flow does not take the curve to itself: points and parameters do not belong together; ComputationError
  /// when it cannot be integrated, or the derivatives vary too much for so many nodes.
  TorusReturn(std::shared_ptr<const SuspendedSystem> suspended, InvariantCurve curve, CurveProjection projection,
              const ParameterVector& par, int section, const TorusSettings& settings);

  Eigen::VectorXd image(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& x, const ParameterVector& par) const override;
  double time(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd difference(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const override {
    return curve_.difference(x, y);
  }
  const Eigen::VectorXd& extent() const override { return scale_; }
  double distance(const Eigen::VectorXd& x) const override;

  /// u(phi), angles between 0 and 2 pi.
  Eigen::VectorXd on_curve(double phi) const;
  const InvariantCurve& curve() const { return curve_; }
  const CurveProjection& projection() const { return projection_; }
  const ParameterVector& parameters() const { return par_; }
  int nodes() const { return nodes_; }
  /// Largest |P(u(phi)) - u(phi + rho)| at the nodes, relative to the extents.
  double defect() const { return defect_; }
  /// Of the interpolated derivatives between the nodes, relative to the largest: the size of the highest harmonics.
  double interpolation_error() const { return interpolation_error_; }
  /// Does the smooth flow, and with it the torus, depend on the parameters that it is expanded in?
  bool depends_on_parameters() const { return depends_; }
  double mean_time() const { return mean_time_; }

 private:
  Eigen::Index dimension() const { return curve_.dimension(); }
  struct Deviation {
    double phi;
    Eigen::VectorXd u;  // (x, q) less (u(phi), q_0)
  };
  struct Nodes;
  Nodes nodes_at(int count, const Nodes& known, const ParameterVector& par, int section,
                 const TorusSettings& settings) const;
  Deviation deviation(const Eigen::VectorXd& x, const ParameterVector& par) const;
  Eigen::MatrixXd matrix(double phi, int derivative) const;
  Eigen::VectorXd quadratic(double phi, const Eigen::VectorXd& u, int derivative) const;

  std::shared_ptr<const SuspendedSystem> suspended_;
  InvariantCurve curve_;
  CurveProjection projection_;
  ParameterVector par_;
  Eigen::VectorXd parameters_along_;
  Eigen::VectorXd scale_;
  TrigonometricSeries first_;   // n x N derivatives, column by column
  TrigonometricSeries second_;  // of each component the upper triangle; no rows for first order
  TrigonometricSeries times_;
  int nodes_ = 0;
  double defect_ = 0.0, interpolation_error_ = 0.0, mean_time_ = 0.0;
  bool depends_ = false;
};

// Where a torus of the smooth flow touches an event surface: the least h_D over all its trajectories.
//
// Unknowns phi, sigma and one parameter p; equations
//
//     h_P(X_0) = 0,  X_0 = Phi(u(phi), sigma),      h_{D,x}(X_0) Phi_x u'(phi) = 0,      h_D(X_0, p) = 0
//
// X_0 is where the trajectory through u(phi) meets P (2.73); on P itself sigma = 0. What the parameter does to the
// torus is not accounted for: nothing where only h_D depends on it.

struct TorusGrazing {
  double phase = 0.0;   ///< phi*
  double time = 0.0;    ///< sigma, from the section to P
  Eigen::VectorXd x;    ///< x*, on P
  ParameterVector par;  ///< with the value at which it touches
};

/// Field `field`, event function `wall`, PAR(`parameter`) moves. Throws UserError, beginning with `source`, when the
/// section does not pass through a point of least h_D, and when h_D does not depend on the parameter.
TorusGrazing torus_grazing(const HybridSystem& system, const TorusReturn& torus, int field, int wall, int parameter,
                           const std::string& source);

// The torus of a label (orbit/torus_system.hpp) as closed curves on sections, for composite maps: its curve, the
// derivative of that and rho come from the solution of equations, nothing is simulated.
//
// The events that end the segments of its return are sections, v_s(phi) = x_s(1; phi) the curve on that of segment s,
// a trigonometric polynomial through N values. On P, h_P = 0, which need be none of them, points are collected
// along one motion on the computed torus, u(phi_0 + k rho), k = 0, 1, ..., each from the mesh point before it.

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
