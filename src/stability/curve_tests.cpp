#include "stability/curve_tests.hpp"

#include <cmath>
#include <memory>

#include "orbit/admissibility.hpp"
#include "orbit/orbit.hpp"
#include "stability/normal_form_text.hpp"

namespace tchat {

namespace {

constexpr double at_resonance = 1e-6;  // of the cosine at a located resonance

bool has_double_multiplier(const CriticalPair& pair) { return std::abs(std::abs(pair.cosine()) - 1.0) <= at_resonance; }

/// A resonance 1:n of the critical pair.
struct StrongResonance {
  const char* name;
  double cosine;
  PointType type;
  bool ends_curve;  ///< the multipliers are real beyond it
};

constexpr StrongResonance resonances[] = {{"1:1 resonance", 1.0, PointType::resonance_1, true},
                                          {"1:2 resonance", -1.0, PointType::resonance_2, true},
                                          {"1:3 resonance", -0.5, PointType::resonance_3, false},
                                          {"1:4 resonance", 0.0, PointType::resonance_4, false}};

const StrongResonance& double_resonance(const CriticalPair& pair) { return resonances[pair.cosine() > 0.0 ? 0 : 1]; }

class CuspTest final : public TestFunction {
 public:
  explicit CuspTest(const CriticalMultiplier& fold) : fold_(fold) {}
  std::string name() const override { return "cusp"; }
  /// The zero level is relative to the sizes of the two vectors.
  TestValue evaluate(const TestedPoint&) const override {
    const OrbitVector& gradient = fold_.gradient(0);
    const OrbitVector& v = fold_.null_vector();
    return TestValue::of(fold_.cusp_function(), orbit_accuracy * std::sqrt(dot(gradient, gradient) * dot(v, v)));
  }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    return {PointType::cusp, {}, false, "cusp", {}, codimension_two_text(point, PointType::cusp)};
  }

 private:
  const CriticalMultiplier& fold_;
};

/// The condition's function goes through zero with every a_s, which has nothing to do with the multiplier: it is
/// multiplied by them once more, and undefined where one is about zero.
class DoubleMultiplierTest final : public TestFunction {
 public:
  DoubleMultiplierTest(PointType type, const RealMultiplierCondition& condition) : type_(type), condition_(condition) {}
  std::string name() const override { return type_ == PointType::resonance_1 ? "1:1 resonance" : "1:2 resonance"; }
  /// The zero level is relative to the a_s, with which the function and its factors vanish.
  TestValue evaluate(const TestedPoint& point) const override {
    double result = condition_.multiplicity_function();
    double level = orbit_accuracy;
    for (const double a : point.transversalities) {
      if (std::abs(a) <= no_transversality) return TestValue::undefined();
      result *= a;
      level *= a * a;
    }
    return TestValue::of(result, level);
  }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    return {type_, {}, false, name(), {}, codimension_two_text(point, type_)};
  }

 private:
  PointType type_;
  const RealMultiplierCondition& condition_;
};

/// The angle of the critical pair on a torus curve, by its cosine, which is smooth also where the pair meets. By
/// symmetry the cosine may touch 1 or -1 without going beyond it: the angle itself, with its sign, then goes through 0
/// or pi. MirroredResonanceTest and PassedResonanceTest find these points.
class AngleTest final : public TestFunction {
 public:
  AngleTest(const StrongResonance& resonance, const CriticalPair& pair) : resonance_(resonance), pair_(pair) {}
  std::string name() const override { return resonance_.name; }
  TestValue evaluate(const TestedPoint&) const override {
    return TestValue::of(pair_.cosine() - resonance_.cosine, orbit_accuracy);
  }
  Resolution resolution() const override {
    return resonance_.ends_curve ? Resolution::direction : Resolution::crossings;
  }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    return {resonance_.type,
            {},
            resonance_.ends_curve,
            name() + (resonance_.ends_curve ? ", where the torus curve ends" : ""),
            {},
            codimension_two_text(point, resonance_.type)};
  }

 private:
  const StrongResonance& resonance_;
  const CriticalPair& pair_;
};

/// 1:1 or 1:2 resonance where a torus curve meets its mirror image: that of an orbit without the symmetry of the
/// problem at an orbit that has it, or that of a doubled orbit at the orbit that is doubled. The angle is proportional
/// to the arclength there, and cos theta touches 1 or -1. The curve of the symmetric orbits passes through the same
/// point, so the bordered determinant changes sign; with its sign the angle goes through zero. Only that sign may be
/// normalised to a jump. Elsewhere a curve that crosses is not that of a resonance.
class MirroredResonanceTest final : public TestFunction {
 public:
  explicit MirroredResonanceTest(const CriticalPair& pair) : pair_(pair) {}
  std::string name() const override { return "resonance at the mirror image"; }
  TestValue evaluate(const TestedPoint& point) const override {
    constexpr double nearby = 0.5;
    constexpr double level = 1e-6;  // the root of what rounding makes of a cosine
    const double square = 2.0 * std::abs(std::abs(pair_.cosine()) - 1.0);
    const TestValue angle = TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level);
    return square < 2.0 * nearby ? angle : TestValue::undefined(angle.sign);
  }
  bool is_genuine(const TestedPoint&) const override { return has_double_multiplier(pair_); }
  bool singular_at_zero() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    const StrongResonance& met = double_resonance(pair_);
    return {met.type, {}, true, std::string(met.name) + ", where the torus curve ends: it meets its mirror image"};
  }

 private:
  const CriticalPair& pair_;
};

/// 1:1 or 1:2 resonance that the angle passes, the double multiplier having two eigenvectors, as on curves of orbits
/// with a symmetry: the curve continues. It is reported without a label, for no curve starts there.
class PassedResonanceTest final : public TestFunction {
 public:
  explicit PassedResonanceTest(const CriticalPair& pair) : pair_(pair) {}
  std::string name() const override { return "angle through 0 or pi"; }
  TestValue evaluate(const TestedPoint&) const override {
    constexpr double level = 1e-5;  // at a located resonance of another kind it is none
    return TestValue::of(pair_.turning(), level);
  }
  bool is_only_reported() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    const StrongResonance& passed = double_resonance(pair_);
    return {passed.type,
            {},
            false,
            std::string(passed.name) + ", which the angle passes: two eigenvectors, the curve goes on"};
  }

 private:
  const CriticalPair& pair_;
};

class ExtremumTest final : public TestFunction {
 public:
  ExtremumTest(const StationaryMonitor& condition, std::string names)
      : condition_(condition), names_(std::move(names)) {}
  std::string name() const override { return "extremum"; }
  TestValue evaluate(const TestedPoint&) const override {
    return TestValue::of(condition_.next_derivative(), orbit_accuracy);
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::user, {UserPointKind::extremum}, false, "extremum of ICP(1) in " + names_};
  }

 private:
  const StationaryMonitor& condition_;
  std::string names_;
};

}  // namespace

std::unique_ptr<TestFunction> cusp_test(const CriticalMultiplier& fold) { return std::make_unique<CuspTest>(fold); }

std::unique_ptr<TestFunction> double_multiplier_test(PointType type, const RealMultiplierCondition& condition) {
  return std::make_unique<DoubleMultiplierTest>(type, condition);
}

TestList torus_curve_tests(const CriticalPair& pair) {
  TestList tests;
  for (const StrongResonance& resonance : resonances) tests.push_back(std::make_unique<AngleTest>(resonance, pair));
  tests.push_back(std::make_unique<MirroredResonanceTest>(pair));
  tests.push_back(std::make_unique<PassedResonanceTest>(pair));
  return tests;
}

std::unique_ptr<TestFunction> extremum_test(const StationaryMonitor& condition, std::string names) {
  return std::make_unique<ExtremumTest>(condition, std::move(names));
}

}  // namespace tchat
