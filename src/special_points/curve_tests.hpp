/// Codimension-two points on fold, period-doubling and torus curves: cusp and resonances.
#pragma once

#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "bvp/orbit_accuracy.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// The curve's null vector and the gradient of its condition are orthogonal: a cusp of a fold curve.
class CuspTest final : public TestFunction {
 public:
  /// The condition belongs to the follower; it is current wherever a test function is evaluated.
  explicit CuspTest(const CriticalMultiplier& condition) : condition_(condition) {}
  std::string name() const override { return "cusp"; }
  std::optional<double> value(const TestedPoint&) const override { return condition_.cusp_function(); }
  /// Against the sizes of the two vectors.
  double zero_level(const TestedPoint&) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }

 private:
  const CriticalMultiplier& condition_;
};

/// The critical multiplier is a double one: 1:1 resonance on fold curves, 1:2 on period-doubling curves. The
/// condition's function goes through zero with every a_s, which says nothing of the kind: it is multiplied by them once
/// more, and undefined where one is about zero.
class ResonanceTest final : public TestFunction {
 public:
  ResonanceTest(const CriticalMultiplier& condition, PointType type) : condition_(condition), type_(type) {}
  std::string name() const override { return type_ == PointType::resonance_1 ? "1:1 resonance" : "1:2 resonance"; }
  std::optional<double> value(const TestedPoint& point) const override;
  double zero_level(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint&, bool) const override { return {type_, {}, false, name()}; }

 private:
  const CriticalMultiplier& condition_;
  PointType type_;
};

/// The angle of the critical pair on a torus curve, by its cosine, which is smooth also where the pair meets: 1:3 and
/// 1:4 resonance, and 1:1 and 1:2, where the curve ends.
class AngleTest final : public TestFunction {
 public:
  AngleTest(const CriticalPair& condition, PointType type) : condition_(condition), type_(type) {}
  std::string name() const override;
  std::optional<double> value(const TestedPoint& point) const override;
  double zero_level(const TestedPoint&) const override { return orbit_accuracy; }
  SpecialPoint classify(const TestedPoint&, bool) const override;

 private:
  const CriticalPair& condition_;
  PointType type_;
};

}  // namespace tchat
