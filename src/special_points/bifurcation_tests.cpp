#include "special_points/bifurcation_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tchat {

namespace {

constexpr double structural_limit = 5e-2;
constexpr double grazing_level = 1e-9;
/// A pair whose imaginary parts are smaller, relatively, is real.
constexpr double complex_level = 1e-7;

bool trusted(const FloquetMultipliers& multipliers) {
  return multipliers.valid && multipliers.structural <= structural_limit;
}

bool is_upper(const std::complex<double>& mu) { return mu.imag() > complex_level * std::abs(mu); }

/// The complex multiplier (upper half plane) nearest to the unit circle; null without one.
const std::complex<double>* nearest_pair(const FloquetMultipliers& multipliers) {
  const std::complex<double>* nearest = nullptr;
  for (const auto& mu : multipliers.values) {
    if (!is_upper(mu)) continue;
    if (nearest == nullptr || std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(*nearest) - 1.0)) nearest = &mu;
  }
  return nearest;
}

double distance_to_minus_one(const FloquetMultipliers& multipliers) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& mu : multipliers.values) nearest = std::min(nearest, std::abs(1.0 + mu));
  return nearest;
}

}  // namespace

std::string state_text(const HybridSystem& system, const double* x) {
  std::string text;
  for (int k = 1; k <= system.dimension(); ++k)
    text += fmt::format("{}{} = {:.10g}", k > 1 ? ", " : "", system.state_name(k), x[k - 1]);
  return text;
}

double transversality(const DefiningSystem& defining, const Orbit& x, int s) {
  const HybridSystem& system = defining.system();
  const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
  const int n = system.dimension();
  Eigen::VectorXd f(n);
  Eigen::VectorXd gradient(n);
  system.value(FunctionKind::field, v.field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  const double sizes = gradient.norm() * f.norm();
  return sizes > 0.0 ? gradient.dot(f) / sizes : 0.0;
}

FoldTest::FoldTest(int parameter, const std::vector<int>& free_parameters, int segments, bool stop)
    : is_duration_(is_duration(parameter, segments)), stop_(stop) {
  index_ = is_duration_
               ? duration_segment(parameter)
               : std::find(free_parameters.begin(), free_parameters.end(), parameter) - free_parameters.begin();
}

std::optional<double> FoldTest::value(const TestedPoint& point) const {
  return is_duration_ ? point.tangent.durations(index_) : point.tangent.globals(index_);
}

SpecialPoint FoldTest::classify(const TestedPoint&, bool) const { return {PointType::fold, {}, stop_, "fold"}; }

SpecialPoint BranchPointTest::classify(const TestedPoint&, bool) const {
  return {PointType::branch_point, {}, stop_, "branch point"};
}

std::optional<double> PeriodDoublingTest::value(const TestedPoint& point) const {
  if (!trusted(point.multipliers)) return std::nullopt;
  std::complex<double> product = 1.0;
  for (const auto& mu : point.multipliers.values) product *= 1.0 + mu;
  double result = product.real();
  for (const double a : point.transversalities) {
    if (std::abs(a) < grazing_level) return std::nullopt;
    result *= a;
  }
  return result;
}

bool PeriodDoublingTest::is_genuine(const TestedPoint& point) const {
  constexpr double close = 0.05;  // far more than a located zero misses -1 by, unless the multiplier is about infinite
  return distance_to_minus_one(point.multipliers) <= close;
}

double PeriodDoublingTest::zero_level(const TestedPoint& point) const {
  const double nearest = distance_to_minus_one(point.multipliers);
  const std::optional<double> size = value(point);
  return size && nearest > 0.0 ? 1e-9 * std::abs(*size) / nearest : 1e-9;
}

SpecialPoint PeriodDoublingTest::classify(const TestedPoint&, bool) const {
  return {PointType::period_doubling, {}, stop_, "period doubling"};
}

std::optional<double> TorusTest::value(const TestedPoint& point) const {
  if (!trusted(point.multipliers)) return std::nullopt;
  const std::complex<double>* nearest = nearest_pair(point.multipliers);
  if (nearest == nullptr) return std::nullopt;
  double sign = 1.0;
  for (const auto& mu : point.multipliers.values)
    if (is_upper(mu) && std::abs(mu) < 1.0) sign = -sign;
  return sign * std::abs(std::abs(*nearest) - 1.0);
}

SpecialPoint TorusTest::classify(const TestedPoint& point, bool) const {
  const std::complex<double>* mu = nearest_pair(point.multipliers);
  const double angle = mu == nullptr ? 0.0 : std::arg(*mu);
  return {PointType::torus, {}, stop_, fmt::format("torus bifurcation, angle {:.10g}", angle)};
}

ImpactVelocityTest::ImpactVelocityTest(const DefiningSystem& system, int segment, bool stop)
    : system_(system), segment_(segment), stop_(stop) {}

std::string ImpactVelocityTest::name() const { return fmt::format("h_x f at the end of segment {}", segment_ + 1); }

std::optional<double> ImpactVelocityTest::value(const TestedPoint& point) const {
  return point.transversalities[static_cast<std::size_t>(segment_)];
}

SpecialPoint ImpactVelocityTest::classify(const TestedPoint& point, bool rising) const {
  const int event = system_.signature()[static_cast<std::size_t>(segment_)].event;
  return {PointType::user,
          {UserPointKind::impact_velocity, segment_ + 1, event, 1.0},
          stop_ && rising,
          fmt::format("grazing: h_x f = 0 at the end of segment {}, event {} ({}), {}", segment_ + 1, event,
                      system_.system().function_name(FunctionKind::event, event),
                      state_text(system_.system(), point.orbit.end(segment_)))};
}

}  // namespace tchat
