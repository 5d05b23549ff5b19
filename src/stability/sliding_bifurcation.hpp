/// The four sliding bifurcations of orbits of Filippov systems, by the pieces that meet where something vanishes.
///
/// With the fields f- and f+ on the sides of a surface h = 0 and the sliding field between them (tchat_sliding):
///
/// | name              | the pieces at the point                                      | vanishes with              |
/// |-------------------|--------------------------------------------------------------|----------------------------|
/// | crossing-sliding  | side, sliding, other side; or side, other side               | h_x f of the side left to  |
/// | grazing-sliding   | side, sliding, the same side; or one side that touches h = 0 | h_x f of that side         |
/// | switching-sliding | side, other side, sliding; or side, sliding                  | h_x f of the other side    |
/// | adding-sliding    | sliding, side, sliding; or sliding that touches its end      | h_x f of that side         |
///
/// where the piece in the middle lasts no time. It is the surroundings that tell them apart: what is located are zeros
/// of contacts, of h_x f at the ends of segments, and of SlidingOnsetTest.
#pragma once

#include <tchat/problem.h>

#include <string>
#include <vector>

#include "orbit/defining_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

class DefiningSystem;

/// The name of the sliding bifurcation that a contact or a vanishing h_x f is, "" for what is none.
std::string sliding_bifurcation(const TestedPoint& point, const UserPointKind& kind);

/// Where a side's segment crosses the surface of a sliding mode into the other side: h_x f of the other side there, in
/// the direction that leads on, positive while the orbit crosses. At its zero sliding begins. No event function of the
/// orbit has it, as orbits that cross watch none that ends sliding.
class SlidingOnsetTest final : public TestFunction {
 public:
  /// `segment` (from 0) ends on the surface; the next one has the other field. Beyond a falling zero the orbit violates
  /// the model: `stop` ends the branch there.
  SlidingOnsetTest(const DefiningSystem& system, int segment, const tchat_sliding& mode, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int next() const { return (segment_ + 1) % system_.segments(); }
  int field_after() const;
  /// The event function that would end sliding here.
  int event() const;

  const DefiningSystem& system_;
  int segment_;
  const tchat_sliding& mode_;
  bool stop_;
};

}  // namespace tchat
