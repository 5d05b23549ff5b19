/// Grazing contact inside a segment: psi, the least value of an event function along a segment
/// (orbit/event_minima.hpp), undefined where that has no candidate.
#pragma once

#include "orbit/event_minima.hpp"
#include "stability/test_function.hpp"

namespace tchat {

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

}  // namespace tchat
