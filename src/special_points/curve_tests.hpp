/// Codimension-two points on fold, period-doubling and torus curves: cusp and resonances. They read the curve's
/// condition at the tested point: one of a real multiplier, on torus curves a CriticalPair.
#pragma once

#include "special_points/test_function.hpp"

namespace tchat {

/// The curve's null vector and the gradient of its condition are orthogonal: a cusp of a fold curve.
class CuspTest final : public TestFunction {
 public:
  std::string name() const override { return "cusp"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }
};

/// The critical multiplier is a double one: 1:1 resonance on fold curves, 1:2 on period-doubling curves. The
/// condition's function goes through zero with every a_s, which says nothing of the kind: it is multiplied by them once
/// more, and undefined where one is about zero.
class ResonanceTest final : public TestFunction {
 public:
  explicit ResonanceTest(PointType type) : type_(type) {}
  std::string name() const override { return type_ == PointType::resonance_1 ? "1:1 resonance" : "1:2 resonance"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {type_, {}, false, name()}; }

 private:
  PointType type_;
};

/// The angle of the critical pair on a torus curve, by its cosine, which is smooth also where the pair meets: 1:3 and
/// 1:4 resonance, and 1:1 and 1:2, where the curve ends. By symmetry the cosine may touch 1 or -1 without going beyond
/// it: the angle itself, with its sign, then goes through 0 or pi. MirroredResonanceTest and PassedResonanceTest find
/// these points.
class AngleTest final : public TestFunction {
 public:
  explicit AngleTest(PointType type) : type_(type) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override;
  SpecialPoint classify(const TestedPoint&, bool) const override;

 private:
  PointType type_;
};

/// 1:1 or 1:2 resonance where a torus curve meets its mirror image: that of an orbit without the symmetry of the
/// problem at an orbit that has it, or that of a doubled orbit at the orbit that is doubled. The angle is proportional
/// to the arclength there, and cos theta touches 1 or -1. The curve of the symmetric orbits goes through the same
/// point, so the bordered determinant changes sign; with its sign the angle goes through zero.
class MirroredResonanceTest final : public TestFunction {
 public:
  std::string name() const override { return "resonance at the mirror image"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  bool singular_at_zero() const override { return true; }
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;
};

/// 1:1 or 1:2 resonance that the angle passes, the double multiplier having two eigenvectors, as on curves of orbits
/// with a symmetry: the curve goes on. It is reported without a label, for no curve starts there.
class PassedResonanceTest final : public TestFunction {
 public:
  std::string name() const override { return "angle through 0 or pi"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_told_only() const override { return true; }
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;
};

}  // namespace tchat
