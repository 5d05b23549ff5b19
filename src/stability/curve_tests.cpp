#include "stability/curve_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <string>

#include "base/levels.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/normal_form.hpp"
#include "stability/normal_form_text.hpp"

namespace tchat {

namespace {

constexpr double at_resonance = level::located;  // of the cosine at a located resonance

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

/// May the orbits be doubled ones: is the second half of the signature the first one again, or is there no section?
bool may_be_doubled(const Signature& signature) {
  if (signature.size() == 1) return signature.front().event == no_function;
  const auto half = static_cast<std::ptrdiff_t>(signature.size() / 2);
  return signature.size() % 2 == 0 && std::equal(signature.begin(), signature.begin() + half, signature.begin() + half);
}

/// Relative to the largest state.
double difference_of_halves(const TestedPoint& point, int segments) {
  const double size = 1.0 + point.orbit.states.cwiseAbs().maxCoeff();
  return differences_of_halves(point.orbit, segments, point.condensed.rule()).cwiseAbs().maxCoeff() / size;
}

/// What <row, v> is made of: products of the lengths of the parts that have one unit each, the states, the durations
/// and every parameter.
double terms_of_product(const OrbitVector& row, const OrbitVector& v) {
  return row.states.norm() * v.states.norm() + row.durations.norm() * v.durations.norm() +
         row.globals.cwiseAbs().dot(v.globals.cwiseAbs());
}

class CuspTest final : public TestFunction {
 public:
  CuspTest(const CriticalMultiplier& fold, const DefiningSystem& system)
      : fold_(fold), segments_(system.segments()), may_be_doubled_(may_be_doubled(system.signature())) {}
  std::string name() const override { return "cusp"; }
  /// The zero level is relative to the terms of the product. Where the halves of doubled orbits meet the function
  /// vanishes with the third power of their difference, and is undefined where that is no more than the zero level.
  TestValue evaluate(const TestedPoint& point) const override {
    constexpr double meeting = 0.01;
    if (may_be_doubled_ && difference_of_halves(point, segments_) < meeting) return TestValue::undefined();
    const OrbitVector& gradient = fold_.gradient(0);
    const OrbitVector& v = fold_.null_vector();
    return TestValue::of(fold_.cusp_function(), orbit_accuracy * terms_of_product(gradient, v));
  }
  /// Where a segment ends tangentially the function has a pole.
  bool is_genuine(const TestedPoint& point) const override { return touching_segment(point) < 0; }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    return {PointType::cusp, {}, false, "cusp", {}, codimension_two_text(point, PointType::cusp)};
  }

 private:
  const CriticalMultiplier& fold_;
  int segments_;
  bool may_be_doubled_;
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
  /// The multipliers, where they are known, show a second one.
  bool is_genuine(const TestedPoint& point) const override {
    if (!point.multipliers.determined()) return true;
    const double target = type_ == PointType::resonance_1 ? 1.0 : -1.0;
    const auto list = point.multipliers.nontrivial();
    return std::count_if(list.begin(), list.end(),
                         [target](const auto& mu) { return std::abs(mu - target) <= agreeing_multiplier; }) > 1;
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
    const double square = 2.0 * std::abs(std::abs(pair_.cosine()) - 1.0);
    const TestValue angle = TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level::located);
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
    return TestValue::of(pair_.turning(), level::same);  // at a located resonance of another kind it is none
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

class TurningTest final : public TestFunction {
 public:
  TurningTest(Eigen::Index principal, std::string parameter, PointType type, bool stop)
      : principal_(principal), parameter_(std::move(parameter)), type_(type), stop_(stop) {}
  std::string name() const override { return "turn in " + parameter_; }
  TestValue evaluate(const TestedPoint& point) const override {
    return TestValue::of(point.tangent.globals(principal_), level::converged * point.principal_rate_size);
  }
  bool is_of_tangent() const override { return true; }
  std::string reason_to_vanish(const TestedPoint&) const override { return parameter_ + " stays the same"; }
  /// Where grazing curves cross, the turn of one of them is that of the branch point. At a cusp, and where a curve
  /// turns back into itself, all parameters turn; where a section becomes tangent only the cut does.
  bool is_genuine(const TestedPoint& point) const override {
    if (type_ == PointType::fold) return std::abs(point.singular_distance) > level::located;
    return turns_alone(point) && touching_segment(point) < 0;
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    if (type_ == PointType::fold) return {type_, {}, stop_, "the grazing curve turns in " + parameter_};
    return {type_, {UserPointKind::extremum}, stop_, "extremum of " + parameter_ + " along the curve"};
  }

 private:
  bool turns_alone(const TestedPoint& point) const {
    constexpr double alone = 0.01;
    const auto size = [&](Eigen::Index g) {
      return parameter_size(point.condensed.system(), point.orbit, static_cast<int>(g));
    };
    const auto share = [&](Eigen::Index g) { return std::abs(point.tangent.globals(g)) / size(g); };
    double of_others = 0.0;
    for (Eigen::Index g = 0; g < point.tangent.globals.size(); ++g)
      if (g != principal_) of_others = std::max(of_others, share(g));
    const double moving = level::same * point.principal_rate_size / size(principal_);
    return of_others > moving && share(principal_) < alone * of_others;
  }

  Eigen::Index principal_;
  std::string parameter_;
  PointType type_;
  bool stop_;
};

}  // namespace

std::unique_ptr<TestFunction> turning_test(Eigen::Index principal, const std::string& name, PointType type, bool stop) {
  return std::make_unique<TurningTest>(principal, name, type, stop);
}

Eigen::VectorXd differences_of_halves(const Orbit& x, int segments, const CollocationRule& rule) {
  const int n = x.shape.dimension, half = segments / 2;
  if (half == 0) return x.states.col(0) - state_at(x, rule, 0, 0.5);
  Eigen::VectorXd differences(n * half);
  for (int s = 0; s < half; ++s)
    differences.segment(s * n, n) = x.states.col(x.shape.first_node(s)) - x.states.col(x.shape.first_node(half + s));
  return differences;
}

std::unique_ptr<TestFunction> cusp_test(const CriticalMultiplier& fold, const DefiningSystem& system) {
  return std::make_unique<CuspTest>(fold, system);
}

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

namespace {

using Complex = std::complex<double>;

/// e^(i theta) of the pair that a torus curve keeps on the circle.
std::optional<Complex> critical(const CriticalPair* pair) {
  if (pair == nullptr) return std::nullopt;
  return pair->multiplier() / std::abs(pair->multiplier());
}

/// multiplier_product() without the factors of the critical pair of a torus curve, if there is one: 2 - 2 cos theta or
/// 2 + 2 cos theta, which touch zero where its halves meet.
TestValue product_beside(const TestedPoint& point, int target, const CriticalPair* pair) {
  const TestValue product = multiplier_product(point, target);
  if (pair == nullptr || !product.value) return product;
  const double of_pair = 2.0 - 2.0 * target * pair->cosine();
  if (!(of_pair > level::located)) return TestValue::undefined();
  return TestValue::of(*product.value / of_pair, product.zero_level / of_pair);
}

/// A real multiplier 1 or -1 besides the critical ones.
class SecondMultiplierTest final : public TestFunction {
 public:
  /// `pair`: of a torus curve, else null.
  SecondMultiplierTest(PointType type, int target, const CriticalPair* pair = nullptr)
      : type_(type), target_(target), pair_(pair) {}
  std::string name() const override { return type_name(static_cast<int>(type_)); }
  TestValue evaluate(const TestedPoint& point) const override { return product_beside(point, target_, pair_); }
  bool is_genuine(const TestedPoint& point) const override { return is_multiplier_at(point, target_); }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {type_, {}, false, fmt::format("a second critical multiplier: {}", target_)};
  }

 private:
  PointType type_;
  int target_;
  const CriticalPair* pair_;
};

/// A complex pair on the unit circle besides the critical multipliers.
class SecondPairTest final : public TestFunction {
 public:
  explicit SecondPairTest(PointType type, const CriticalPair* pair = nullptr) : type_(type), pair_(pair) {}
  std::string name() const override { return type_name(static_cast<int>(type_)); }
  TestValue evaluate(const TestedPoint& point) const override { return pair_distance(point, critical(pair_)); }
  /// Rounding makes a complex pair of a double real multiplier.
  bool is_genuine(const TestedPoint& point) const override {
    constexpr double surely_complex = 1e-3;
    const std::optional<Complex> mu = nearest_pair(point, critical(pair_));
    return mu && mu->imag() > surely_complex;
  }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    const std::optional<Complex> mu = nearest_pair(point, critical(pair_));
    return {type_, {}, false, fmt::format("a critical pair, angle {:.10g}, besides", mu ? std::arg(*mu) : 0.0)};
  }

 private:
  PointType type_;
  const CriticalPair* pair_;
};

/// The coefficient of the cubic term, c or Re d. It has a pole where another multiplier passes 1, with which it is
/// multiplied.
class CubicTermTest final : public TestFunction {
 public:
  CubicTermTest(const DefiningSystem& system, PointType type, const CriticalPair* pair = nullptr)
      : type_(type), pair_(pair), solver_(std::make_unique<NormalFormSolver>(system)) {}
  std::string name() const override { return type_name(static_cast<int>(type_)); }
  TestValue evaluate(const TestedPoint& point) const override {
    const TestValue product = product_beside(point, 1, pair_);
    if (!product.value || point.condition == nullptr || touching_segment(point) >= 0) return TestValue::undefined();
    const std::optional<Coefficient> form =
        solver_->find(point.condensed, point.orbit, *point.condition, point.multipliers);
    if (!form) return TestValue::undefined();
    const double factor = *product.value / (1.0 + std::abs(*product.value)) / solver_->square_in_sizes(point.orbit);
    return TestValue::of(form->value * factor, form->uncertainty * std::abs(factor));
  }
  /// Where the other multiplier does not act on the critical one there is no pole, and what vanishes is the factor.
  bool is_genuine(const TestedPoint& point) const override {
    return multiplier_distance(point.multipliers, 1.0) > level::on_circle;
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {type_, {}, false, pair_ == nullptr ? "the normal form's c is zero" : "the normal form's Re d is zero"};
  }

 private:
  PointType type_;
  const CriticalPair* pair_;
  std::unique_ptr<NormalFormSolver> solver_;  // of any point: what it keeps is room
};

/// GPD on a curve of folds of doubled orbits: the halves of the orbits meet, and beyond they are exchanged. A sum of
/// the differences of states where the halves begin goes through zero there with all of them. The curve of period
/// doublings crosses, as its orbits twice over are folds of doubled orbits too.
class HalvesMeetTest final : public TestFunction {
 public:
  /// `segments`: of the signature; a single one without a section is halved in time.
  explicit HalvesMeetTest(int segments) : segments_(segments) {}
  std::string name() const override { return type_name(static_cast<int>(PointType::doubled_fold_end)); }
  TestValue evaluate(const TestedPoint& point) const override {
    double sum = 0.0;
    double weight = 1.0;
    for (const double difference : differences_of_halves(point.orbit, segments_, point.condensed.rule()))
      sum += std::cos(weight++) * difference;
    return TestValue::of(sum / (1.0 + point.orbit.states.cwiseAbs().maxCoeff()), orbit_accuracy);
  }
  bool is_genuine(const TestedPoint& point) const override {
    return difference_of_halves(point, segments_) <= level::visible;
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::doubled_fold_end, {}, true, "the halves of the doubled orbit meet: the curve begins there"};
  }

 private:
  int segments_;
};

}  // namespace

TestList fold_curve_meetings(const DefiningSystem& system) {
  TestList tests;
  if (may_be_doubled(system.signature())) tests.push_back(std::make_unique<HalvesMeetTest>(system.segments()));
  tests.push_back(std::make_unique<SecondMultiplierTest>(PointType::fold_and_doubling, -1));
  tests.push_back(std::make_unique<SecondPairTest>(PointType::fold_and_torus));
  return tests;
}

TestList doubling_curve_meetings(const DefiningSystem& system, bool coefficients) {
  TestList tests;
  tests.push_back(std::make_unique<SecondMultiplierTest>(PointType::doubling_and_fold, 1));
  tests.push_back(std::make_unique<SecondPairTest>(PointType::doubling_and_torus));
  if (coefficients) tests.push_back(std::make_unique<CubicTermTest>(system, PointType::generalized_doubling));
  return tests;
}

TestList torus_curve_meetings(const DefiningSystem& system, const CriticalPair& pair, bool coefficients) {
  TestList tests;
  tests.push_back(std::make_unique<SecondMultiplierTest>(PointType::torus_and_fold, 1, &pair));
  tests.push_back(std::make_unique<SecondMultiplierTest>(PointType::torus_and_doubling, -1, &pair));
  tests.push_back(std::make_unique<SecondPairTest>(PointType::two_tori, &pair));
  if (coefficients) tests.push_back(std::make_unique<CubicTermTest>(system, PointType::chenciner, &pair));
  return tests;
}

}  // namespace tchat
