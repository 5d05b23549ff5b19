#include "stability/equilibrium_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/equilibrium_normal_form.hpp"
#include "stability/normal_form_text.hpp"

namespace tchat {

Eigen::MatrixXd equilibrium_jacobian(const DefiningSystem& system, const Orbit& x) {
  const int n = system.dimension();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd jacobian(n, n);
  system.system().first(FunctionKind::field, system.signature().front().field, x.end(0), x.par.data(), {}, f.data(),
                        jacobian.data(), nullptr);
  return jacobian;
}

FloquetMultipliers equilibrium_eigenvalues(const DefiningSystem& system, const Orbit& x) {
  FloquetMultipliers result;
  result.are_eigenvalues = true;
  const int states = system.dimension_of(0);
  const Eigen::MatrixXd jacobian = equilibrium_jacobian(system, x).topLeftCorner(states, states);
  const Eigen::VectorXcd values = eigenvalues(jacobian);
  result.valid = values.allFinite();
  if (!result.valid) return result;
  result.values.assign(values.begin(), values.end());
  std::sort(result.values.begin(), result.values.end(), [](const auto& a, const auto& b) {
    return std::make_tuple(-a.real(), -a.imag()) < std::make_tuple(-b.real(), -b.imag());
  });
  return result;
}

HopfPairs hopf_pairs(const std::vector<std::complex<double>>& eigenvalues) {
  HopfPairs pairs;
  for (auto a = eigenvalues.begin(); a != eigenvalues.end(); ++a)
    for (auto b = std::next(a); b != eigenvalues.end(); ++b) {
      const EigenvaluePair pair{*a, *b, 0.0};
      const bool both_real = a->imag() == 0.0 && b->imag() == 0.0;
      const double sizes = std::abs(*a) + std::abs(*b);
      const double distance = sizes > 0.0 ? std::abs(*a + *b) / sizes : 0.0;
      // The sums of other pairs come with their conjugates.
      if ((both_real || pair.is_oscillation()) && (*a + *b).real() < 0.0) pairs.sign = -pairs.sign;
      if (distance < pairs.nearest.distance) pairs.nearest = {*a, *b, distance};
    }
  return pairs;
}

TestValue HopfTest::evaluate(const TestedPoint& point) const {
  if (!point.multipliers.valid) return TestValue::undefined();
  const HopfPairs pairs = hopf_pairs(point.multipliers.values);
  return TestValue::of(pairs.sign * pairs.nearest.distance, orbit_accuracy);
}

bool HopfTest::is_genuine(const TestedPoint& point) const {
  return hopf_pairs(point.multipliers.values).nearest.is_oscillation();
}

SpecialPoint HopfTest::classify(const TestedPoint& point, bool) const {
  const double omega = std::abs(hopf_pairs(point.multipliers.values).nearest.first.imag());
  return {PointType::hopf,
          {},
          stop_,
          fmt::format("Hopf bifurcation, omega = {:.10g}, period {:.10g}", omega, 2.0 * std::numbers::pi / omega),
          {},
          hopf_text(point, omega)};
}

std::string BoundaryEquilibriumTest::name() const { return fmt::format("h{} at the equilibrium", event_); }

namespace {

/// The real ones, the largest first. Two that are equal may have come apart by rounding, into a pair of next to no
/// imaginary part.
std::vector<double> real_eigenvalues(const TestedPoint& point) {
  const double rounding = level::double_zero * largest_modulus(point.multipliers.values);
  std::vector<double> values;
  for (const auto& value : point.multipliers.values)
    if (std::abs(value.imag()) <= rounding) values.push_back(value.real());
  std::sort(values.rbegin(), values.rend());
  return values;
}

}  // namespace

long eigenvalues_at_zero(const TestedPoint& point) {
  constexpr double alike = 10.0;  // a symmetry makes them equal, up to rounding
  const std::vector<double> values = real_eigenvalues(point);
  double least = INFINITY;
  for (const double value : values) least = std::min(least, std::abs(value));
  const double zero = std::max(alike * least, level::visible * largest_modulus(point.multipliers.values));
  return std::count_if(values.begin(), values.end(), [&](double value) { return std::abs(value) <= zero; });
}

TestValue EigenvaluePairTest::evaluate(const TestedPoint& point) const {
  if (!point.multipliers.valid) return TestValue::undefined();
  const std::vector<double> values = real_eigenvalues(point);
  double value = INFINITY, sign = 1.0;
  for (std::size_t k = 1; k < values.size(); k += 2) {
    value = std::min(value, std::abs(values[k]));
    if (values[k] > 0.0) sign = -sign;
  }
  if (!std::isfinite(value)) return TestValue::undefined();
  return TestValue::of(sign * value, orbit_accuracy * largest_modulus(point.multipliers.values));
}

bool EigenvaluePairTest::is_genuine(const TestedPoint& point) const { return eigenvalues_at_zero(point) >= 2; }

SpecialPoint EigenvaluePairTest::classify(const TestedPoint& point, bool) const {
  return {PointType::equilibrium_branch_point,
          {},
          stop_,
          fmt::format("branch point: {} eigenvalues go through 0 together", eigenvalues_at_zero(point))};
}

TestValue BoundaryEquilibriumTest::evaluate(const TestedPoint& point) const {
  const HybridSystem& problem = system_.system();
  return TestValue::of(problem.event(event_, point.orbit.end(0), point.orbit.par.data()),
                       orbit_accuracy * event_scale(problem, point.orbit, event_));
}

SpecialPoint BoundaryEquilibriumTest::classify(const TestedPoint& point, bool rising) const {
  const HybridSystem& problem = system_.system();
  return {PointType::user,
          {UserPointKind::boundary_equilibrium, 1, event_, 0.0},
          stop_ && !rising,
          fmt::format("boundary equilibrium: contact with event {} ({}), {}", event_,
                      problem.function_name(FunctionKind::event, event_),
                      state_text(problem, point.orbit, point.orbit.end(0)))};
}

namespace {

using Eigenvalues = std::vector<std::complex<double>>;

/// Without the one that is nearest to `known`.
Eigenvalues without_nearest(Eigenvalues values, std::complex<double> known) {
  const auto nearest = std::min_element(values.begin(), values.end(), [known](const auto& a, const auto& b) {
    return std::abs(a - known) < std::abs(b - known);
  });
  if (nearest != values.end()) values.erase(nearest);
  return values;
}

/// Without the one that is zero on a fold curve.
Eigenvalues without_zero(const Eigenvalues& values) { return without_nearest(values, 0.0); }

/// Without the pair that is on the imaginary axis on a Hopf curve.
Eigenvalues without_pair(const Eigenvalues& values, const HopfPair& pair) {
  const std::complex<double> own = std::sqrt(std::complex<double>(-pair.square()));
  return without_nearest(without_nearest(values, own), -own);
}

/// CP: w^T f_xx v v = 0 on a fold curve.
class EquilibriumCuspTest final : public TestFunction {
 public:
  explicit EquilibriumCuspTest(const EquilibriumFold& fold) : fold_(fold) {}
  std::string name() const override { return "cusp"; }
  TestValue evaluate(const TestedPoint&) const override { return TestValue::of(fold_.cusp_function(), orbit_accuracy); }
  SpecialPoint classify(const TestedPoint&, bool) const override { return {PointType::cusp, {}, false, "cusp"}; }

 private:
  const EquilibriumFold& fold_;
};

/// BT on a fold curve: the eigenvalue 0 is a double one.
class DoubleZeroTest final : public TestFunction {
 public:
  explicit DoubleZeroTest(const EquilibriumFold& fold) : fold_(fold) {}
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint&) const override {
    return TestValue::of(fold_.multiplicity_function(), orbit_accuracy);
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, false, "Bogdanov-Takens point: the eigenvalue 0 is a double one"};
  }

 private:
  const EquilibriumFold& fold_;
};

/// BT on a Hopf curve: omega^2 = 0. The curve ends there. By symmetry omega^2 may touch zero, omega going through it:
/// MirroredFrequencyTest, PassedFrequencyTest.
class ZeroFrequencyTest final : public TestFunction {
 public:
  explicit ZeroFrequencyTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "Bogdanov-Takens"; }
  TestValue evaluate(const TestedPoint&) const override {
    return TestValue::of(pair_.relative_square(), orbit_accuracy);
  }
  Resolution resolution() const override { return Resolution::direction; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, true, "Bogdanov-Takens point: omega = 0, where the Hopf curve ends"};
  }

 private:
  const HopfPair& pair_;
};

/// BT where the Hopf curve of an equilibrium without the symmetry of the problem meets its mirror image at an
/// equilibrium that has it: omega is proportional to the arclength. The Hopf curve of the symmetric equilibria passes
/// through the same point, so the bordered determinant changes sign; with its sign omega goes through zero. Only that
/// sign may be normalised to a jump. Elsewhere a curve that crosses is not that of a double eigenvalue 0.
class MirroredFrequencyTest final : public TestFunction {
 public:
  explicit MirroredFrequencyTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "Bogdanov-Takens at the mirror image"; }
  TestValue evaluate(const TestedPoint& point) const override {
    constexpr double nearby = 0.1;
    const double square = std::abs(pair_.relative_square());
    const TestValue omega =
        TestValue::of(std::copysign(std::sqrt(square), point.singular_distance), level::double_zero);
    return square < nearby ? omega : TestValue::undefined(omega.sign);
  }
  /// omega is known to the accuracy of its location.
  bool is_genuine(const TestedPoint&) const override { return std::abs(pair_.relative_square()) <= level::converged; }
  bool singular_at_zero() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens,
            {},
            true,
            "Bogdanov-Takens point: omega = 0, where the Hopf curve ends: it meets its mirror image"};
  }

 private:
  const HopfPair& pair_;
};

/// BT that omega passes, the eigenvalue 0 having two eigenvectors: the curve continues. Reported without a label.
class PassedFrequencyTest final : public TestFunction {
 public:
  explicit PassedFrequencyTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "omega through 0"; }
  TestValue evaluate(const TestedPoint&) const override {
    return TestValue::of(pair_.turning(), level::same);  // at a located point of another kind it is none
  }
  bool is_only_reported() const override { return true; }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::bogdanov_takens, {}, false, "omega passes 0: two eigenvectors, the Hopf curve goes on"};
  }

 private:
  const HopfPair& pair_;
};

/// The least modulus, with the sign of the product of all, relative to `scale`: zero where an eigenvalue is.
double signed_least(const Eigenvalues& values, double scale) {
  double least = std::abs(values.front());
  double sign = 1.0;
  for (const auto& value : values) {
    least = std::min(least, std::abs(value));
    if (value.imag() == 0.0 && value.real() < 0.0) sign = -sign;
  }
  return sign * least / scale;
}

SpecialPoint zero_hopf_point(double omega) {
  return {PointType::zero_hopf, {}, false, fmt::format("zero-Hopf point, omega = {:.10g}", omega)};
}

/// A pair of the other eigenvalues, none of which is critical along the curve, is on the imaginary axis.
class OtherPairTest : public TestFunction {
 public:
  TestValue evaluate(const TestedPoint& point) const override {
    if (!point.multipliers.valid) return TestValue::undefined();
    const Eigenvalues others = other_eigenvalues(point.multipliers.values);
    if (others.size() < 2) return TestValue::undefined();
    const HopfPairs pairs = hopf_pairs(others);
    return TestValue::of(pairs.sign * pairs.nearest.distance, orbit_accuracy);
  }
  bool is_genuine(const TestedPoint& point) const override { return nearest_pair(point).is_oscillation(); }

 protected:
  double omega(const TestedPoint& point) const { return std::abs(nearest_pair(point).first.imag()); }

 private:
  virtual Eigenvalues other_eigenvalues(const Eigenvalues& all) const = 0;
  EigenvaluePair nearest_pair(const TestedPoint& point) const {
    return hopf_pairs(other_eigenvalues(point.multipliers.values)).nearest;
  }
};

/// ZH on a fold curve.
class FoldHopfTest final : public OtherPairTest {
 public:
  std::string name() const override { return "zero-Hopf"; }
  SpecialPoint classify(const TestedPoint& point, bool) const override { return zero_hopf_point(omega(point)); }

 private:
  Eigenvalues other_eigenvalues(const Eigenvalues& all) const override { return without_zero(all); }
};

/// HH on a Hopf curve.
class DoubleHopfTest final : public OtherPairTest {
 public:
  explicit DoubleHopfTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "double Hopf"; }
  SpecialPoint classify(const TestedPoint& point, bool) const override {
    return {PointType::double_hopf,
            {},
            false,
            fmt::format("double Hopf point, omega = {:.10g} and {:.10g}", std::sqrt(std::abs(pair_.square())),
                        omega(point))};
  }

 private:
  Eigenvalues other_eigenvalues(const Eigenvalues& all) const override { return without_pair(all, pair_); }

  const HopfPair& pair_;
};

/// ZH on a Hopf curve: one of the other eigenvalues is zero.
class HopfFoldTest final : public TestFunction {
 public:
  explicit HopfFoldTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "zero-Hopf"; }
  TestValue evaluate(const TestedPoint& point) const override {
    const Eigenvalues others = without_pair(point.multipliers.values, pair_);
    if (!point.multipliers.valid || others.empty()) return TestValue::undefined();
    return TestValue::of(signed_least(others, largest_modulus(point.multipliers.values)), orbit_accuracy);
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return zero_hopf_point(std::sqrt(std::abs(pair_.square())));
  }

 private:
  const HopfPair& pair_;
};

/// GH on a Hopf curve: the first Lyapunov coefficient is zero (Bautin). It is scaled to omega, with which it goes to
/// infinity at a Bogdanov-Takens point.
class BautinTest final : public TestFunction {
 public:
  explicit BautinTest(const HopfPair& pair) : pair_(pair) {}
  std::string name() const override { return "first Lyapunov coefficient"; }
  TestValue evaluate(const TestedPoint& point) const override {
    const double square = pair_.square();
    if (!(square > 0.0)) return TestValue::undefined();
    const double omega = std::sqrt(square);
    const Coefficient l = first_lyapunov_coefficient(point.condensed.system(), point.orbit, omega);
    return TestValue::of(omega * l.value, omega * l.uncertainty);
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::generalized_hopf, {}, false, "generalised Hopf point: the first Lyapunov coefficient is 0"};
  }

 private:
  const HopfPair& pair_;
};

/// LP on a curve of boundary equilibria.
class ZeroEigenvalueTest final : public TestFunction {
 public:
  explicit ZeroEigenvalueTest(const DefiningSystem& system) : system_(system) {}
  std::string name() const override { return "eigenvalue 0"; }
  TestValue evaluate(const TestedPoint& point) const override {
    const Eigenvalues& all = point.multipliers.values;
    if (!point.multipliers.valid || all.empty()) return TestValue::undefined();
    const double scale = all.size() > 1 ? largest_modulus(all) : 1.0 + std::abs(all.front());  // of one state
    return TestValue::of(signed_least(all, scale), orbit_accuracy);
  }
  /// w^T f_p = 0 for both parameters, w the left null vector, is a branch point in either.
  bool is_genuine(const TestedPoint& point) const override {
    const int n = system_.dimension(), field = system_.signature().front().field;
    Eigen::VectorXd f(n);
    Eigen::MatrixXd by_state(n, n), by_parameter(n, system_.free_count());
    system_.system().first(FunctionKind::field, field, point.orbit.end(0), point.orbit.par.data(),
                           system_.free_parameters(), f.data(), by_state.data(), by_parameter.data());
    const Eigen::VectorXd w = eigenvector(by_state * by_state.transpose(), 0.0).real().normalized();
    return (by_parameter.transpose() * w).norm() > level::located * by_parameter.norm();
  }
  SpecialPoint classify(const TestedPoint&, bool) const override {
    return {PointType::equilibrium_fold, {}, false, "fold of equilibria: the eigenvalue 0"};
  }

 private:
  const DefiningSystem& system_;
};

}  // namespace

std::unique_ptr<TestFunction> zero_eigenvalue_test(const DefiningSystem& system) {
  return std::make_unique<ZeroEigenvalueTest>(system);
}

TestList equilibrium_fold_tests(const EquilibriumFold& fold) {
  TestList tests;
  tests.push_back(std::make_unique<EquilibriumCuspTest>(fold));
  tests.push_back(std::make_unique<DoubleZeroTest>(fold));
  tests.push_back(std::make_unique<FoldHopfTest>());
  return tests;
}

TestList hopf_curve_tests(const HopfPair& pair) {
  TestList tests;
  tests.push_back(std::make_unique<ZeroFrequencyTest>(pair));
  tests.push_back(std::make_unique<MirroredFrequencyTest>(pair));
  tests.push_back(std::make_unique<PassedFrequencyTest>(pair));
  tests.push_back(std::make_unique<HopfFoldTest>(pair));
  tests.push_back(std::make_unique<DoubleHopfTest>(pair));
  tests.push_back(std::make_unique<BautinTest>(pair));
  return tests;
}

}  // namespace tchat
