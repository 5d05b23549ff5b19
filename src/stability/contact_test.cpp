#include "stability/contact_test.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <cmath>

#include "model/event_at.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

ContactTest::ContactTest(const DefiningSystem& system, int segment, int event, bool stop)
    : system_(system), segment_(segment), event_(event), stop_(stop) {}

std::string ContactTest::name() const { return fmt::format("least h{} on segment {}", event_, segment_ + 1); }

std::optional<EventMinimum> ContactTest::least(const TestedPoint& point) const {
  return least_value(system_, point.condensed.rule(), point.orbit, segment_, event_);
}

/// Courses are in the order of segments.
const EventCourse* ContactTest::known_course(const TestedPoint& point) const {
  auto course = std::lower_bound(point.courses.begin(), point.courses.end(), segment_,
                                 [](const EventCourse& one, int segment) { return one.segment < segment; });
  for (; course != point.courses.end() && course->segment == segment_; ++course)
    if (course->event == event_) return &*course;
  return nullptr;
}

std::optional<double> ContactTest::least_h(const TestedPoint& point) const {
  if (const EventCourse* const course = known_course(point))
    return tchat::least_h(system_, point.condensed.rule(), point.orbit, *course);
  const auto contact = least(point);
  return contact ? std::optional(contact->value) : std::nullopt;
}

TestValue ContactTest::evaluate(const TestedPoint& point) const {
  const std::optional<double> contact = least_h(point);
  if (!contact) return TestValue::undefined(sign_without_minimum(point.orbit));
  const EventCourse* const course = known_course(point);
  const double scale = course != nullptr ? scale_of(system_.system(), point.orbit, *course)
                                         : event_scale(system_.system(), point.orbit, event_);
  return TestValue::of(*contact, orbit_accuracy * scale);
}

/// Between pinned ends h may rise and fall without a minimum in between: no contact, positive.
int ContactTest::sign_without_minimum(const Orbit& x) const {
  if (!(x.duration(segment_) > 0.0)) return 0;
  for (int k = 1; k + 1 < x.shape.nodes_of(segment_); ++k)
    if (system_.system().event(event_, x.node(segment_, k), x.par.data()) > 0.0) return 1;
  return 0;
}

/// At an end of the segment h may pass zero with a slope: its surface is met there, where another event cuts the orbit.
bool ContactTest::crosses(const TestedPoint& point, const EventMinimum& contact) const {
  if (contact.tau > 0.0 && contact.tau < 1.0) return false;
  const int field = system_.signature()[static_cast<std::size_t>(segment_)].field;
  const EventAt at = event_at(system_.system(), event_, field, contact.state.data(), point.orbit.par.data());
  return std::abs(at.rate()) > tangent_contact * at.sizes();
}

SpecialPoint ContactTest::vanishing_segment(bool ends_branch) const {
  const int own = system_.signature()[static_cast<std::size_t>(segment_)].event;
  const auto name = [this](int event) {
    return fmt::format("event {} ({})", event, system_.system().function_name(FunctionKind::event, event));
  };
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, 1.0},
          ends_branch,
          fmt::format("two events at once: segment {}, which ends in {}, has shrunk to T = 0{}", segment_ + 1,
                      name(own), own == event_ ? "" : " on the surface of " + name(event_))};
}

SpecialPoint ContactTest::classify(const TestedPoint& point, bool rising) const {
  const std::optional<EventMinimum> contact = least(point);
  const bool ends_branch = stop_ && !rising;
  // Where the segment lasts no time every point of it is the contact.
  if (lasts_no_time(point.orbit, segment_)) return vanishing_segment(ends_branch);
  const std::string where = fmt::format("event {} ({}) inside segment {}", event_,
                                        system_.system().function_name(FunctionKind::event, event_), segment_ + 1);
  if (!contact)
    return {PointType::user,
            {UserPointKind::contact, segment_ + 1, event_, 0.0},
            ends_branch,
            "grazing: contact with " + where};
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, contact->tau},
          ends_branch,
          fmt::format("{} with {}, tau = {:.10g}, {}",
                      crosses(point, *contact) ? "two events at once: crossing" : "grazing: contact", where,
                      contact->tau, state_text(system_.system(), point.orbit, contact->state.data()))};
}

}  // namespace tchat
