/// Invariant closed curves on a section as trigonometric polynomials of a phase.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "base/levels.hpp"

namespace tchat {

// The circle, in turns and in radians.

inline constexpr double full_turn = 6.283185307179586476925;

/// Of a phase in turns: in [0, 1).
inline double phase_fraction(double turns) { return turns - std::floor(turns); }
/// In [-1/2, 1/2).
inline double nearest_phase(double turns) { return turns - std::floor(turns + 0.5); }

// A vector function of period 1 as a trigonometric polynomial:
//
//     F(phi) = a_0 + sum_l a_l cos 2 pi l phi + b_l sin 2 pi l phi,   l = 1..Q

class TrigonometricSeries {
 public:
  TrigonometricSeries() = default;
  /// rows x (2 Q + 1), the columns a_0, a_1, b_1, a_2, b_2, ...
  explicit TrigonometricSeries(Eigen::MatrixXd coefficients) : coefficients_(std::move(coefficients)) {}
  /// Least squares at phases anywhere, rows x K values.
  static TrigonometricSeries fitted(const Eigen::MatrixXd& values, const Eigen::VectorXd& phases, int harmonics);
  /// Through values at phi = 0, 1/N, 2/N, ...; N odd, Q = (N - 1) / 2.
  static TrigonometricSeries through(const Eigen::MatrixXd& values);

  Eigen::Index rows() const { return coefficients_.rows(); }
  int harmonics() const { return static_cast<int>(coefficients_.cols() / 2); }
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

  Eigen::VectorXd operator()(double phi) const { return derivative(phi, 0); }
  /// Derivative of an order from 0.
  Eigen::VectorXd derivative(double phi, int order) const;

 private:
  Eigen::MatrixXd coefficients_;
};

// The closed invariant curve of a torus on a section, in the phase phi in which the return map is a rotation:
//
//     x = u(phi),   P(u(phi)) = u(phi + rho),   u(phi) = w phi + a_0 + sum_l a_l cos 2 pi l phi + b_l sin 2 pi l phi
//
// w is zero but for states that are angles: those grow by 2 pi (or - 2 pi) a turn of phi. A curve may come from
// anywhere; here it is fitted to points of a simulation.

class InvariantCurve {
 public:
  /// `periodic`: u - w phi; `winding`: w, n; `sizes`: of the states of the motion, n.
  InvariantCurve(double rotation, Eigen::VectorXd winding, TrigonometricSeries periodic, const Eigen::VectorXd& sizes);

  double rotation() const { return rotation_; }  ///< rho, in (0, 1)
  Eigen::Index dimension() const { return periodic_.rows(); }
  int harmonics() const { return periodic_.harmonics(); }
  const Eigen::VectorXd& winding() const { return winding_; }
  bool is_angle(Eigen::Index state) const { return winding_(state) != 0.0; }

  /// u and its derivatives by phi; any phi.
  Eigen::VectorXd at(double phi) const { return derivative(phi, 0); }
  Eigen::VectorXd derivative(double phi, int order = 1) const;
  /// x - y, in angles the way round that is shorter.
  Eigen::VectorXd difference(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const;
  /// Range of each state along the curve, of one that does not move its size; 2 pi for angles; n.
  const Eigen::VectorXd& extent() const { return extent_; }

 private:
  double rotation_;
  Eigen::VectorXd winding_;
  TrigonometricSeries periodic_;
  Eigen::VectorXd extent_;
};

struct CurveSettings {
  std::vector<Eigen::Index> angles;  ///< states, from 0, that count modulo 2 pi
  Eigen::VectorXd sizes;             ///< of the states of the motion, n; none: all alike
  int max_harmonics = 256;
  double tolerance = level::located;  ///< of the fit, relative to the extent of the curve
};

struct FittedCurve {
  InvariantCurve curve;
  double error = 0.0;           ///< largest distance of a point from u(k rho), relative to the extents
  double rotation_error = 0.0;  ///< what the points leave open
};

/// Points in the order in which a motion on the torus met the section, n x K. The rotation number is a weighted mean of
/// the lifted angle about the curve's centre, in the plane of its largest extents (or of the first of `angles`), then
/// refined with the coefficients by least squares. Throws UserError, `source` in front, when the points are too few,
/// lie on no closed curve to the tolerance, or repeat themselves (a periodic orbit).
FittedCurve fit_invariant_curve(const Eigen::MatrixXd& points, const CurveSettings& settings,
                                const std::string& source);

/// Which point of a curve stands for a point near it (the projection pi_Gamma of (3.19), (3.35), (4.12)).
class CurveProjection {
 public:
  /// What x and its point on the curve have in common.
  enum class Kind {
    nearest,  ///< the distance, states divided by their extents, is least
    angle,    ///< the angle of one state, or of a pair of states
  };
  /// The nearest point.
  explicit CurveProjection(const InvariantCurve& curve);
  /// The point with the same angle: of state `first` (counted modulo 2 pi), or of the direction (first, second),
  /// `first` being the sine. Throws UserError when the curve is no graph over that angle.
  CurveProjection(const InvariantCurve& curve, Eigen::Index first, Eigen::Index second = -1);

  /// phi in [0, 1).
  double phase(const Eigen::VectorXd& x) const;
  /// d phi / d x at a point x that is projected to phi, n.
  Eigen::RowVectorXd gradient(const Eigen::VectorXd& x, double phi) const;

 private:
  double residual(const Eigen::VectorXd& x, double phi) const;
  double slope(const Eigen::VectorXd& x, double phi) const;
  double angle(const Eigen::VectorXd& x) const;
  double nearest_sample(const Eigen::VectorXd& x) const;
  double sample_of_angle(double angle) const;
  Eigen::RowVectorXd angle_gradient(const Eigen::VectorXd& x) const;

  InvariantCurve curve_;
  Kind kind_;
  Eigen::Index first_ = -1, second_ = -1;
  Eigen::VectorXd weights_;     // 1 / extent^2
  Eigen::MatrixXd samples_;     // u at equal phases
  std::vector<double> angles_;  // of the samples in turns, going on from one to the next, and once round
};

}  // namespace tchat
