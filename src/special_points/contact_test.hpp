/// Grazing contact inside a segment: psi, the least value of an event function along a segment.
///
/// Candidates are the interior minima of h on the collocation polynomial and both end points. Left out are pinned ends,
/// where the boundary conditions themselves hold h at zero, and a minimum that a pinned end with the wrong slope brings
/// with it (that is the impact velocity's business). Without a candidate psi is undefined.
///
/// Minima are polished: the flow is integrated from the mesh point on their left, so that psi has the accuracy of mesh
/// points (order 2 NCOL), not that of the polynomial in between.
#pragma once

#include "special_points/test_function.hpp"

namespace tchat {

/// A least value of an event function along a segment.
struct Contact {
  double tau = 0.0;
  double value = 0.0;
  Eigen::VectorXd state;
};

/// All candidates for event function `event` on segment `s` (from 0): the ends, then minima in order.
std::vector<Contact> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s,
                                      int event);

/// The candidate with the least value for event function `event` on segment `s` (from 0); nothing without candidates.
std::optional<Contact> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x, int s,
                                   int event);

class ContactTest final : public TestFunction {
 public:
  /// `segment` counts from 0. Beyond a falling zero the orbit violates the model: `stop` ends the branch there.
  ContactTest(const DefiningSystem& system, int segment, int event, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int sign_without_minimum(const Orbit& x) const;
  SpecialPoint vanishing_segment(bool ends_branch) const;
  bool crosses(const TestedPoint& point, const Contact& contact) const;

  const DefiningSystem& system_;
  int segment_;
  int event_;
  bool stop_;
};

}  // namespace tchat
