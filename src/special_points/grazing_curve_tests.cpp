#include "special_points/grazing_curve_tests.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>

namespace tchat {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// v across the end of segment s: onto the section along the flow, then through the jump if asked.
Vector project(const DefiningSystem& system, const Orbit& x, int s, const Vector& v) {
  const int n = system.dimension();
  Vector f(n);
  Vector gradient(n);
  system.system().value(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field, x.end(s),
                        x.par.data(), f.data());
  system.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return v - f * (gradient.dot(v) / gradient.dot(f));
}

Matrix jump_derivative(const HybridSystem& system, int jump, const double* x, const double* par) {
  const int n = system.dimension();
  Vector g(n);
  Matrix gx(n, n);
  system.first(FunctionKind::jump, jump, x, par, {}, g.data(), gx.data(), nullptr);
  return gx;
}

/// A v: from the contact through the cycle back to it.
Vector once_around(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x, Vector v) {
  const int m = system.segments();
  const int n = system.dimension();
  for (int i = 1; i <= m; ++i) {
    const int before = (system.grazing_segment() + i - 1) % m;
    const int s = (system.grazing_segment() + i) % m;
    v = jump_derivative(system.system(), system.signature()[static_cast<std::size_t>(before)].jump, x.end(before),
                        x.par.data()) *
        v;
    const RowMajorBlock first(condensed.first_block(s), n, n);
    const RowMajorBlock last(condensed.last_block(s), n, n);
    v = project(system, x, s, Matrix(last).partialPivLu().solve(Vector(-(first * v))));
  }
  return v;
}

}  // namespace

GrazingUnfolding grazing_unfolding(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                                   int jump, int count) {
  const int s = system.grazing_segment();
  const int n = system.dimension();
  const IndexVector& index = system.signature()[static_cast<std::size_t>(s)];
  const double* contact = x.end(s);
  Vector f(n);
  Vector event_gradient(n);
  Vector section(n);
  double h = 0.0;
  system.system().value(FunctionKind::field, index.field, contact, x.par.data(), f.data());
  system.system().first(FunctionKind::event, index.event, contact, x.par.data(), {}, &h, event_gradient.data(),
                        nullptr);
  system.section_gradient(s, contact, x.par.data(), section.data());

  GrazingUnfolding result;
  result.acceleration = section.dot(f);
  Vector v = project(system, x, s, jump_derivative(system.system(), jump, contact, x.par.data()) * f);
  for (int k = 1; k <= count; ++k) {
    const double before = v.norm();
    v = once_around(system, condensed, x, v);
    result.xi.push_back(-event_gradient.dot(v));
    result.scale.push_back(event_gradient.norm() * std::max(before, v.norm()));
  }
  return result;
}

std::string XiTest::name() const { return fmt::format("xi_{}", n_); }

std::optional<double> XiTest::value(const TestedPoint& point) const {
  return grazing_unfolding(system_, point.condensed, point.orbit, jump_, n_).xi.back();
}

double XiTest::zero_level(const TestedPoint& point) const {
  constexpr double rounding = 1e-9;  // each turn's share, with that of the orbit's own error
  return rounding * grazing_unfolding(system_, point.condensed, point.orbit, jump_, n_).scale.back();
}

SpecialPoint XiTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::xi, system_.grazing_segment() + 1, n_, 1.0},
          false,
          fmt::format("codimension two: xi_{} = 0", n_)};
}

std::optional<double> AccelerationTest::value(const TestedPoint& point) const {
  return grazing_unfolding(system_, point.condensed, point.orbit, jump_, 0).acceleration;
}

SpecialPoint AccelerationTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::grazing_codimension_two, system_.grazing_segment() + 1, 0, 1.0},
          false,
          "codimension two: a* = 0, h is no longer least at the contact"};
}

std::optional<double> SmoothMultiplierTest::value(const TestedPoint& point) const {
  if (!point.multipliers.valid) return std::nullopt;
  std::complex<double> product = 1.0;
  for (const auto& mu : point.multipliers.values) product *= static_cast<double>(target_) - mu;
  return product.real();
}

SpecialPoint SmoothMultiplierTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::grazing_codimension_two, 0, target_, 1.0},
          false,
          fmt::format("codimension two: {}, multiplier {} of the smooth return map", name(), target_)};
}

}  // namespace tchat
