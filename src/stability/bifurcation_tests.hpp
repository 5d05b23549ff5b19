/// Test functions of the bifurcations of orbits: of smooth ones and of those of Filippov systems.
#pragma once

#include <tchat/problem.h>

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "orbit/defining_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Test functions of the bifurcations of orbits: fold, branch point, period doubling, torus.
//
// None has a pole or a gap where an impact velocity a_s = h_x f goes through zero and a multiplier through infinity:
// the product over (1 + mu) is taken with that of the a_s, as one determinant (floquet_multipliers.hpp). The branch
// point's function has the sign of the determinant of the boundary value problem bordered by the tangent, regular at
// a_s = 0 and of constant sign through folds. The determinant's size tells nothing: it has factors of the mesh and
// goes like exp(-1/2 integral of tr f_x), over many decades along a branch. The function's size is the distance to a
// singular matrix.

class DefiningSystem;
class HybridSystem;

/// LP: the component of the tangent along the principal parameter; where a section is tangent, its label (GR).
class FoldTest final : public TestFunction {
 public:
  /// `parameter` is a PAR index, of a monitor too; `free_parameters` those of the tangent's globals; `layout`: of PAR
  /// for `segments` segments; `held`: names of the monitors that are held: the curve followed turns, not the orbits of
  /// the problem.
  FoldTest(int parameter, const std::vector<int>& free_parameters, const ParameterLayout& layout, int segments,
           bool stop, PointType type = PointType::fold, std::string held = {});
  std::string name() const override { return "fold"; }
  TestValue evaluate(const TestedPoint& point) const override;
  std::string reason_to_vanish(const TestedPoint&) const override { return "ICP(1) stays the same along the branch"; }
  std::string objection(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool is_duration_;
  bool is_monitor_;
  Eigen::Index index_ = 0;
  bool stop_;
  PointType type_;
  std::string held_;
};

/// BP: the distance of the bordered problem to a singular one, with the determinant's sign.
class BranchPointTest final : public TestFunction {
 public:
  explicit BranchPointTest(bool stop, PointType type = PointType::branch_point) : stop_(stop), type_(type) {}
  std::string name() const override { return "branch point"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool singular_at_zero() const override { return true; }
  std::string objection(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool stop_;
  PointType type_;
};

/// PD: product of 1 + mu over the multipliers times the product of the scaled a_s, also where an a_s is zero: a run
/// that starts at grazing sees the period doubling beside it. Undefined while the structural multiplier is off by more
/// than 5e-2.
class PeriodDoublingTest final : public TestFunction {
 public:
  explicit PeriodDoublingTest(bool stop) : stop_(stop) {}
  std::string name() const override { return "period doubling"; }
  TestValue evaluate(const TestedPoint& point) const override;
  std::string objection(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool stop_;
};

/// BP or PD where two multipliers go through +1 or -1 together, as a symmetry makes them do: then no determinant
/// changes sign. With the real multipliers of the target's sign in order of size, x_1 >= x_2 >= ..., x_k = |mu_k| - 1:
/// the least |x_2i|, negative when an odd number of the x_2i are positive. It vanishes with one multiplier, too, which
/// is no such point. With fewer than two such multipliers: the least distance of any from the target.
class MultiplierPairTest final : public TestFunction {
 public:
  MultiplierPairTest(int target, bool stop) : target_(target), stop_(stop) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override { return Resolution::any; }
  bool singular_at_zero() const override { return target_ > 0; }
  bool is_genuine(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int target_;
  bool stop_;
};

/// TR: distance of the nearest complex pair from the unit circle, negative when an odd number of pairs is inside;
/// undefined without a pair.
class TorusTest final : public TestFunction {
 public:
  explicit TorusTest(bool stop) : stop_(stop) {}
  std::string name() const override { return "torus"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  bool stop_;
};

/// a_s = h_x f at the end of a segment: the impact velocity through zero, birth of an impacting orbit at grazing. At a
/// mere section of the orbit (identity jump, the same field after it) the section becomes tangent there; where it is
/// the beginning or the end of a contact segment, this has shrunk to nothing, in proportion to the arclength.
class ImpactVelocityTest final : public TestFunction {
 public:
  /// `segment` counts from 0. Beyond a rising zero the orbit violates the model: `stop` ends the branch there.
  ImpactVelocityTest(const DefiningSystem& system, int segment, bool stop);
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  SpecialPoint lost_contact(const TestedPoint& point, int contact, bool ends_branch) const;

  const DefiningSystem& system_;
  int segment_;
  bool stop_;
};

/// Product of 1 - mu / target over the nontrivial multipliers times the product of the scaled a_s of all segments: the
/// one function behind every multiplier +1 or -1, on curves of grazing orbits too. `target` is 1 or -1. Undefined where
/// multipliers are not trusted. Its zero level is rounding against the other factors, for it is small only with them.
TestValue multiplier_product(const TestedPoint& point, int target);
/// Is a multiplier at the target where this product vanishes? Where none goes through infinity with an a_s, as in the
/// plane, the product vanishes with that a_s.
bool is_multiplier_at(const TestedPoint& point, int target);

/// Distance of the nearest complex pair from the unit circle, negative when an odd number of pairs is inside; undefined
/// without a pair. The pair of `known`, on the circle all along a curve, is left out.
TestValue pair_distance(const TestedPoint& point, std::optional<std::complex<double>> known = std::nullopt);
/// That pair's multiplier in the upper half plane.
std::optional<std::complex<double>> nearest_pair(const TestedPoint& point,
                                                 std::optional<std::complex<double>> known = std::nullopt);

/// "x1 = 1, x2 = 0, ...": a state of `orbit`, n entries; what is below its uncertainty there is written as 0.
std::string state_text(const HybridSystem& system, const Orbit& orbit, const double* state);

// The four sliding bifurcations of orbits of Filippov systems, by the pieces that meet where something vanishes.
//
// With the fields f- and f+ on the sides of a surface h = 0 and the sliding field between them (tchat_sliding):
//
// | name              | the pieces at the point                                      | vanishes with              |
// |-------------------|--------------------------------------------------------------|----------------------------|
// | crossing-sliding  | side, sliding, other side; or side, other side               | h_x f of the side left to  |
// | grazing-sliding   | side, sliding, the same side; or one side that touches h = 0 | h_x f of that side         |
// | switching-sliding | side, other side, sliding; or side, sliding                  | h_x f of the other side    |
// | adding-sliding    | sliding, side, sliding; or sliding that touches its end      | h_x f of that side         |
//
// where the piece in the middle lasts no time. It is the surroundings that tell them apart: what is located are zeros
// of contacts, of h_x f at the ends of segments, and of SlidingOnsetTest.

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
