/// Grazing: contact inside a segment, the first-order response to contact at low velocity, and test functions on
/// grazing curves.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "orbit/event_minima.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Grazing contact inside a segment: psi, the least value of an event function along a segment
// (orbit/event_minima.hpp), undefined where that has no candidate.

class ContactTest final : public TestFunction {
 public:
  /// `segment` counts from 0. Beyond a falling zero the orbit violates the model: `stop` ends the branch there.
  ContactTest(const DefiningSystem& system, int segment, int event, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  std::optional<EventMinimum> least(const TestedPoint& point) const;
  const EventCourse* known_course(const TestedPoint& point) const;
  std::optional<double> least_h(const TestedPoint& point) const;
  int sign_without_minimum(const Orbit& x) const;
  SpecialPoint vanishing_segment(bool ends_branch) const;
  bool crosses(const TestedPoint& point, const EventMinimum& contact) const;

  const DefiningSystem& system_;
  int segment_;
  int event_;
  bool stop_;
};

// Where the problem's rules (lines `after EVENT if CONDITION` of formulas) change what follows the end of a segment: 1
// where the next segment of the signature may follow, -1 where it may not (orbit/admissibility.hpp).

class RuleTest final : public TestFunction {
 public:
  /// `segment` counts from 0. Beyond a falling sign the orbit violates the model: `stop` ends the branch there.
  RuleTest(const DefiningSystem& system, int segment, bool stop) : system_(system), segment_(segment), stop_(stop) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override { return Resolution::any; }
  bool is_switch() const override { return true; }
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const DefiningSystem& system_;
  int segment_;
  bool stop_;
};

// What contact of low velocity does to first order, and how it comes back (2.111-2.112, 4.22, corrected).
//
// With x* a grazing point of event surface D, h_P = h_{D,x} f, a* = h_{P,x} f > 0 and A the derivative of the return
// map from x* to x* on h_P = 0 that ignores the contact:
//
//     beta = (Id - f h_{P,x} / a*) g_{D,x} f,     xi_n = -h_{D,x} A^n beta.
//
// xi_n > 0: no new impact n returns after one of low velocity.

/// beta and how well it is known. It is a difference: where contact has no effect of first order, as in a plane or
/// where an impact only stops the approach, rounding is all that is left of its two terms.
struct ImpactDirection {
  Eigen::VectorXd beta;      ///< n
  double uncertainty = 0.0;  ///< of |beta|: orbit_accuracy |g_{D,x}| |f| (1 + |f| |h_{P,x}| / a*)

  bool is_zero() const { return !(beta.norm() > uncertainty); }
  /// beta and, in n more columns, what may be added to it: n x (1 + n).
  Eigen::MatrixXd with_errors() const;
};

/// Of f, h_{P,x} and g_{D,x} at x*.
ImpactDirection impact_direction(const Eigen::VectorXd& f, const Eigen::VectorXd& section_gradient,
                                 const Eigen::MatrixXd& jump_derivative);

struct ImpactReturn {
  double xi = 0.0;
  /// |h_x| times the larger of |A^n beta| and |A^(n-1) beta| times orbit_accuracy, and |h_x| times what the
  /// uncertainty of beta adds to A^n beta. The powers decay where A contracts, and xi_n with them: that is no zero.
  double uncertainty = 0.0;

  bool is_zero() const { return !(std::abs(xi) > uncertainty); }
};

/// xi_n of A^(n-1) and A^n times `with_errors()`.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& before,
                           const Eigen::MatrixXd& last);
/// xi_n, n >= 1. Beyond 2^-900 and 2^900 xi_n and its uncertainty stop at that size and keep their sign.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                           const ImpactDirection& direction, int n);
/// xi_1 ... xi_count likewise.
std::vector<ImpactReturn> impact_returns(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                                         const ImpactDirection& direction, int count);

// Test functions on grazing curves (problem type 150): xi_n, a*, grazing-fold, grazing-flip (2.111-2.112, 4.22,
// corrected).
//
// With x* the grazing point, h_D the event, h_P = h_{D,x} f, a* = h_{P,x} f > 0 and A the derivative of the smooth
// orbit's return map from x* to x* on h_P = 0:
//
//     beta = (Id - f h_{P,x} / a*) g_{D,x} f,     xi_n = -h_{D,x} A^n beta.
//
// xi_n > 0: no new impact n returns after one of low velocity. g_D is the jump that contact would bring (GRJUMP).

/// a* and xi_n at a point whose linearisation is in `condensed`.
struct GrazingUnfolding {
  double acceleration = 0.0;  ///< a*
  double xi = 0.0;
  double uncertainty = 0.0;     ///< of xi_n (ImpactReturn)
  bool no_square_root = false;  ///< beta = 0 within its uncertainty: there is no xi_n
};
/// beta (n) and A (n x n) at that point.
struct GrazingMatrices {
  Eigen::VectorXd beta;
  Eigen::MatrixXd return_map;
};
GrazingMatrices grazing_matrices(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                                 int jump);

/// n >= 1, or 0 for a* alone. Beyond 2^-900 and 2^900 xi_n and its uncertainty stop at that size and keep their sign.
GrazingUnfolding grazing_unfolding(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                                   int jump, int n);

/// Is this the name of one of the test functions by whose values the dynamics near grazing go: a* and xi_n?
bool reports_contact(const std::string& test_name);

class XiTest final : public TestFunction {
 public:
  XiTest(const GrazingOrbitSystem& system, int jump, int n) : system_(system), jump_(jump), n_(n) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override { return Resolution::trend; }
  std::string reason_to_vanish(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const GrazingOrbitSystem& system_;
  int jump_;
  int n_;
};

/// a* = h_{P,x} f at the contact: positive where h has a minimum there, shown at every point. At labels also x*, beta
/// and A, from which the dynamics near grazing follow.
class AccelerationTest final : public TestFunction {
 public:
  AccelerationTest(const GrazingOrbitSystem& system, int jump) : system_(system), jump_(jump) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  std::string details(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const GrazingOrbitSystem& system_;
  int jump_;
};

/// Multiplier +1 (grazing-fold) or -1 (grazing-flip) of the smooth return map: the product of all such functions,
/// without a pole where another segment's impact velocity vanishes.
class SmoothMultiplierTest final : public TestFunction {
 public:
  /// `target` is 1 or -1.
  explicit SmoothMultiplierTest(int target) : target_(target) {}
  std::string name() const override { return target_ > 0 ? "grazing-fold" : "grazing-flip"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int target_;
};

}  // namespace tchat
