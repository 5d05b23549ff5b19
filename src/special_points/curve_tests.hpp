/// Codimension-two points on fold, period-doubling and torus curves: cusp and resonances. They read the curve's
/// condition, which is evaluated at the tested point.
#pragma once

#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// The curve's null vector and the gradient of its condition are orthogonal: a cusp of a fold curve.
class CuspTest final : public TestFunction {
 public:
  explicit CuspTest(const CriticalMultiplier& condition) : condition_(condition) {}
  std::string name() const override { return "cusp"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }

 private:
  const CriticalMultiplier& condition_;
};

/// The critical multiplier is a double one: 1:1 resonance on fold curves, 1:2 on period-doubling curves. The
/// condition's function goes through zero with every a_s, which says nothing of the kind: it is multiplied by them once
/// more, and undefined where one is about zero.
class ResonanceTest final : public TestFunction {
 public:
  ResonanceTest(PointType type, const RealMultiplierCondition& condition) : type_(type), condition_(condition) {}
  std::string name() const override { return type_ == PointType::resonance_1 ? "1:1 resonance" : "1:2 resonance"; }
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {type_, {}, false, name()}; }

 private:
  PointType type_;
  const RealMultiplierCondition& condition_;
};

/// The angle of the critical pair on a torus curve, by its cosine, which is smooth also where the pair meets: 1:3 and
/// 1:4 resonance, and 1:1 and 1:2, where the curve ends. By symmetry the cosine may touch 1 or -1 without going beyond
/// it: the angle itself, with its sign, then goes through 0 or pi. MirroredResonanceTest and PassedResonanceTest find
/// these points.
class AngleTest final : public TestFunction {
 public:
  AngleTest(PointType type, const CriticalPair& condition) : type_(type), condition_(condition) {}
  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  Resolution resolution() const override;
  SpecialPoint classify(const TestedPoint&, bool) const override;

 private:
  PointType type_;
  const CriticalPair& condition_;
};

/// 1:1 or 1:2 resonance where a torus curve meets its mirror image: that of an orbit without the symmetry of the
/// problem at an orbit that has it, or that of a doubled orbit at the orbit that is doubled. The angle is proportional
/// to the arclength there, and cos theta touches 1 or -1. The curve of the symmetric orbits goes through the same
/// point, so the bordered determinant changes sign; with its sign the angle goes through zero.
class MirroredResonanceTest final : public TestFunction {
 public:
  explicit MirroredResonanceTest(const CriticalPair& condition) : condition_(condition) {}
  std::string name() const override { return "resonance at the mirror image"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_genuine(const TestedPoint& point) const override;
  bool singular_at_zero() const override { return true; }
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const CriticalPair& condition_;
};

/// 1:1 or 1:2 resonance that the angle passes, the double multiplier having two eigenvectors, as on curves of orbits
/// with a symmetry: the curve goes on. It is reported without a label, for no curve starts there.
class PassedResonanceTest final : public TestFunction {
 public:
  explicit PassedResonanceTest(const CriticalPair& condition) : condition_(condition) {}
  std::string name() const override { return "angle through 0 or pi"; }
  TestValue evaluate(const TestedPoint& point) const override;
  bool is_only_reported() const override { return true; }
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  const CriticalPair& condition_;
};

}  // namespace tchat
